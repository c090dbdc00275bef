#pragma once
#include <cstddef>
#include <memory>
#include <span>

#include "mesh/mesh.hpp"

namespace tact::bench {

/// A narrow-band level set of OpenVDB, made by its meshToVolume: floats, negative inside.
class VdbField {
 public:
  /// Values at origin_O + voxel_m * (whole numbers), exact within band_voxels of the surface. Uses TBB's threads.
  VdbField(const Mesh& mesh_O, const Vec3& origin_O, double voxel_m, double band_voxels);
  ~VdbField();
  VdbField(VdbField&&) noexcept;

  /// values[i] = box sampler (trilinear) with one accessor for all points, the way its documentation recommends;
  /// metres.
  void sample(std::span<const Vec3> points_O, std::span<float> values_m) const;
  std::size_t bytes() const;

  static const char* version();

 private:
  struct Grid;
  std::unique_ptr<Grid> grid_;
};

}  // namespace tact::bench
