#pragma once
#include "math/exp_log.hpp"

namespace tact::coupling {

/// The last thing before the motor, with a face for each device mode. Whatever comes in, what goes out is finite and
/// within the limits; the rest of the program is not trusted. No clock, no file, no allocation: numbers in, numbers
/// out.
struct GateLimits {
  double force_n = 30, torque_nm = 3;
  double force_slope_n_per_s = 5000, torque_slope_nm_per_s = 500;
  double speed_m_per_s = 2, speed_rad_per_s = 15;        ///< of a set-point
  double spring_n_per_m = 2000, spring_nm_per_rad = 5;   ///< of the driver, handle to set-point
  double damper_n_s_per_m = 0, damper_nm_s_per_rad = 0;  ///< of the driver, on the difference of their twists
  double ramp_s = 0.5;                                   ///< force and torque limits grow from 0 after engaging
};

/// What the gate had to do.
struct GateReport {
  bool limited = false;     ///< clamped or slowed
  bool not_finite = false;  ///< refused: not finite, or not a rotation
};

/// The limits' ramp since the device was engaged.
class EngageRamp {
 public:
  /// One tick; falls to 0 at once when not engaged.
  void advance(bool engaged, double h, double ramp_s) noexcept;
  double value() const noexcept { return value_; }

 private:
  double value_ = 0;
};

/// Impedance: finite, clamp, rate limit, in that order. Not finite counts as zero. Calm: wanted = zero.
class WrenchGate {
 public:
  explicit WrenchGate(const GateLimits& limits) : limits_(limits) {}

  /// Wrench to send for a tick of h seconds. Not engaged: zero at once (the motors are off).
  /// Norms of force and torque are at most limit * ramp, or where the limit itself fell, on the slope down to it.
  Wrench limit(const Wrench& wanted, bool engaged, double h) noexcept;
  const GateReport& report() const noexcept { return report_; }
  bool ramped() const noexcept { return ramp_.value() >= 1; }

 private:
  GateLimits limits_;
  EngageRamp ramp_;
  Wrench last_;
  GateReport report_;
};

/// Pseudo-admittance: finite and a unit quaternion (else: stay where we were, coming to rest), twist limit (speed,
/// ramp, and a change per tick that keeps the driver's damper within half the force slope), step limit from the last
/// set-point (speed, and what half the force slope allows over the driver's spring), and last of all the distance
/// to the handle: spring * |X_sent - X_handle| <= limit * ramp, whatever the step limit says: letting go is never
/// slowed by it. Calm: wanted = the handle at zero twist.
class SetPointGate {
 public:
  explicit SetPointGate(const GateLimits& limits) : limits_(limits) {}

  /// Set-point to send for a tick of h seconds. Not engaged: the handle itself. @pre X_WH is finite (else: see above,
  /// the last good handle pose is used).
  void limit(const Pose& X_wanted, const Twist& V_wanted, const Pose& X_WH, bool engaged, double h, Pose& X_sent,
             Twist& V_sent) noexcept;
  const GateReport& report() const noexcept { return report_; }
  bool ramped() const noexcept { return ramp_.value() >= 1; }

 private:
  GateLimits limits_;
  EngageRamp ramp_;
  bool any_ = false;
  Pose last_, last_X_WH_;
  Twist last_V_;
  GateReport report_;
};

}  // namespace tact::coupling
