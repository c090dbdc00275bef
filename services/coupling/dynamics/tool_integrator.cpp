#include "coupling/dynamics/tool_integrator.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace tact::coupling {
namespace {

constexpr int kNewtonSteps = 4;

/// A needle or a plate of points has no inertia about some axis: bounded below at this fraction of its largest.
constexpr double kInertiaFloor = 0.01;

Vec6 stack(const Vec3& a, const Vec3& b) { return (Vec6() << a, b).finished(); }

/// Solves A V = r; with rotation locked only the translational part, V's angular part is zero.
Vec6 solve(const Mat6& A, const Vec6& r, bool rotation_locked) {
  if (!rotation_locked) return A.partialPivLu().solve(r);
  const Mat3 A_linear = A.topLeftCorner<3, 3>();
  return stack(A_linear.partialPivLu().solve(r.head<3>()), Vec3::Zero());
}

}  // namespace

struct ToolIntegrator::Step {
  bool two_bodies = false;
  bool rotation_locked = false;
  double h = 0;
  Vec6 V_T0, V_H0, F_hand = Vec6::Zero();
  Mat6 M_T, M_H = Mat6::Zero();
  Mat6 A_T;  // M + h^2 K + h B: tool without coupling
  Vec6 r_T;  // M V + h F + h B V
  Vec6 V_T, V_H;

  /// Both twists at the end of the step with F_VC = g + C (V_H' - V_T').
  void solve_coupled(const Vec6& g, const Mat6& C) noexcept {
    const Mat6 hC = h * C;
    if (!two_bodies) {
      V_H = V_H0;
      V_T = solve(A_T + hC, r_T + h * g + hC * V_H0, rotation_locked);
      return;
    }
    // [A_T + hC, -hC; -hC, M_H + hC] [V_T; V_H] = [r_T + h g; r_H - h g], V_H eliminated.
    const Vec6 r_H = M_H * V_H0 + h * (F_hand - g);
    const Eigen::PartialPivLU<Mat6> A_H(M_H + hC);
    const Mat6 E = A_H.solve(hC);
    V_T = solve(A_T + hC - hC * E, r_T + h * g + hC * A_H.solve(r_H), rotation_locked);
    V_H = A_H.solve(r_H) + E * V_T;
    if (rotation_locked) V_H.tail<3>().setZero();
  }

  /// The same with a given coupling wrench.
  void solve_applied(const Vec6& F_VC) noexcept {
    V_T = solve(A_T, r_T + h * F_VC, rotation_locked);
    V_H = two_bodies ? solve(M_H, M_H * V_H0 + h * (F_hand - F_VC), rotation_locked) : V_H0;
  }
};

ToolIntegrator::ToolIntegrator(const Params& params) : params_(params) {
  const Mat3 shape = 0.5 * (params.inertia_shape_m2 + params.inertia_shape_m2.transpose());
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(shape);
  const Vec3 principal = eigen.eigenvalues().cwiseMax(kInertiaFloor * eigen.eigenvalues().maxCoeff());
  inertia_T_ = params.mass_kg * eigen.eigenvectors() * principal.asDiagonal() * eigen.eigenvectors().transpose();
  inverse_inertia_T_ = inertia_T_.inverse();
}

void ToolIntegrator::reset(const Pose& X_WT) noexcept {
  tool_ = handle_ = {X_WT, {}};
  rotation_error_.reset();
  F_coupling_W_ = {};
  saturated_ = false;
}

void ToolIntegrator::step(const BodyState& handle, const ContactLoad& contact, const CouplingGains& gains,
                          double tool_damping, double h) noexcept {
  handle_ = handle;
  Step step;
  advance(step, contact, gains, tool_damping, h);
  move(tool_, step.V_T, h);
}

void ToolIntegrator::step(const Wrench& F_hand_W, const ContactLoad& contact, const CouplingGains& gains,
                          double tool_damping, double h) noexcept {
  Step step;
  step.two_bodies = true;
  step.F_hand = F_hand_W.vector();
  step.M_H = mass_matrix(handle_.X_W.q);
  advance(step, contact, gains, tool_damping, h);
  move(tool_, step.V_T, h);
  move(handle_, step.V_H, h);
}

void ToolIntegrator::advance(Step& step, const ContactLoad& contact, const CouplingGains& gains, double tool_damping,
                             double h) noexcept {
  const bool implicit = params_.integrator == Integrator::implicit;
  const Mat3 R_WT = tool_.X_W.R();
  const Mat3 B_r = R_WT * gains.B_r_T * R_WT.transpose();
  const Vec3& error = rotation_error_.update(handle_.X_W.q, tool_.X_W.q);
  const Vec6 s0 = stack(gains.k * (handle_.X_W.p - tool_.X_W.p), gains.k_r * error);

  step.rotation_locked = params_.rotation_locked;
  step.h = h;
  step.V_T0 = tool_.V_W.vector();
  step.V_H0 = handle_.V_W.vector();
  step.M_T = mass_matrix(tool_.X_W.q);
  // The brake, scaled for rotation by the tool's inertia; always implicit: it can only slow down.
  const Mat6 brake = (tool_damping / params_.mass_kg) * step.M_T;
  step.A_T = step.M_T + h * brake;
  step.r_T = step.M_T * step.V_T0 + h * contact.F_W.vector();

  const auto capped = [&gains](const Vec6& s) {
    return Vec6(gains.strength * stack(cap(s.head<3>(), gains.force_max), cap(s.tail<3>(), gains.torque_max)));
  };
  const auto beyond_cap = [&gains](const Vec6& s) {
    return s.head<3>().norm() > gains.force_max || s.tail<3>().norm() > gains.torque_max;
  };

  Vec6 F_VC;
  if (!implicit) {
    Mat6 D = Mat6::Zero();
    D.topLeftCorner<3, 3>() = gains.b * Mat3::Identity();
    D.bottomRightCorner<3, 3>() = B_r;
    const Vec6 s = s0 + D * (step.V_H0 - step.V_T0);
    saturated_ = beyond_cap(s);
    F_VC = capped(s);
    step.solve_applied(F_VC);
  } else {
    step.A_T += h * h * contact.K + h * contact.B;
    step.r_T += h * contact.B * step.V_T0;
    Mat6 D = Mat6::Zero();
    D.topLeftCorner<3, 3>() = (h * gains.k + gains.b) * Mat3::Identity();
    D.bottomRightCorner<3, 3>() = h * gains.k_r * rotation_error_.gradient() + B_r;

    step.solve_coupled(gains.strength * s0, gains.strength * D);
    Vec6 s = s0 + D * (step.V_H - step.V_T);
    saturated_ = beyond_cap(s);
    if (saturated_) {
      for (int i = 0; i < kNewtonSteps; ++i) {
        Mat6 J = Mat6::Zero();
        J.topLeftCorner<3, 3>() = gains.strength * cap_gradient(s.head<3>(), gains.force_max);
        J.bottomRightCorner<3, 3>() = gains.strength * cap_gradient(s.tail<3>(), gains.torque_max);
        step.solve_coupled(capped(s) + J * (s0 - s), J * D);
        const Vec6 next = s0 + D * (step.V_H - step.V_T);
        const double change = (next - s).norm();
        s = next;
        if (change <= 1e-9 * s.norm()) break;
      }
      F_VC = capped(s);
      step.solve_applied(F_VC);
    } else {
      F_VC = gains.strength * s;
    }
  }
  if (params_.rotation_locked) F_VC.tail<3>().setZero();
  F_coupling_W_ = Wrench::from(F_VC);
}

Mat6 ToolIntegrator::mass_matrix(const Quat& q) const noexcept {
  const Mat3 R = q.toRotationMatrix();
  Mat6 M = Mat6::Zero();
  M.topLeftCorner<3, 3>() = params_.mass_kg * Mat3::Identity();
  M.bottomRightCorner<3, 3>() = R * inertia_T_ * R.transpose();
  return M;
}

void ToolIntegrator::move(BodyState& body, const Vec6& V, double h) const noexcept {
  const Mat3 R = body.X_W.R();
  body.X_W = displaced(body.X_W, h * V);
  body.V_W = Twist::from(V);
  if (params_.rotation_locked) return;
  const Vec3 L = R * (inertia_T_ * (R.transpose() * body.V_W.angular));
  const Mat3 R_next = body.X_W.R();
  body.V_W.angular = R_next * (inverse_inertia_T_ * (R_next.transpose() * L));
}

}  // namespace tact::coupling
