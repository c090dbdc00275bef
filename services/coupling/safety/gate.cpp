#include "coupling/safety/gate.hpp"

#include <algorithm>
#include <cmath>

namespace tact::coupling {
namespace {

/// Farther than this from unit length a quaternion is an error, not rounding.
constexpr double kUnitTolerance = 1e-3;

/// No handle is farther from its base; the difference of two huge poses would not be finite.
constexpr double kFar_m = 1e6;

bool valid(const Pose& X) {
  return X.finite() && X.p.cwiseAbs().maxCoeff() <= kFar_m && std::abs(X.q.norm() - 1) < kUnitTolerance;
}

/// v shortened to norm at most m; tells when it was. Scaled first: the square of a huge number is not finite.
Vec3 clamped(const Vec3& v, double m, bool& limited) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest <= m / 2) return v;  // norm <= sqrt(3) largest
  const Vec3 scaled = v / largest;
  const double norm = scaled.norm();
  if (largest * norm <= m) return v;
  limited = true;
  return scaled * (m / norm);
}

}  // namespace

void EngageRamp::advance(bool engaged, double h, double ramp_s) noexcept {
  value_ = engaged ? std::min(1.0, value_ + h / ramp_s) : 0.0;
}

Wrench WrenchGate::limit(const Wrench& wanted, bool engaged, double h) noexcept {
  report_ = {};
  ramp_.advance(engaged, h, limits_.ramp_s);
  if (!engaged) return last_ = {};
  Wrench w = wanted;
  if (!w.vector().allFinite()) {
    report_.not_finite = true;
    w = {};
  }
  w.force = clamped(w.force, limits_.force_n * ramp_.value(), report_.limited);
  w.torque = clamped(w.torque, limits_.torque_nm * ramp_.value(), report_.limited);
  last_.force += clamped(w.force - last_.force, limits_.force_slope_n_per_s * h, report_.limited);
  last_.torque += clamped(w.torque - last_.torque, limits_.torque_slope_nm_per_s * h, report_.limited);
  return last_;
}

void SetPointGate::limit(const Pose& X_wanted, const Twist& V_wanted, const Pose& X_WH, bool engaged, double h,
                         Pose& X_sent, Twist& V_sent) noexcept {
  report_ = {};
  ramp_.advance(engaged, h, limits_.ramp_s);
  if (valid(X_WH)) {
    last_X_WH_ = {X_WH.p, X_WH.q.normalized()};
  } else {
    report_.not_finite = true;
  }
  if (!engaged || !any_) {
    any_ = true;
    X_sent = last_ = last_X_WH_;
    V_sent = last_V_ = {};
    return;
  }
  X_sent = {X_wanted.p, X_wanted.q.normalized()};
  V_sent = V_wanted;
  if (!valid(X_wanted) || !V_wanted.vector().allFinite()) {
    report_.not_finite = true;
    X_sent = last_;
    V_sent = {};
  }
  // Half of the force slope is the spring's, by the set-point's step; half the damper's, by its change of twist.
  const double force_slope = limits_.force_slope_n_per_s / 2, torque_slope = limits_.torque_slope_nm_per_s / 2;
  const double speed = std::min(limits_.speed_m_per_s, force_slope / limits_.spring_n_per_m);
  const double turn = std::min(limits_.speed_rad_per_s, torque_slope / limits_.spring_nm_per_rad);
  V_sent.linear = clamped(V_sent.linear, speed * ramp_.value(), report_.limited);
  V_sent.angular = clamped(V_sent.angular, turn * ramp_.value(), report_.limited);
  if (limits_.damper_n_s_per_m > 0) {
    const double most = force_slope * h / limits_.damper_n_s_per_m;
    V_sent.linear = last_V_.linear + clamped(V_sent.linear - last_V_.linear, most, report_.limited);
  }
  if (limits_.damper_nm_s_per_rad > 0) {
    const double most = torque_slope * h / limits_.damper_nm_s_per_rad;
    V_sent.angular = last_V_.angular + clamped(V_sent.angular - last_V_.angular, most, report_.limited);
  }
  last_V_ = V_sent;
  const Vec6 step = displacement(last_, X_sent);
  X_sent = displaced(last_, (Vec6() << clamped(step.head<3>(), speed * h, report_.limited),
                             clamped(step.tail<3>(), turn * h, report_.limited))
                                .finished());
  const Vec6 reach = displacement(last_X_WH_, X_sent);
  X_sent = displaced(
      last_X_WH_,
      (Vec6() << clamped(reach.head<3>(), ramp_.value() * limits_.force_n / limits_.spring_n_per_m, report_.limited),
       clamped(reach.tail<3>(), ramp_.value() * limits_.torque_nm / limits_.spring_nm_per_rad, report_.limited))
          .finished());
  last_ = X_sent;
}

}  // namespace tact::coupling
