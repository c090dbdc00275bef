#pragma once
#include <array>
#include <cstdint>

#include "coupling/device/device.hpp"
#include "session/session.hpp"

namespace tact::coupling {

/// A person's hand on the handle: a spring and damper from where the hand is to where it aims, of limited strength, and
/// passive tissue that only ever brakes. The aim follows the target (the script's pose, or the mouse's) like a person
/// would: with a lag, at limited speed, never in a jump.
///
///   F = cap(k (p_aim - p_H) + b (v_aim - v_H), force_max) - b_tissue v_H + tremor      torque likewise
///
/// Tremor: each axis three sines about tremor_hz (0.93, 1 and 1.07 of it), a third of tremor_n each, phases from the
/// seed; torque with a lever of 20 mm. Grip: gains change with a lag of 50 ms; absent, the hand exerts nothing and its
/// mass is gone; taking hold again begins where the handle is. Frame H. Real time after construction.
class SimulatedHand {
 public:
  enum class Grip { normal, soft, stiff, absent };
  struct Params {
    double force_max_n = 20, torque_max_nm = 2;  ///< strength; tissue damping is not counted
    double stiffness_n_per_m = 800, stiffness_nm_per_rad = 8;
    double damping_n_s_per_m = 60, damping_nm_s_per_rad = 0.4;
    double tissue_n_s_per_m = 5, tissue_nm_s_per_rad = 0.02;
    double mass_kg = 0.4, inertia_kg_m2 = 0.0015;
    double follow_per_s = 30;                       ///< 1 / lag of the aim
    double speed_m_per_s = 1, speed_rad_per_s = 6;  ///< of the aim
    Grip grip = Grip::normal;
    double tremor_n = 0, tremor_hz = 10;
    std::uint64_t seed = 1;
  };

  /// `motion_WH`: poses of H; empty: no script, the hand stays at X_WH.
  SimulatedHand(const Params& params, HandMotion motion_WH, const Pose& X_WH);

  /// One period: moves the script on (only while haptics are live and the mouse does not hold) and the aim.
  void advance(const HandCue& cue, const Pose& X_WH, double dt) noexcept;
  /// From now on, with its lag.
  void set_grip(Grip grip) noexcept { grip_ = grip; }

  /// Of the hand on the handle, about H's origin, in W.
  Wrench wrench_W(const Pose& X_WH, const Twist& V_WH) const noexcept;

  /// On the handle: none when absent.
  double mass_kg() const noexcept { return hold_.mass * params_.mass_kg; }
  double inertia_kg_m2() const noexcept { return hold_.mass * params_.inertia_kg_m2; }
  const Params& params() const noexcept { return params_; }
  double script_time_s() const noexcept { return motion_.time_s.empty() ? -1 : time_s_; }
  bool script_done() const noexcept { return !motion_.time_s.empty() && time_s_ >= motion_.time_s.back(); }
  const Pose& X_W_aim() const noexcept { return X_W_aim_; }

 private:
  struct Hold {  // factors on the gains
    double stiffness = 1, damping = 1, strength = 1, tissue = 1, mass = 1;
  };
  static constexpr int kSines = 3;

  static Hold hold_of(Grip grip) noexcept;
  Pose script_pose() noexcept;
  Vec6 tremor() const noexcept;

  Params params_;
  HandMotion motion_;
  std::size_t segment_ = 0;  // of the motion, holds time_s_
  double time_s_ = 0;
  bool held_ = false;
  Pose X_W_target_, X_W_aim_;
  Twist V_W_aim_;
  Grip grip_ = Grip::normal;
  Hold hold_;
  double life_s_ = 0;  // since the beginning, script or not
  std::array<std::array<double, kSines>, 6> phase_{};
};

}  // namespace tact::coupling
