#include "math/exp_log.hpp"

#include <cmath>

namespace tact {

Quat exp_so3(const Vec3& theta) {
  const double a2 = theta.squaredNorm();
  if (a2 < 1e-12) {
    // sin(a/2)/a and cos(a/2) to fourth order.
    return Quat(1.0 - a2 / 8.0, theta.x() * (0.5 - a2 / 48.0), theta.y() * (0.5 - a2 / 48.0),
                theta.z() * (0.5 - a2 / 48.0))
        .normalized();
  }
  const double a = std::sqrt(a2);
  const Vec3 v = theta * (std::sin(0.5 * a) / a);
  return {std::cos(0.5 * a), v.x(), v.y(), v.z()};
}

Vec3 log_so3(const Quat& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Vec3 v = sign * q.vec();
  const double s = v.norm();
  const double c = sign * q.w();
  if (s < 1e-9) return 2.0 * v / c;
  return v * (2.0 * std::atan2(s, c) / s);
}

Vec6 displacement(const Pose& X_WA, const Pose& X_WB) {
  Vec6 x;
  x << X_WB.p - X_WA.p, log_so3(X_WB.q * X_WA.q.conjugate());
  return x;
}

Pose displaced(const Pose& X_WA, const Vec6& x) {
  return {X_WA.p + x.head<3>(), (exp_so3(x.tail<3>()) * X_WA.q).normalized()};
}

}  // namespace tact
