#pragma once
#include "coupling/device/device.hpp"

namespace tact::coupling {

/// Between a device's own frame B (its base) and the world, for every device: orientation of the base, scale s, and the
/// clutch. Rotations are one to one, about the same axes.
///
///   p_WH = t + s R_WB p_BH        v_W = s R_WB v_B      force_W  = R_WB force_B
///   R_WH = R_WB R_BH R_clutch     w_W =   R_WB w_B      torque_W = s R_WB torque_B
///
/// Forces are the same on both sides and torques divided by s on their way to the hand: it holds a model of the tool
/// 1/s as large. So the power at the device is 1/s of that in W for every motion, translation and rotation alike: what
/// is passive in W is passive at the hand, and a closed path that costs nothing there costs nothing here. (Torques one
/// to one would make a lever pump energy.) The hand feels stiffness s k, mass s m, damping s b.
///
/// Clutch: while the device is not engaged X_WH stands still at rest; when it is again, t and R_clutch are such that
/// X_WH goes on from there, wherever the handle went. So it is when it is first engaged, from `X_WH_start`, unless the
/// base is `placed`: then the handle is where it is in the room until it is first let go. Real time: no allocation.
class WorkspaceMapping {
 public:
  struct Params {
    Pose X_WB;  ///< the position counts for a placed base only
    double scale = 1;
    bool placed = false;
  };

  WorkspaceMapping(const Params& params, const Pose& X_WH_start);

  /// One tick's reading, from B to W, with the clutch.
  DeviceReading read(const DeviceReading& device_B) noexcept;

  Pose to_world(const Pose& X_BH) const noexcept;
  Twist to_world(const Twist& V_B) const noexcept;
  Wrench to_world(const Wrench& F_B) const noexcept;
  Pose to_device(const Pose& X_WH) const noexcept;
  Twist to_device(const Twist& V_W) const noexcept;
  Wrench to_device(const Wrench& F_W) const noexcept;

 private:
  Quat q_WB_;
  double scale_;
  Vec3 t_;
  Quat q_clutch_ = Quat::Identity();
  bool engaged_ = false, free_;  // free_: no pose to go on from yet
  Pose X_WH_;                    // where the clutch left it
};

}  // namespace tact::coupling
