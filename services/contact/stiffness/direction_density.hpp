#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/stiffness/density_kernel.hpp"
#include "math/pose.hpp"

namespace tact::contact {

/// Density of directions on one Gauss sphere, [P] eq. 6-7 summed over the points now in contact:
///   phi_i = sum_j hat(v_i, v_j),   hat(a, b) = max(1 - |a - b|^2 / eps^2, 0)
/// equal to the double sum up to rounding. Directions are kept per point, in the tool's frame: distances between them
/// never change for a rigid shell, so classes of equal directions are listed once, in the order of a space-filling
/// curve. Those in use are copied side by side in that order, whatever the order of the ids, and summed by a tree of
/// boxes (sum_density). What a contact costs in memory that is not in the nearest cache: its class, its direction.
class DirectionDensity {
 public:
  DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon);

  /// phi[i] += density at the direction of point ids[i], over all ids. Real-time.
  void add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept;

 private:
  void list_used(std::span<const std::uint32_t> ids) noexcept;

  // Of the shell.
  std::vector<std::uint32_t> class_of_;  // point -> class
  std::vector<Vec3> direction_;          // class, in units of eps
  // Of one add().
  std::vector<std::uint64_t> is_used_;       // class, a bit each; all 0 in between
  std::vector<std::uint64_t> is_word_used_;  // word of is_used_, a bit each; all 0 in between
  std::vector<std::uint32_t> place_;         // class -> where in work_; of no meaning when not in use
  DensityWork work_;
};

}  // namespace tact::contact
