#include "coupling/dynamics/motion_limit.hpp"

#include <algorithm>

namespace tact::coupling {

double MotionLimit::motion_m(const Pose& X_WA, const Pose& X_WB) const noexcept {
  const Vec6 x = displacement(X_WA, X_WB);
  return x.head<3>().norm() + tool_radius_m * x.tail<3>().norm();
}

bool MotionLimit::apply(const Pose& X_answered, const Pose& X_before, BodyState& next,
                        double allowed_m) const noexcept {
  const double after = motion_m(X_answered, next.X_W);
  const double before = motion_m(X_answered, X_before);
  if (after <= allowed_m || after <= before) return false;
  const double step = motion_m(X_before, next.X_W);
  const double part = std::clamp((allowed_m - before) / step, 0.0, 1.0);
  next.X_W = displaced(X_before, part * displacement(X_before, next.X_W));
  next.V_W = Twist::from(part * next.V_W.vector());
  return true;
}

}  // namespace tact::coupling
