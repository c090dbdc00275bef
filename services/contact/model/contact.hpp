#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Conditions of a contact or of a whole query, as bits: the values CONTACT_* of haptic.idl.
enum class Status : std::uint32_t {
  none = 0,
  overflow = 1,          ///< more contacts than capacity: the deepest were kept
  sign_doubtful = 2,     ///< the bake could not settle inside/outside here
  past_mid_surface = 4,  ///< the field pushes against the point's normal: nearer the far side of a thin part
  beyond_band = 8,       ///< deeper than the stored band: the depth is a lower bound
  capped = 16,           ///< a damping force was limited
  pose_invalid = 32,     ///< not finite or not a rotation: no contacts
};
constexpr std::uint32_t bit(Status s) noexcept { return static_cast<std::uint32_t>(s); }

/// Along what a contact pushes. normal: the point's normal N, [P] eq. 1. gradient: the field's gradient g, of length
/// about 1, so that forces are minus the derivative of an energy of the depths.
enum class ForceDirection : std::uint8_t { normal, gradient };

/// The points in contact at one pose, in O (the field body's frame), structure of arrays with fixed capacity.
/// Filled by the traversal, weighed by a law, summed by assemble. r is the lever p - To expressed in O.
struct ContactBuffer {
  /// Whole vectors are written: arrays reach this far beyond the capacity.
  static constexpr std::size_t kBeyond = 8;

  explicit ContactBuffer(std::size_t capacity);

  std::size_t size = 0;     ///< contacts in use
  std::size_t dropped = 0;  ///< found beyond capacity: the shallowest, not kept
  std::vector<std::uint32_t> point_id;
  std::vector<Vec3> r;               ///< m
  std::vector<Vec3> N;               ///< unit inward normal of the tool
  std::vector<Vec3> g;               ///< gradient of the interpolated field
  std::vector<double> depth_m;       ///< > 0
  std::vector<double> weight;        ///< of the law
  std::vector<std::uint32_t> flags;  ///< Status bits of this contact

  ForceDirection force_along = ForceDirection::gradient;  ///< set by whoever assembles; the traversal leaves it

  std::size_t capacity() const { return point_id.size() - kBeyond; }

  /// e of contact i: N or g. Where the field has no gradient (beyond its band) always N.
  const Vec3& force_direction(std::size_t i) const noexcept {
    return force_along == ForceDirection::normal || g[i].isZero(0) ? N[i] : g[i];
  }
};

}  // namespace tact::contact
