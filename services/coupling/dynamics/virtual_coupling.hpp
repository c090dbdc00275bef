#pragma once
#include <limits>

#include "math/exp_log.hpp"

namespace tact::coupling {

/// The spring and damper between handle H and tool T, on their relative pose and twist ([P] eq. 14 in six dimensions):
///
///   s_f   = k (p_H - p_T) + b (v_H - v_T)
///   s_tau = k_r log(R_H R_T^T) + B_r (w_H - w_T)
///   F_VC  = strength * (cap(s_f, force_max), cap(s_tau, torque_max)),   cap(s, m) = s min(1, m / |s|)
///
/// The cap ([P] eq. 15: force_max = k_contact x_max) holds for spring and damper together. **+F_VC acts on the tool,
/// -F_VC on the handle** ([P] fig. 13's text has the signs the other way round, which repels).
struct CouplingGains {
  double k = 0;                                                 ///< N/m
  double b = 0;                                                 ///< N s/m
  double k_r = 0;                                               ///< Nm/rad
  Mat3 B_r_T = Mat3::Zero();                                    ///< Nm s/rad, in T
  double force_max = std::numeric_limits<double>::infinity();   ///< N
  double torque_max = std::numeric_limits<double>::infinity();  ///< Nm
  double strength = 1;  ///< 0..1: fades the coupling out when replies are late and in after
};

/// k, k_r and their critical damping times `damping_ratio`: b = 2 z sqrt(k m), B_r = 2 z sqrt(k_r) sqrt(I) (matrix
/// square root: each principal axis at its own inertia). A microsecond, no allocation.
CouplingGains coupling_gains(double k, double k_r, double damping_ratio, double mass, const Mat3& inertia_T);

/// s min(1, m / |s|), finite for any finite s and m >= 0.
Vec3 cap(const Vec3& s, double m) noexcept;

/// d cap / ds: identity inside, (m / |s|) (1 - s s^T / |s|^2) outside. Symmetric, eigenvalues in [0, 1].
Mat3 cap_gradient(const Vec3& s, double m) noexcept;

/// log(R_H R_T^T) with memory: the shortest way, except that within kHysteresis beyond half a turn it stays on the side
/// it came from, so that a torque at its largest does not flip from one tick to the next.
class RotationError {
 public:
  static constexpr double kHysteresis = 0.35;  ///< rad

  /// In W, rad. Norm at most pi + kHysteresis.
  const Vec3& update(const Quat& q_WH, const Quat& q_WT) noexcept;
  const Vec3& value() const noexcept { return error_; }
  void reset() noexcept { error_.setZero(); }

  /// Symmetric part of d log / d theta at the present error, u its axis: u u^T + c (1 - u u^T), c = (a/2) cot(a/2) from
  /// 1 at a = 0 to 0 at half a turn and beyond.
  Mat3 gradient() const noexcept;

 private:
  Vec3 error_ = Vec3::Zero();
};

}  // namespace tact::coupling
