#include "bench/peers/openvdb_peer.hpp"

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>

namespace tact::bench {

struct VdbField::Grid {
  openvdb::FloatGrid::Ptr grid;
  Vec3 origin_O;
  double inverse_voxel;
  double voxel_m;
};

VdbField::VdbField(const Mesh& mesh_O, const Vec3& origin_O, double voxel_m, double band_voxels)
    : grid_(std::make_unique<Grid>()) {
  openvdb::initialize();
  const auto inverse = 1 / voxel_m;
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  points.reserve(mesh_O.vertices.size());
  triangles.reserve(mesh_O.triangles.size());
  // In index space: the grid's transform is the identity, distances are in voxels.
  for (const auto& v : mesh_O.vertices) {
    const Vec3 p = (v.cast<double>() - origin_O) * inverse;
    points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
  }
  for (const auto& t : mesh_O.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  const auto band = static_cast<float>(band_voxels);
  grid_->grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, band, band);
  grid_->origin_O = origin_O;
  grid_->inverse_voxel = inverse;
  grid_->voxel_m = voxel_m;
}

VdbField::~VdbField() = default;
VdbField::VdbField(VdbField&&) noexcept = default;

void VdbField::sample(std::span<const Vec3> points_O, std::span<float> values_m) const {
  const openvdb::FloatGrid::ConstAccessor accessor = grid_->grid->getConstAccessor();
  const auto scale = static_cast<float>(grid_->voxel_m);
  for (std::size_t i = 0; i < points_O.size(); ++i) {
    const Vec3 u = (points_O[i] - grid_->origin_O) * grid_->inverse_voxel;
    const openvdb::Vec3d at(u.x(), u.y(), u.z());
    values_m[i] = scale * openvdb::tools::BoxSampler::sample(accessor, at);
  }
}

std::size_t VdbField::bytes() const { return grid_->grid->memUsage(); }

const char* VdbField::version() { return OPENVDB_LIBRARY_VERSION_STRING; }

}  // namespace tact::bench
