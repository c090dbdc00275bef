#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/stiffness/density_kernel.hpp"

namespace tact::contact {

/// Density of directions on one Gauss sphere, [P] eq. 6-7 summed over the points now in contact:
///   phi_i = sum_j hat(v_i, v_j),   hat(a, b) = max(1 - |a - b|^2 / eps^2, 0)
/// equal to the double sum up to rounding, in linear time however many directions are equal or nearly equal:
/// - directions are kept per point, in the tool's frame: distances between them never change for a rigid shell, so
///   classes of equal directions and the grid of cells (side eps / sqrt 3, diameter eps) are built once;
/// - within a cell, and between cells whose occupied boxes lie within eps of each other everywhere, hat is a quadratic
///   and the sum follows from moments (count, sum b, sum |b|^2);
/// - boxes at least eps apart contribute nothing; only pairs across a border are visited one by one, once per class.
/// Classes are numbered by cell, and those in use are listed in that order, side by side: memory is read forward,
/// whatever the order of the ids. One bit a class of the whole shell is looked at (64 in a nanosecond).
/// Vectors need not have unit length, but |v| <= 1.
class DirectionDensity {
 public:
  DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon);

  /// phi[i] += density at the direction of point ids[i], over all ids. Real-time.
  void add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept;

 private:
  void collect(std::span<const std::uint32_t> ids) noexcept;
  void list_used() noexcept;

  double eps2_;
  // Of the shell. Cells in order of their place, classes in order of their cells.
  std::vector<std::uint32_t> class_of_;  // point -> class
  std::vector<Vec3> direction_;          // class
  std::vector<std::uint32_t> cell_of_;   // class -> cell
  std::vector<Vec3> centre_;             // cell
  DensityNeighbours neighbours_;
  // Of one add().
  std::vector<std::uint64_t> is_used_;    // class, a bit each; all 0 in between
  std::vector<std::uint32_t> count_;      // class; all 0 in between
  std::vector<double> phi_;               // class, where used
  std::vector<std::uint32_t> used_cell_;  // cell -> index in cells_; of no meaning when that is another's
  DensityClasses used_;
  std::vector<std::uint32_t> used_class_;  // of used_: which class
  std::vector<DensityCell> cells_;
  std::size_t class_count_ = 0, cell_count_ = 0;
};

}  // namespace tact::contact
