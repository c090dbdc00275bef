#include "coupling/dynamics/tool_integrator.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace tact::coupling {
namespace {

constexpr int kNewtonSteps = 4;
/// Of the secant, put in where the cap leaves no slope at all: less after each whole step, more after each cut one. A
/// fixed part makes Newton converge linearly; none makes its system singular where no contact resists.
constexpr double kSlopeAlong = 0.1, kSlopeAlongLeast = 1e-6, kSlopeFalls = 0.3, kSlopeRises = 10;
constexpr int kStaticCuts = 4;
constexpr double kStaticReach_m = 0.1, kStaticReach_rad = 1;  // of one Newton step

/// A needle or a plate of points has no inertia about some axis: bounded below at this fraction of its largest.
constexpr double kInertiaFloor = 0.01;

Vec6 stack(const Vec3& a, const Vec3& b) { return (Vec6() << a, b).finished(); }

/// Solves A V = r; with rotation locked only the translational part, V's angular part is zero.
Vec6 solve(const Mat6& A, const Vec6& r, bool rotation_locked) {
  if (!rotation_locked) return A.partialPivLu().solve(r);
  const Mat3 A_linear = A.topLeftCorner<3, 3>();
  return stack(A_linear.partialPivLu().solve(r.head<3>()), Vec3::Zero());
}

Vec6 capped(const Vec6& s, const CouplingGains& gains) {
  return gains.strength * stack(cap(s.head<3>(), gains.force_max), cap(s.tail<3>(), gains.torque_max));
}

bool beyond_cap(const Vec6& s, const CouplingGains& gains) {
  return s.head<3>().norm() > gains.force_max || s.tail<3>().norm() > gains.torque_max;
}

/// Gradient of the cap, with the part `along` of the secant min(1, m / |s|) where it is singular.
Mat3 cap_slope(const Vec3& s, double m, double along) {
  const double norm = s.norm();
  if (norm <= m) return Mat3::Identity();
  const Vec3 u = s / norm;
  return cap_gradient(s, m) + (along * m / norm) * (u * u.transpose());
}

}  // namespace

struct ToolIntegrator::Step {
  bool two_bodies = false;
  bool rotation_locked = false;
  double h = 0;
  Vec6 V_T0, V_H0, F_hand = Vec6::Zero();
  Mat6 M_T, M_H = Mat6::Zero();
  Mat6 A_T;                  // M + h^2 K + h B: tool without coupling
  Vec6 r_T;                  // M V + h F + h B V
  Vec6 s0;                   // the spring as it is
  Mat6 B_VC = Mat6::Zero();  // the damper
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
  gyration_radius_m_ = std::sqrt(principal.sum() / 2);
}

void ToolIntegrator::select(CouplingKind kind, Integrator integrator) noexcept {
  if (kind == CouplingKind::direct && kind_ != kind) apart_ = displacement(handle_.X_W, tool_.X_W);
  kind_ = kind;
  integrator_ = integrator;
  static_residual_n_ = 0;
}

void ToolIntegrator::reset(const Pose& X_WT, const Pose& X_WH) noexcept {
  tool_ = {X_WT, {}};
  handle_ = {X_WH, {}};
  apart_ = displacement(X_WH, X_WT);
  rotation_error_.reset();
  F_coupling_W_ = {};
  saturated_ = false;
  static_residual_n_ = 0;
}

void ToolIntegrator::follow(const BodyState& handle, double h) noexcept {
  handle_ = handle;
  join(h);
}

void ToolIntegrator::pass_on(const Wrench& F_contact_W) noexcept {
  F_coupling_W_ = {-F_contact_W.force, params_.rotation_locked ? Vec3::Zero() : Vec3(-F_contact_W.torque)};
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
  if (kind_ == CouplingKind::direct) return step_joined(F_hand_W, contact, h);
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
  const Mat3 R_WT = tool_.X_W.R();
  const Vec3& error = rotation_error_.update(handle_.X_W.q, tool_.X_W.q);
  step.s0 = stack(gains.k * (handle_.X_W.p - tool_.X_W.p), gains.k_r * error);
  step.B_VC.topLeftCorner<3, 3>() = gains.b * Mat3::Identity();
  step.B_VC.bottomRightCorner<3, 3>() = R_WT * gains.B_r_T * R_WT.transpose();

  step.rotation_locked = params_.rotation_locked;
  step.h = h;
  step.V_T0 = tool_.V_W.vector();
  step.V_H0 = handle_.V_W.vector();
  step.r_T = h * contact.F_W.vector();
  if (kind_ == CouplingKind::dynamic) {
    step.M_T = mass_matrix(tool_.X_W.q);
    // The brake, scaled for rotation by the tool's inertia; always implicit: it can only slow down.
    step.A_T = step.M_T + h * (tool_damping / params_.mass_kg) * step.M_T;
    step.r_T += step.M_T * step.V_T0;
  } else {
    step.A_T.setZero();
  }
  if (kind_ != CouplingKind::dynamic || integrator_ == Integrator::implicit) {
    step.A_T += h * h * contact.K + h * contact.B;
    step.r_T += h * contact.B * step.V_T0;
  }

  Vec6 F_VC = kind_ != CouplingKind::dynamic             ? static_coupling(step, gains)
              : integrator_ == Integrator::semi_implicit ? explicit_coupling(step, gains)
                                                         : implicit_coupling(step, gains);
  if (params_.rotation_locked) F_VC.tail<3>().setZero();
  F_coupling_W_ = Wrench::from(F_VC);
}

Vec6 ToolIntegrator::explicit_coupling(Step& step, const CouplingGains& gains) noexcept {
  const Vec6 s = step.s0 + step.B_VC * (step.V_H0 - step.V_T0);
  saturated_ = beyond_cap(s, gains);
  const Vec6 F_VC = capped(s, gains);
  step.solve_applied(F_VC);
  return F_VC;
}

Vec6 ToolIntegrator::implicit_coupling(Step& step, const CouplingGains& gains) noexcept {
  Mat6 D = step.B_VC;
  D.topLeftCorner<3, 3>() += step.h * gains.k * Mat3::Identity();
  D.bottomRightCorner<3, 3>() += step.h * gains.k_r * rotation_error_.gradient();

  step.solve_coupled(gains.strength * step.s0, gains.strength * D);
  Vec6 s = step.s0 + D * (step.V_H - step.V_T);
  saturated_ = beyond_cap(s, gains);
  if (!saturated_) return gains.strength * s;
  for (int i = 0; i < kNewtonSteps; ++i) {
    Mat6 J = Mat6::Zero();
    J.topLeftCorner<3, 3>() = gains.strength * cap_gradient(s.head<3>(), gains.force_max);
    J.bottomRightCorner<3, 3>() = gains.strength * cap_gradient(s.tail<3>(), gains.torque_max);
    step.solve_coupled(capped(s, gains) + J * (step.s0 - s), J * D);
    const Vec6 next = step.s0 + D * (step.V_H - step.V_T);
    const double change = (next - s).norm();
    s = next;
    if (change <= 1e-9 * s.norm()) break;
  }
  const Vec6 F_VC = capped(s, gains);
  step.solve_applied(F_VC);
  return F_VC;
}

/// What is left of tool and handle equations is minus the gradient of a convex function of their twists (but for the
/// curvature of log): Newton, and along its direction a search for where that function stops falling.
Vec6 ToolIntegrator::static_coupling(Step& step, const CouplingGains& gains) noexcept {
  const bool handle_follows = step.two_bodies;
  if (integrator_ == Integrator::semi_implicit) step.two_bodies = false;  // the handle moves on as it did, for the tool
  const double h = step.h;
  // A tool without mass has no critical damping: one time constant for both makes the problem convex.
  step.B_VC.bottomRightCorner<3, 3>() = gains.b / gains.k * gains.k_r * Mat3::Identity();
  struct State {
    Vec6 V_T, V_H, s, F, left_T, left_H;
    Mat3 gradient;
  };
  const auto at = [&](const Vec6& V_T, const Vec6& V_H) {
    State to;
    to.V_T = V_T;
    to.V_H = V_H;
    const Pose X_WH = displaced(handle_.X_W, h * V_H), X_WT = displaced(tool_.X_W, h * V_T);
    RotationError error = rotation_error_;
    to.s = stack(gains.k * (X_WH.p - X_WT.p), gains.k_r * error.update(X_WH.q, X_WT.q)) + step.B_VC * (V_H - V_T);
    to.gradient = error.gradient();
    to.F = capped(to.s, gains);
    to.left_T = (step.r_T - step.A_T * V_T) / h + to.F;
    to.left_H.setZero();
    if (step.two_bodies) to.left_H = step.F_hand - to.F - step.M_H * (V_H - step.V_H0) / h;
    if (step.rotation_locked) {
      to.left_T.tail<3>().setZero();
      to.left_H.tail<3>().setZero();
    }
    return to;
  };
  const auto residual = [this](const State& state) {
    const auto norm = [this](const Vec6& F) {
      return std::hypot(F.head<3>().norm(), F.tail<3>().norm() / gyration_radius_m_);
    };
    return norm(state.left_T) + norm(state.left_H);
  };

  State now = at(step.V_T0, step.V_H0);
  double left = residual(now), along = kSlopeAlong;
  for (int i = 0; i < kStaticSteps && !(left <= kStaticResidual_n); ++i) {
    Mat6 D = step.B_VC;
    D.topLeftCorner<3, 3>() += h * gains.k * Mat3::Identity();
    D.bottomRightCorner<3, 3>() += h * gains.k_r * now.gradient;
    Mat6 J = Mat6::Zero();
    J.topLeftCorner<3, 3>() = gains.strength * cap_slope(now.s.head<3>(), gains.force_max, along);
    J.bottomRightCorner<3, 3>() = gains.strength * cap_slope(now.s.tail<3>(), gains.torque_max, along);
    const Mat6 C = J * D;
    step.solve_coupled(now.F - C * (now.V_H - now.V_T), C);
    Vec6 to_T = step.V_T - now.V_T, to_H = step.V_H - now.V_H;
    // Where contact pushes harder than the cap holds and nothing resists there is no balance, however far away.
    const double reach =
        std::max({1.0, h * to_T.head<3>().norm() / kStaticReach_m, h * to_T.tail<3>().norm() / kStaticReach_rad});
    to_T /= reach;
    to_H /= reach;
    const double slope = now.left_T.dot(to_T) + now.left_H.dot(to_H);
    State next;
    double part = 1;
    for (int cut = 0;; ++cut) {
      next = at(now.V_T + part * to_T, now.V_H + part * to_H);
      const double there = next.left_T.dot(to_T) + next.left_H.dot(to_H);
      if (there >= -0.5 * slope || cut == kStaticCuts) break;
      part *= std::clamp(slope / (slope - there), 0.02, 0.5);
    }
    along = part == 1 && reach == 1 ? std::max(kSlopeFalls * along, kSlopeAlongLeast)
                                    : std::min(kSlopeRises * along, kSlopeAlong);
    now = next;
    left = residual(now);
  }
  static_residual_n_ = left;
  saturated_ = beyond_cap(now.s, gains);
  step.V_T = now.V_T;
  step.V_H = handle_follows ? solve(step.M_H, step.M_H * step.V_H0 + h * (step.F_hand - now.F), step.rotation_locked)
                            : step.V_H0;
  return now.F;
}

void ToolIntegrator::step_joined(const Wrench& F_hand_W, const ContactLoad& contact, double h) noexcept {
  const Mat6 M = mass_matrix(handle_.X_W.q);
  const Vec6 V = handle_.V_W.vector();
  Mat6 A = M;
  Vec6 r = M * V + h * (contact.F_W.vector() + F_hand_W.vector());
  if (integrator_ == Integrator::implicit) {
    A += h * h * contact.K + h * contact.B;
    r += h * contact.B * V;
  }
  move(handle_, solve(A, r, params_.rotation_locked), h);
  join(h);
  F_coupling_W_ = F_hand_W;
  if (params_.rotation_locked) F_coupling_W_.torque.setZero();
  saturated_ = false;
}

void ToolIntegrator::join(double h) noexcept {
  apart_ *= std::exp(-h / kJoin_s);
  const Quat q = tool_.X_W.q;
  tool_ = {displaced(handle_.X_W, apart_), handle_.V_W};
  if (params_.rotation_locked) {
    tool_.X_W.q = q;
    tool_.V_W.angular.setZero();
  }
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
