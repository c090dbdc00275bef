#include "bench/peers/fcl_peer.hpp"

#include <fcl/config.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

namespace tact::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

void build(const Mesh& mesh, Model& model) {
  model.beginModel(static_cast<int>(mesh.triangles.size()), static_cast<int>(mesh.vertices.size()));
  for (const auto& t : mesh.triangles) {
    model.addTriangle(mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(),
                      mesh.vertices[t[2]].cast<double>());
  }
  model.endModel();
}

}  // namespace

struct FclPair::Models {
  Model obstacle, tool;
  fcl::CollisionResultd result;  // kept: its memory is reused
};

FclPair::FclPair(const Mesh& obstacle, const Mesh& tool) : models_(std::make_unique<Models>()) {
  build(obstacle, models_->obstacle);
  build(tool, models_->tool);
}

FclPair::~FclPair() = default;

std::size_t FclPair::collide(const Pose& X_OM, std::size_t most) {
  fcl::Transform3d transform = fcl::Transform3d::Identity();
  transform.linear() = X_OM.R();
  transform.translation() = X_OM.p;
  const fcl::CollisionRequestd request(most, true);
  models_->result.clear();
  return fcl::collide<double>(&models_->obstacle, fcl::Transform3d::Identity(), &models_->tool, transform, request,
                              models_->result);
}

const char* FclPair::version() { return FCL_VERSION; }

}  // namespace tact::bench
