#include "coupling/safety/passivity_controller.hpp"

#include <algorithm>

namespace tact::coupling {

Wrench PassivityController::braked(const Wrench& F, const Twist& V, double h) noexcept {
  const double rho2 = params_.rho_m * params_.rho_m;
  const double speed2 = V.linear.squaredNorm() + rho2 * V.angular.squaredNorm();
  if (!on_ || !(energy_j_ > 0) || !(speed2 > 0)) return F;
  const double brake = std::min(energy_j_ / (speed2 * h), params_.brake_max_n_s_per_m);
  ++activity_.ticks;
  activity_.dissipated_j += brake * speed2 * h;
  return {F.force - brake * V.linear, F.torque - brake * rho2 * V.angular};
}

Vec6 PassivityController::yielding(const Wrench& F_hand, const Vec6& dx) noexcept {
  const double rho2 = params_.rho_m * params_.rho_m;
  const double force2 = F_hand.force.squaredNorm() + F_hand.torque.squaredNorm() / rho2;
  const double excess = energy_j_ - F_hand.vector().dot(dx);
  if (!on_ || !(excess > 0) || !(force2 > 0)) return Vec6::Zero();
  const double give = std::min(excess / force2, params_.yield_max_m_per_n);
  ++activity_.ticks;
  activity_.dissipated_j += give * force2;
  Vec6 step;
  step << give * F_hand.force, give / rho2 * F_hand.torque;
  return step;
}

}  // namespace tact::coupling
