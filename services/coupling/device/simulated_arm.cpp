#include "coupling/device/simulated_arm.hpp"

#include <algorithm>

namespace tact::coupling {
namespace {

constexpr double kCoulombLever_m = 0.05, kCool = 0.8, kHotForce = 0.8, kLimitMoves_s = 0.5;

Vec3 at_most(const Vec3& v, double m) {
  const double norm = v.norm();
  return norm > m ? Vec3(v * (m / norm)) : v;
}

/// Dry friction takes up to `dv` of the speed and never more than there is.
Vec3 braked(const Vec3& v, double dv) {
  const double speed = v.norm();
  return speed <= dv ? Vec3(Vec3::Zero()) : Vec3(v * (1 - dv / speed));
}

}  // namespace

double SimulatedArm::limit() const noexcept {
  const double continuous = params_.force_continuous_n > 0 ? params_.force_continuous_n : params_.force_peak_n;
  return 1 + hot_part_ * (std::min(1.0, kHotForce * continuous / params_.force_peak_n) - 1);
}

Wrench SimulatedArm::motor(const Wrench& wanted_W) const noexcept {
  return {at_most(wanted_W.force, limit() * params_.force_peak_n),
          at_most(wanted_W.torque, limit() * params_.torque_peak_nm)};
}

void SimulatedArm::advance(const Wrench& F_hand_W, const Wrench& F_motor_W, double hand_mass_kg,
                           double hand_inertia_kg_m2, double dt) noexcept {
  const double mass = params_.mass_kg + hand_mass_kg, inertia = params_.inertia_kg_m2 + hand_inertia_kg_m2;
  V_WH_.linear += dt / mass * (F_hand_W.force + F_motor_W.force - params_.friction_n_s_per_m * V_WH_.linear);
  V_WH_.angular += dt / inertia * (F_hand_W.torque + F_motor_W.torque - params_.friction_nm_s_per_rad * V_WH_.angular);
  if (params_.coulomb_n > 0) {
    V_WH_.linear = braked(V_WH_.linear, params_.coulomb_n * dt / mass);
    V_WH_.angular = braked(V_WH_.angular, params_.coulomb_n * kCoulombLever_m * dt / inertia);
  }
  X_WH_ = displaced(X_WH_, dt * V_WH_.vector());
  if (const Vec3 out = X_WH_.p - X_W_start_.p; params_.workspace_m > 0 && out.norm() > params_.workspace_m) {
    const Vec3 direction = out.normalized();
    X_WH_.p = X_W_start_.p + params_.workspace_m * direction;
    V_WH_.linear -= std::max(0.0, V_WH_.linear.dot(direction)) * direction;
  }

  if (params_.force_continuous_n > 0) {
    const double part = params_.force_continuous_n / params_.force_peak_n;
    const double load = std::max(F_motor_W.force.norm() / params_.force_continuous_n,
                                 F_motor_W.torque.norm() / (part * params_.torque_peak_nm));
    heat_ += std::min(1.0, dt / params_.thermal_s) * (load * load - heat_);
  } else {
    heat_ -= std::min(1.0, dt / kLimitMoves_s) * heat_;
  }
  hot_ = heat_ >= 1 || (hot_ && heat_ >= kCool);
  hot_part_ = std::clamp(hot_part_ + (hot_ ? dt : -dt) / kLimitMoves_s, 0.0, 1.0);
}

}  // namespace tact::coupling
