#pragma once
#include "coupling/dynamics/virtual_coupling.hpp"

namespace tact::coupling {

/// Contact wrench on the tool about To at its present pose and twist, linearised: F(x, V) = F - K x - B (V - V_0).
struct ContactLoad {
  Wrench F_W;
  Mat6 K = Mat6::Zero();  ///< symmetric positive semidefinite
  Mat6 B = Mat6::Zero();  ///< the same
};

struct BodyState {
  Pose X_W;
  Twist V_W;  ///< of the body's origin
};

enum class Integrator { semi_implicit, implicit };

/// Steps the tool (and in pseudo-admittance the handle body) under contact and virtual coupling. h: time step,
/// M: mass and inertia in W, V_H: twist of the handle, s: see virtual_coupling.hpp, D = ds/d(V_H - V_T).
///
/// Semi-implicit Euler: forces at the present state; V <- V + h M^-1 F; X <- exp(h V) X.
///
/// Implicit Euler, linearised in the contact and solved to convergence in the coupling's cap ([P] section 4, [P:2]):
///   tool    M (V_T' - V_T) = h (F - h K V_T' - B (V_T' - V_T) + F_VC)
///   handle  M (V_H' - V_H) = h (F_hand - F_VC)                     pseudo-admittance; otherwise V_H' = V_H is given
///   F_VC = strength cap(s + D (V_H' - V_T')),  D = h k + b and h k_r gradient + B_r
/// The coupling is taken where handle and tool will be at the end of the step. The 12x12 system of both bodies is
/// reduced to 6x6 by its exact Schur complement. The cap is met by a semi-smooth Newton iteration (at most four
/// solves); the coupling wrench it ends with is then applied as it is, so the cap and action = reaction are exact.
///
/// Rotation: angular momentum is carried over the step (w <- I(R')^-1 I(R) w), exactly conserved without torque.
/// Real time: bounded work (at most six 6x6 solves, a few microseconds), no allocation, no exceptions.
class ToolIntegrator {
 public:
  struct Params {
    double mass_kg = 0.2;                             ///< of the tool; the handle body's is equal
    Mat3 inertia_shape_m2 = Mat3::Identity() * 1e-3;  ///< inertia of unit mass about To in T
    bool rotation_locked = false;                     ///< translation only, both bodies
    Integrator integrator = Integrator::implicit;
  };

  explicit ToolIntegrator(const Params& params);

  /// Both bodies at rest at X_WT.
  void reset(const Pose& X_WT) noexcept;

  /// Impedance: the handle's state is the device's. `tool_damping` (N s/m) brakes the tool against the world: for
  /// coming to rest while the coupling is faded out.
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

  /// What a limit outside (motion limit, gate) made of the state.
  void set_tool(const BodyState& tool) noexcept { tool_ = tool; }
  void set_handle(const BodyState& handle) noexcept { handle_ = handle; }

  const Mat3& inertia_T() const noexcept { return inertia_T_; }
  double mass() const noexcept { return params_.mass_kg; }

 private:
  struct Step;  // the linear algebra of one step
  void advance(Step& step, const ContactLoad& contact, const CouplingGains& gains, double tool_damping,
               double h) noexcept;
  Mat6 mass_matrix(const Quat& q) const noexcept;
  void move(BodyState& body, const Vec6& V, double h) const noexcept;

  Params params_;
  Mat3 inertia_T_, inverse_inertia_T_;
  BodyState tool_, handle_;
  RotationError rotation_error_;
  Wrench F_coupling_W_;
  bool saturated_ = false;
};

}  // namespace tact::coupling
