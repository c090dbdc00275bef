#pragma once
#include <cstdint>

#include "math/pose.hpp"

namespace tact::coupling {

/// Passivity observer at the device port, always on, and controller, on request: B. Hannaford, J.-H. Ryu, "Time-domain
/// passivity control of haptic interfaces", IEEE Trans. Robotics and Automation 18(1), 2002, in six dimensions.
///
/// energy_j() is what left through the port since the start; above zero we gave more than we took. What comes in is
/// credit, and is not forgotten: the controller begins to act when all of it is used up.
///   impedance           dE = F . dx, F the wrench sent, held while the handle moved by dx. While E > 0 the wrench is
///                       braked, F - a (v, rho^2 w), so that at this twist E comes down to zero within the tick.
///   pseudo-admittance   dE = -F_hand . dx, dx the step of the set-point. A step that would bring E above zero yields
///                       to the hand instead, along (f, tau / rho^2), until E is zero.
/// rho weighs rotations against translations. Both are bounded, so that no more is dissipated in a tick than is stable;
/// then E comes down within several. All in the device's own frame; the gate comes after. No clock, no allocation.
class PassivityController {
 public:
  struct Params {
    double rho_m = 0.03;
    double brake_max_n_s_per_m = 100;
    double yield_max_m_per_n = 1e-4;  ///< in a tick
  };
  struct Activity {
    std::uint64_t ticks = 0;
    double dissipated_j = 0;
  };

  explicit PassivityController(const Params& params) : params_(params) {}

  void enable(bool on) noexcept { on_ = on; }

  /// Observer: what left through the port in a tick, J.
  void observe(double joule) noexcept { energy_j_ += joule; }
  double energy_j() const noexcept { return energy_j_; }

  /// Impedance: the wrench to send in place of F, at the handle's twist V; h: period, s.
  Wrench braked(const Wrench& F, const Twist& V, double h) noexcept;
  /// Pseudo-admittance: what to add to the set-point's step dx under the hand's wrench.
  Vec6 yielding(const Wrench& F_hand, const Vec6& dx) noexcept;

  const Activity& activity() const noexcept { return activity_; }

 private:
  Params params_;
  bool on_ = false;
  double energy_j_ = 0;
  Activity activity_;
};

}  // namespace tact::coupling
