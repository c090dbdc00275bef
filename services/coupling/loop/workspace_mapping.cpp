#include "coupling/loop/workspace_mapping.hpp"

namespace tact::coupling {

WorkspaceMapping::WorkspaceMapping(const Params& params, const Pose& X_WH_start)
    : q_WB_(params.X_WB.q.normalized()),
      scale_(params.scale),
      t_(params.X_WB.p),
      free_(params.placed),
      X_WH_(X_WH_start) {}

DeviceReading WorkspaceMapping::read(const DeviceReading& device_B) noexcept {
  DeviceReading out = device_B;
  if (device_B.engaged && !engaged_ && !free_) {
    t_ = X_WH_.p - scale_ * (q_WB_ * device_B.X_WH.p);
    q_clutch_ = ((q_WB_ * device_B.X_WH.q).conjugate() * X_WH_.q).normalized();
  }
  if (device_B.engaged) free_ = false;
  engaged_ = device_B.engaged;
  if (engaged_ || free_) {
    out.X_WH = X_WH_ = to_world(device_B.X_WH);
    out.V_WH = to_world(device_B.V_WH);
    out.F_hand_W = to_world(device_B.F_hand_W);
  } else {
    out.X_WH = X_WH_;
    out.V_WH = {};
    out.F_hand_W = {};
  }
  return out;
}

Pose WorkspaceMapping::to_world(const Pose& X_BH) const noexcept {
  return {t_ + scale_ * (q_WB_ * X_BH.p), (q_WB_ * X_BH.q * q_clutch_).normalized()};
}
Twist WorkspaceMapping::to_world(const Twist& V_B) const noexcept {
  return {scale_ * (q_WB_ * V_B.linear), q_WB_ * V_B.angular};
}
Wrench WorkspaceMapping::to_world(const Wrench& F_B) const noexcept {
  return {q_WB_ * F_B.force, scale_ * (q_WB_ * F_B.torque)};
}
Pose WorkspaceMapping::to_device(const Pose& X_WH) const noexcept {
  const Quat q_BW = q_WB_.conjugate();
  return {q_BW * (X_WH.p - t_) / scale_, (q_BW * X_WH.q * q_clutch_.conjugate()).normalized()};
}
Twist WorkspaceMapping::to_device(const Twist& V_W) const noexcept {
  const Quat q_BW = q_WB_.conjugate();
  return {q_BW * V_W.linear / scale_, q_BW * V_W.angular};
}
Wrench WorkspaceMapping::to_device(const Wrench& F_W) const noexcept {
  const Quat q_BW = q_WB_.conjugate();
  return {q_BW * F_W.force, q_BW * F_W.torque / scale_};
}

}  // namespace tact::coupling
