#pragma once
#include "coupling/dynamics/virtual_coupling.hpp"

namespace tact::coupling {

/// Contact wrench on the tool about To at its present pose and twist, as an implicit step takes it:
/// F(x, V) = F - K x - B (V - V_0). K and B are symmetric and positive semidefinite.
struct ContactLoad {
  Wrench F_W;
  Mat6 K = Mat6::Zero();  ///< the contact's stiffness, and what WrenchModel adds to damp the step
  Mat6 B = Mat6::Zero();  ///< of the dampers that are in F_W
};

struct BodyState {
  Pose X_W;
  Twist V_W;  ///< of the body's origin
};

/// How handle and tool hang together: not at all apart (direct), by a spring and damper on a tool without mass that is
/// in equilibrium every tick (static, [P:4]), or on a tool with mass (dynamic, [P:1]).
enum class CouplingKind { direct, quasi_static, dynamic };
enum class Integrator { semi_implicit, implicit };

/// Steps the tool (and in pseudo-admittance the handle body) under contact and virtual coupling. h: time step,
/// M: mass and inertia in W, V_H: twist of the handle, s: see virtual_coupling.hpp, D = ds/d(V_H - V_T).
///
/// Dynamic. Semi-implicit Euler: forces at the present state; V <- V + h M^-1 F; X <- exp(h V) X.
///
/// Implicit Euler, linearised in the contact and solved to convergence in the coupling's cap ([P] section 4, [P:2]):
///   tool    M (V_T' - V_T) = h (F - h K V_T' - B (V_T' - V_T) + F_VC)
///   handle  M (V_H' - V_H) = h (F_hand - F_VC)                     pseudo-admittance; otherwise V_H' = V_H is given
///   F_VC = strength cap(s + D (V_H' - V_T')),  D = h k + b and h k_r gradient + B_r
/// The coupling is taken where handle and tool will be at the end of the step. The 12x12 system of both bodies is
/// reduced to 6x6 by its exact Schur complement. The cap is met by a semi-smooth Newton iteration (at most four
/// solves); the coupling wrench it ends with is then applied as it is, so the cap and action = reaction are exact.
///
/// Static. The tool has no mass; where it will be at the end of the step (h V_T' away, h V_H' the handle)
///   F - h K V_T' - B (V_T' - V_T) + F_VC = 0,   F_VC = strength cap(k dp' + b dV', k_r log(R_H' R_T'^T) + (b / k) k_r
///   dw')
/// by Newton with K, the gradients of cap and log and a line search; at most kStaticSteps times, until the left side
/// is below kStaticResidual_n. The handle body is stepped as in
/// dynamic.
///
/// Direct. Handle and tool are one: impedance: the tool is where the handle is, the handle gets the contact wrench;
/// pseudo-admittance: one body of the tool's mass under both wrenches. Where they were apart when it began, the
/// difference decays within kJoin_s.
///
/// Rotation: angular momentum is carried over the step (w <- I(R')^-1 I(R) w), exactly conserved without torque.
/// Real time: bounded work (at most six 6x6 solves, static twenty-four), no allocation, no exceptions.
class ToolIntegrator {
 public:
  static constexpr int kStaticSteps = 24;
  static constexpr double kStaticResidual_n = 1e-6;  ///< torque counts over the tool's radius of gyration
  static constexpr double kJoin_s = 0.2;             ///< time constant

  struct Params {
    double mass_kg = 0.2;                             ///< of the tool; the handle body's is equal
    Mat3 inertia_shape_m2 = Mat3::Identity() * 1e-3;  ///< inertia of unit mass about To in T
    bool rotation_locked = false;                     ///< translation only, both bodies
  };

  /// Dynamic and implicit until select() says otherwise.
  explicit ToolIntegrator(const Params& params);

  /// From the next step on. Poses and twists go on as they are.
  void select(CouplingKind kind, Integrator integrator) noexcept;

  /// Both bodies at rest, the tool at X_WT, the handle at X_WH.
  void reset(const Pose& X_WT, const Pose& X_WH) noexcept;
  void reset(const Pose& X_WT) noexcept { reset(X_WT, X_WT); }

  /// Impedance, direct: the tool goes where the handle is.
  void follow(const BodyState& handle, double h) noexcept;
  /// After it: the contact wrench there, which the handle gets.
  void pass_on(const Wrench& F_contact_W) noexcept;

  /// Impedance otherwise: the handle's state is the device's. `tool_damping` (N s/m) brakes the tool against the world:
  /// for coming to rest while the coupling is faded out.
  void step(const BodyState& handle, const ContactLoad& contact, const CouplingGains& gains, double tool_damping,
            double h) noexcept;

  /// Pseudo-admittance: F_hand_W is the hand's wrench on the handle about its origin, as the device reports it.
  void step(const Wrench& F_hand_W, const ContactLoad& contact, const CouplingGains& gains, double tool_damping,
            double h) noexcept;

  const BodyState& tool() const noexcept { return tool_; }
  const BodyState& handle() const noexcept { return handle_; }
  /// Coupling wrench on the tool about To in the last step; the handle gets the opposite about its own origin.
  const Wrench& F_coupling_W() const noexcept { return F_coupling_W_; }
  bool saturated() const noexcept { return saturated_; }
  /// Static: what the last step left of F_contact + F_VC by its own model of the contact, N.
  double static_residual_n() const noexcept { return static_residual_n_; }

  /// What a limit outside (motion limit, gate) made of the state.
  void set_tool(const BodyState& tool) noexcept { tool_ = tool; }
  void set_handle(const BodyState& handle) noexcept { handle_ = handle; }

  const Mat3& inertia_T() const noexcept { return inertia_T_; }
  double mass() const noexcept { return params_.mass_kg; }

 private:
  struct Step;  // the linear algebra of one step
  void advance(Step& step, const ContactLoad& contact, const CouplingGains& gains, double tool_damping,
               double h) noexcept;
  Vec6 explicit_coupling(Step& step, const CouplingGains& gains) noexcept;
  Vec6 implicit_coupling(Step& step, const CouplingGains& gains) noexcept;
  Vec6 static_coupling(Step& step, const CouplingGains& gains) noexcept;
  void step_joined(const Wrench& F_hand_W, const ContactLoad& contact, double h) noexcept;
  void join(double h) noexcept;
  Mat6 mass_matrix(const Quat& q) const noexcept;
  void move(BodyState& body, const Vec6& V, double h) const noexcept;

  Params params_;
  CouplingKind kind_ = CouplingKind::dynamic;
  Integrator integrator_ = Integrator::implicit;
  Mat3 inertia_T_, inverse_inertia_T_;
  double gyration_radius_m_;
  BodyState tool_, handle_;
  Vec6 apart_ = Vec6::Zero();  // direct: from the handle to the tool, decaying
  RotationError rotation_error_;
  Wrench F_coupling_W_;
  bool saturated_ = false;
  double static_residual_n_ = 0;
};

}  // namespace tact::coupling
