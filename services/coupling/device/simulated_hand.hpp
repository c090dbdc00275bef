#pragma once
#include "coupling/device/device.hpp"
#include "session/session.hpp"

namespace tact::coupling {

/// A person's hand on the handle: a spring and damper from where the hand is to where it aims, of limited strength, and
/// passive tissue that only ever brakes. The aim follows the target (the script's pose, or the mouse's) like a person
/// would: with a lag, at limited speed, never in a jump.
///
///   F = cap(k (p_aim - p_H) + b (v_aim - v_H), force_max) - b_tissue v_H      torque likewise
///
/// Frame H; the hand's mass moves with the handle. Real time after construction.
class SimulatedHand {
 public:
  struct Params {
    double force_max_n = 20, torque_max_nm = 2;  ///< strength; tissue damping is not counted
    double stiffness_n_per_m = 800, stiffness_nm_per_rad = 8;
    double damping_n_s_per_m = 60, damping_nm_s_per_rad = 0.4;
    double tissue_n_s_per_m = 5, tissue_nm_s_per_rad = 0.02;
    double mass_kg = 0.4, inertia_kg_m2 = 0.0015;
    double follow_per_s = 30;                       ///< 1 / lag of the aim
    double speed_m_per_s = 1, speed_rad_per_s = 6;  ///< of the aim
  };

  /// `motion_WH`: poses of H; empty: no script, the hand stays at X_WH.
  SimulatedHand(const Params& params, HandMotion motion_WH, const Pose& X_WH);

  /// One period: moves the script on (only while haptics are live and the mouse does not hold) and the aim.
  void advance(const HandCue& cue, const Pose& X_WH, double dt) noexcept;

  /// Of the hand on the handle, about H's origin, in W.
  Wrench wrench_W(const Pose& X_WH, const Twist& V_WH) const noexcept;

  const Params& params() const noexcept { return params_; }
  double script_time_s() const noexcept { return motion_.time_s.empty() ? -1 : time_s_; }
  bool script_done() const noexcept { return !motion_.time_s.empty() && time_s_ >= motion_.time_s.back(); }
  const Pose& X_W_aim() const noexcept { return X_W_aim_; }

 private:
  Pose script_pose() noexcept;

  Params params_;
  HandMotion motion_;
  std::size_t segment_ = 0;  // of the motion, holds time_s_
  double time_s_ = 0;
  bool held_ = false;
  Pose X_W_target_, X_W_aim_;
  Twist V_W_aim_;
};

}  // namespace tact::coupling
