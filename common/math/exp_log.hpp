#pragma once
#include "math/pose.hpp"

namespace tact {

/// [v]x: skew(v) * a = v x a.
inline Mat3 skew(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation by the vector theta (rad), exact near zero. R <- exp(dtheta) R is a left increment.
Quat exp_so3(const Vec3& theta);

/// Rotation vector (rad) of q, the shortest way: norm at most pi. Inverse of exp_so3.
Vec3 log_so3(const Quat& q);

/// Displacement x = (translation of the origin, left rotation increment) that takes X_WA to X_WB:
/// p_B = p_A + x.head<3>(), R_B = exp(x.tail<3>()) R_A.
Vec6 displacement(const Pose& X_WA, const Pose& X_WB);

/// Inverse of displacement().
Pose displaced(const Pose& X_WA, const Vec6& x);

}  // namespace tact
