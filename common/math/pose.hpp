#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>

namespace tact {

using Vec3 = Eigen::Vector3d;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat3 = Eigen::Matrix3d;
using Mat6 = Eigen::Matrix<double, 6, 6>;
using Quat = Eigen::Quaterniond;

/// Pose X_AB of frame B in frame A: p_A = q_AB * p_B + p_AB. Metres, unit quaternion. Names carry both frames and inner
/// letters cancel: X_AC = X_AB * X_BC.
struct Pose {
  Vec3 p = Vec3::Zero();
  Quat q = Quat::Identity();

  Mat3 R() const { return q.toRotationMatrix(); }
  Pose inverse() const {
    const Quat qi = q.conjugate();
    return {-(qi * p), qi};
  }
  bool finite() const { return p.allFinite() && q.coeffs().allFinite(); }
};

inline Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {X_AB.p + X_AB.q * X_BC.p, (X_AB.q * X_BC.q).normalized()};
}
inline Vec3 operator*(const Pose& X_AB, const Vec3& p_B) { return X_AB.p + X_AB.q * p_B; }

/// Velocity of a frame's origin and its angular velocity: m/s, rad/s. Linear before angular, always.
struct Twist {
  Vec3 linear = Vec3::Zero();
  Vec3 angular = Vec3::Zero();

  Vec6 vector() const { return (Vec6() << linear, angular).finished(); }
  static Twist from(const Vec6& v) { return {v.head<3>(), v.tail<3>()}; }
};

/// Force and torque about a stated origin: N, Nm.
struct Wrench {
  Vec3 force = Vec3::Zero();
  Vec3 torque = Vec3::Zero();

  Vec6 vector() const { return (Vec6() << force, torque).finished(); }
  static Wrench from(const Vec6& v) { return {v.head<3>(), v.tail<3>()}; }
};

}  // namespace tact
