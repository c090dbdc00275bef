#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "math/pose.hpp"

namespace tact {

/// Sparse narrow-band signed distance field of a body, in its own frame O: metres, negative inside.
///
/// Space is a grid of cubic cells of side h = voxel_m(); 8x8x8 cells form a block. Blocks that the band
/// |sdf| <= band_m() touches store their 9x9x9 corner values (16-bit, shared corners stored in both neighbours so that
/// one block answers a sample); every other block stores only a conservative bound of |sdf| and its sign.
/// Values between corners are trilinear; the gradient is that of the *interpolated* field, so it is exactly the
/// derivative of the value inside a cell, and not unit length.
///
/// Immutable after open(). Samples do not allocate, lock or throw; safe from any thread.
class DistanceField {
 public:
  struct Sample {
    double value_m;                ///< interpolated; -band_m() deep inside, +band_m() or more outside the band
    Eigen::Vector3d gradient;      ///< of the interpolated field, in O; zero outside the stored band
    bool in_band;                  ///< value and gradient come from stored corners
    bool doubtful;                 ///< the bake could not settle inside/outside in this block
  };

  DistanceField() = default;  ///< empty: a placeholder to assign to

  /// Maps the file (populated; locked when `lock`). Throws SetupError naming the file and the reason when it is
  /// missing, truncated, of another schema, damaged (checksum), or not `expected_hash` (0: any).
  static DistanceField open(const std::filesystem::path& path, std::uint64_t expected_hash = 0, bool lock = false);

  Sample sample(const Vec3& p_O) const noexcept;

  /// Conservative lower bound of the signed distance at p_O: never above the true distance, also far outside the
  /// grid; inside the body it is at most 0. Cheap: one coarse look-up. To cull a ball of radius R about p_O, use
  /// lower_bound(p_O) - R > (sqrt(3)/2) h: interpolated values are not distances.
  double lower_bound(const Vec3& p_O) const noexcept;

  double voxel_m() const noexcept;
  double band_m() const noexcept;
  Vec3 min_O() const noexcept;  ///< corners of the grid
  Vec3 max_O() const noexcept;
  std::uint64_t content_hash() const noexcept;  ///< of what was baked: mesh, resolution, options, schema
  std::size_t bytes() const noexcept;           ///< mapped

 private:
  struct Mapping;
  std::shared_ptr<const Mapping> map_;
};

}  // namespace tact
