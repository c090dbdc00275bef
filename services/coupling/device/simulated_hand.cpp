#include "coupling/device/simulated_hand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kGripLag_s = 0.05, kTremorLever_m = 0.02;
constexpr double kGone = 0.01;  // of its strength: the hand is off the handle

Vec3 at_most(const Vec3& v, double m) {
  const double norm = v.norm();
  return norm > m ? Vec3(v * (m / norm)) : v;
}

}  // namespace

SimulatedHand::SimulatedHand(const Params& params, HandMotion motion_WH, const Pose& X_WH)
    : params_(params),
      motion_(std::move(motion_WH)),
      X_W_target_(X_WH),
      X_W_aim_(X_WH),
      grip_(params.grip),
      hold_(hold_of(params.grip)) {
  std::mt19937_64 random(params.seed);
  for (auto& axis : phase_) {
    // Not std::uniform_real_distribution: the same on every library.
    for (double& phase : axis) phase = 2 * std::numbers::pi * std::ldexp(static_cast<double>(random() >> 11), -53);
  }
}

SimulatedHand::Hold SimulatedHand::hold_of(Grip grip) noexcept {
  switch (grip) {
    case Grip::normal:
      break;
    case Grip::soft:
      return {0.25, 0.5, 0.5, 1, 1};
    case Grip::stiff:
      return {2.5, 1.6, 1, 1, 1};
    case Grip::absent:
      return {0, 0, 0, 0, 0};
  }
  return {};
}

Vec6 SimulatedHand::tremor() const noexcept {
  Vec6 wave = Vec6::Zero();
  for (int axis = 0; axis < 6; ++axis) {
    for (int i = 0; i < kSines; ++i) {
      const double frequency = params_.tremor_hz * (1 + 0.07 * (i - 1));
      wave[axis] += std::sin(2 * std::numbers::pi * frequency * life_s_ +
                             phase_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(i)]);
    }
  }
  const double size = hold_.strength * params_.tremor_n / kSines;
  wave.head<3>() *= size;
  wave.tail<3>() *= size * kTremorLever_m;
  return wave;
}

void SimulatedHand::advance(const HandCue& cue, const Pose& X_WH, double dt) noexcept {
  life_s_ += dt;
  const Hold wanted = hold_of(grip_);
  if (hold_.strength < kGone && wanted.strength > 0) X_W_aim_ = X_WH;  // takes the handle where it is
  const double part = std::min(1.0, dt / kGripLag_s);
  const auto follow = [part](double& now, double to) {
    now = std::abs(to - now) < 1e-6 ? to : now + part * (to - now);
  };
  follow(hold_.stiffness, wanted.stiffness);
  follow(hold_.damping, wanted.damping);
  follow(hold_.strength, wanted.strength);
  follow(hold_.tissue, wanted.tissue);
  follow(hold_.mass, wanted.mass);

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
  const Vec3 force = hold_.stiffness * params_.stiffness_n_per_m * miss.head<3>() +
                     hold_.damping * params_.damping_n_s_per_m * (V_W_aim_.linear - V_WH.linear);
  const Vec3 torque = hold_.stiffness * params_.stiffness_nm_per_rad * miss.tail<3>() +
                      hold_.damping * params_.damping_nm_s_per_rad * (V_W_aim_.angular - V_WH.angular);
  Wrench F{at_most(force, hold_.strength * params_.force_max_n) - hold_.tissue * params_.tissue_n_s_per_m * V_WH.linear,
           at_most(torque, hold_.strength * params_.torque_max_nm) -
               hold_.tissue * params_.tissue_nm_s_per_rad * V_WH.angular};
  if (params_.tremor_n > 0) {
    const Vec6 shake = tremor();
    F.force += shake.head<3>();
    F.torque += shake.tail<3>();
  }
  return F;
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
