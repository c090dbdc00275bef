#include "coupling/dynamics/virtual_coupling.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

namespace tact::coupling {

CouplingGains coupling_gains(double k, double k_r, double damping_ratio, double mass, const Mat3& inertia_T) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(inertia_T);
  CouplingGains gains;
  gains.k = k;
  gains.k_r = k_r;
  gains.b = 2 * damping_ratio * std::sqrt(k * mass);
  gains.B_r_T = 2 * damping_ratio * std::sqrt(k_r) * eigen.operatorSqrt();
  return gains;
}

Vec3 cap(const Vec3& s, double m) noexcept {
  const double norm = s.norm();
  return norm > m ? Vec3(s * (m / norm)) : s;
}

Mat3 cap_gradient(const Vec3& s, double m) noexcept {
  const double norm = s.norm();
  if (norm <= m) return Mat3::Identity();
  const Vec3 u = s / norm;
  return (m / norm) * (Mat3::Identity() - u * u.transpose());
}

const Vec3& RotationError::update(const Quat& q_WH, const Quat& q_WT) noexcept {
  Vec3 shortest = log_so3(q_WH * q_WT.conjugate());
  const double angle = shortest.norm();
  if (shortest.dot(error_) < 0 && 2 * std::numbers::pi - angle <= std::numbers::pi + kHysteresis) {
    shortest *= (angle - 2 * std::numbers::pi) / angle;  // the same rotation, the long way round
  }
  error_ = shortest;
  return error_;
}

Mat3 RotationError::gradient() const noexcept {
  const double angle = error_.norm();
  if (angle < 1e-6) return Mat3::Identity();
  const double half = 0.5 * angle;
  const double c = half < 0.5 * std::numbers::pi ? half / std::tan(half) : 0.0;
  const Vec3 u = error_ / angle;
  return c * Mat3::Identity() + (1 - c) * (u * u.transpose());
}

}  // namespace tact::coupling
