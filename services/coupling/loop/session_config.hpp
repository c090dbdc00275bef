#pragma once
#include "coupling/device/open_device.hpp"
#include "coupling/loop/coupling_loop.hpp"
#include "session/session.hpp"

namespace tact::coupling {

/// What coupling needs to know of the bodies, as the contact server baked them.
struct BodyModel {
  Pose X_TM;  ///< mesh frame of the tool in T
  Pose X_WO;
  Mat3 inertia_shape_m2 = Mat3::Zero();  ///< inertia of unit mass about To in T
  double gyration_radius_m = 0;
  double tool_radius_m = 0;  ///< farthest shell point from To
  double voxel_m = 0;
  double stiffness_n_per_m = 0, x_max_m = 0;
};

/// The scene's coupling keys as the loop takes them, version 0.
LoopParameters loop_parameters(const CouplingSpec& spec);

/// The loop a session asks for.
LoopConfig loop_config(const Session& session, const BodyModel& bodies);

/// The device a session asks for, before its bodies are known. Throws SetupError when the hand's motion cannot be read.
DeviceOptions device_options(const Session& session);
/// What they add: where the handle begins and how the hand leads it, in the device's frame; the shape of its inertia.
void take_bodies(const LoopConfig& config, DeviceOptions& options);

}  // namespace tact::coupling
