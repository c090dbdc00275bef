#include "coupling/loop/session_config.hpp"

#include <gtest/gtest.h>

#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

/// A person leads the mesh, in the world; the device is held somewhere else, smaller, and turned.
TEST(TakeBodies, TheHandLeadsTheMeshFrameAlongTheMotionWhereverTheDeviceStands) {
  LoopConfig config;
  config.X_TM = {{0.02, 0.01, 0}, exp_so3({0, 0, 0.5})};
  const Pose start_M{{0.1, 0, 0}, Quat::Identity()}, goal_M{{0.1, 0.2, 0}, exp_so3({0, 0, 1})};
  config.X_WT_start = start_M * config.X_TM.inverse();
  for (const double scale : {1.0, 2.0}) {
    config.mapping = {.X_WB = {{0.3, -0.2, 0.1}, exp_so3({0.2, 0.4, -0.1})}, .scale = scale, .placed = scale > 1};
    DeviceOptions options;
    options.mode = "impedance";
    options.hand_motion = {{0, 0.5}, {start_M, goal_M}};
    take_bodies(config, options);
    const auto device = open_device(options);
    device->cue({.live = true, .hold = false, .X_WH_target = {}});
    for (int i = 0; i < 3000; ++i) device->write(Wrench{});
    WorkspaceMapping mapping(config.mapping, config.X_WT_start);
    const Pose X_WM = mapping.to_world(device->read().X_WH) * config.X_TM;
    EXPECT_LT(displacement(goal_M, X_WM).norm(), 1e-4) << scale;
  }
}

}  // namespace
}  // namespace tact::coupling
