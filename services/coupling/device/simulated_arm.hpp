#pragma once
#include "math/exp_log.hpp"

namespace tact::coupling {

/// The mechanics and motors of the simulated arm, about the handle.
///   M dV/dt = F_hand + F_motor - friction V - Coulomb V/|V|      semi-implicit; Coulomb never reverses a motion
/// Motors: |F| <= peak, and not for long: their heat q follows (|F| / continuous)^2 with the time constant thermal_s;
/// at q = 1 they are hot and give four fifths of the continuous force until q < 0.8. The limit moves over 0.5 s, both
/// ways. Workspace: a ball about the start; its border is hard and takes the outward motion away. Real time.
class SimulatedArm {
 public:
  struct Params {
    double mass_kg = 0.8, inertia_kg_m2 = 0.003;
    double friction_n_s_per_m = 2, friction_nm_s_per_rad = 0.02;
    double coulomb_n = 0;  ///< on torques with a lever of 50 mm
    double force_peak_n = 35, torque_peak_nm = 3;
    double force_continuous_n = 0;  ///< torque in proportion; 0: the peak for ever
    double thermal_s = 20;
    double workspace_m = 0;  ///< radius; 0: no border
  };

  SimulatedArm(const Params& params, const Pose& X_WH) : params_(params), X_W_start_(X_WH), X_WH_(X_WH) {}

  const Pose& X_WH() const noexcept { return X_WH_; }
  const Twist& V_WH() const noexcept { return V_WH_; }
  bool hot() const noexcept { return hot_; }

  /// What the motors make of a wanted wrench now.
  Wrench motor(const Wrench& wanted_W) const noexcept;
  /// `F_motor_W`: of motor(). The hand's mass moves with the arm.
  void advance(const Wrench& F_hand_W, const Wrench& F_motor_W, double hand_mass_kg, double hand_inertia_kg_m2,
               double dt) noexcept;
  /// Too hot from outside.
  void heat() noexcept { heat_ = 1.25; }

 private:
  double limit() const noexcept;  // fraction of the peak

  Params params_;
  Pose X_W_start_, X_WH_;
  Twist V_WH_;
  double heat_ = 0, hot_part_ = 0;
  bool hot_ = false;
};

}  // namespace tact::coupling
