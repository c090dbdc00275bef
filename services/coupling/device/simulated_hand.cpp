#include "coupling/device/simulated_hand.hpp"

#include <algorithm>

#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

Vec3 at_most(const Vec3& v, double m) {
  const double norm = v.norm();
  return norm > m ? Vec3(v * (m / norm)) : v;
}

}  // namespace

SimulatedHand::SimulatedHand(const Params& params, HandMotion motion_WH, const Pose& X_WH)
    : params_(params), motion_(std::move(motion_WH)), X_W_target_(X_WH), X_W_aim_(X_WH) {}

void SimulatedHand::advance(const HandCue& cue, const Pose& X_WH, double dt) noexcept {
  const bool let_go = held_ && !cue.hold;
  held_ = cue.hold;
  if (cue.hold) {
    X_W_target_ = cue.X_WH_target;
  } else if (!motion_.time_s.empty() && !script_done()) {
    if (cue.live) time_s_ = std::min(time_s_ + dt, motion_.time_s.back());
    if (cue.live || let_go) X_W_target_ = script_pose();
  } else if (let_go) {
    X_W_target_ = X_W_aim_ = X_WH;  // rest where it is, do not go on pulling
  }
  const Vec6 miss = displacement(X_W_aim_, X_W_target_);
  V_W_aim_ = {at_most(params_.follow_per_s * miss.head<3>(), params_.speed_m_per_s),
              at_most(params_.follow_per_s * miss.tail<3>(), params_.speed_rad_per_s)};
  X_W_aim_ = displaced(X_W_aim_, std::min(dt, 1 / params_.follow_per_s) * V_W_aim_.vector());
}

Wrench SimulatedHand::wrench_W(const Pose& X_WH, const Twist& V_WH) const noexcept {
  const Vec6 miss = displacement(X_WH, X_W_aim_);
  const Vec3 force =
      params_.stiffness_n_per_m * miss.head<3>() + params_.damping_n_s_per_m * (V_W_aim_.linear - V_WH.linear);
  const Vec3 torque =
      params_.stiffness_nm_per_rad * miss.tail<3>() + params_.damping_nm_s_per_rad * (V_W_aim_.angular - V_WH.angular);
  return {at_most(force, params_.force_max_n) - params_.tissue_n_s_per_m * V_WH.linear,
          at_most(torque, params_.torque_max_nm) - params_.tissue_nm_s_per_rad * V_WH.angular};
}

Pose SimulatedHand::script_pose() noexcept {
  const auto& time = motion_.time_s;
  const auto& pose = motion_.X_WM;
  if (time_s_ <= time.front()) return pose.front();
  if (time_s_ >= time.back()) return pose.back();
  while (time[segment_ + 1] < time_s_) ++segment_;
  const double part = (time_s_ - time[segment_]) / (time[segment_ + 1] - time[segment_]);
  return displaced(pose[segment_], part * displacement(pose[segment_], pose[segment_ + 1]));
}

}  // namespace tact::coupling
