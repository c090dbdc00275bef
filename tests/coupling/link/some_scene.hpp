#pragma once
#include <algorithm>

#include "link/convert.hpp"
#include "link/wire.hpp"

namespace tact::coupling {

/// A scene that a contact server might announce.
inline wire::SceneInfo some_scene() {
  wire::SceneInfo info{};
  info.schema = wire::kSchema;
  info.server_epoch = 1;
  info.field_hash = 11;
  info.shell_hash = 22;
  info.X_TM.orientation.w = info.X_WO.orientation.w = 1;
  tact::to_wire(Mat3(Vec3(4e-4, 5e-4, 8e-4).asDiagonal()), info.inertia_shape_m2);
  info.gyration_radius_m = 0.025;
  info.tool_radius_m = 0.03;
  info.voxel_m = 1e-3;
  info.stiffness_n_per_m = 20000;
  info.x_max_m = 5e-4;
  return info;
}

}  // namespace tact::coupling
