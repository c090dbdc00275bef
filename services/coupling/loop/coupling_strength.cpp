#include "coupling/loop/coupling_strength.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tact::coupling {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

double angular_stiffness(const LoopParameters& p, double gyration_radius_m) {
  return p.stiffness_nm_per_rad > 0 ? p.stiffness_nm_per_rad
                                    : p.stiffness_n_per_m * gyration_radius_m * gyration_radius_m;
}

/// Towards `wanted`. From no limit at all it comes in where it first bites; to no limit it rises, e-fold in kRise_s,
/// until it no longer bites: after a fade, or when the saturation is switched off, the coupling may pull hard.
double slewed_cap(double cap_now, double wanted, double acting, double rise, double fall, double h) {
  if (wanted == kUnlimited) {
    const bool bites = acting >= 0.9 * cap_now;
    return bites ? cap_now + std::max(rise, cap_now * h / CouplingStrength::kRise_s) : kUnlimited;
  }
  if (cap_now == kUnlimited) return std::max(wanted, acting);
  return std::clamp(wanted, cap_now - fall, cap_now + rise);
}

}  // namespace

CouplingStrength::CouplingStrength(const LoopParameters& parameters, double mass, const Mat3& inertia_T,
                                   double gyration_radius_m, double force_max)
    : wanted_(parameters),
      mass_(mass),
      inertia_T_(inertia_T),
      gyration_radius_m_(gyration_radius_m),
      force_max_wanted_(force_max),
      force_max_(force_max),
      k_(parameters.stiffness_n_per_m),
      k_r_(angular_stiffness(parameters, gyration_radius_m)),
      damping_ratio_(parameters.damping_ratio) {
  gains_ = coupling_gains(k_, k_r_, damping_ratio_, mass_, inertia_T_);
  gains_.strength = 0;
  if (parameters.saturation) {
    gains_.force_max = force_max_;
    gains_.torque_max = torque_max();
  }
}

void CouplingStrength::set_force_max(double force_max) noexcept {
  if (std::isfinite(force_max) && force_max > 0) force_max_wanted_ = force_max;
}

double CouplingStrength::torque_max() const noexcept {
  return wanted_.torque_max_nm > 0 ? wanted_.torque_max_nm : force_max_ * gyration_radius_m_;
}

double CouplingStrength::tool_damping() const noexcept { return (1 - gains_.strength) * 2 * std::sqrt(k_ * mass_); }

void CouplingStrength::advance(const WrenchModel& wrench, bool may_act, const Wrench& F_coupling_W, double h) noexcept {
  const double relax = std::min(1.0, h / kRelax_s);
  const double k_r_wanted = angular_stiffness(wanted_, gyration_radius_m_);
  k_ += relax * (wanted_.stiffness_n_per_m - k_);
  k_r_ += relax * (k_r_wanted - k_r_);
  damping_ratio_ += relax * (wanted_.damping_ratio - damping_ratio_);
  const double range = std::max(force_max_, force_max_wanted_);
  const double rise = range * h / kRise_s, fall = range * h / kFall_s;
  force_max_ = std::clamp(force_max_wanted_, force_max_ - fall, force_max_ + rise);

  // The last wrench, at full strength: what the cap would have to be to bite now.
  const double part = gains_.strength > 0 ? 1 / gains_.strength : 0;
  const double force = part * F_coupling_W.force.norm(), torque = part * F_coupling_W.torque.norm();
  double cap_force = slewed_cap(gains_.force_max, wanted_.saturation ? force_max_ : kUnlimited, force, rise, fall, h);
  double cap_torque = slewed_cap(gains_.torque_max, wanted_.saturation ? torque_max() : kUnlimited, torque,
                                 rise * gyration_radius_m_, fall * gyration_radius_m_, h);
  if (wrench.phase() == WrenchModel::Phase::fading) {
    cap_force = std::min(cap_force, force);
    cap_torque = std::min(cap_torque, torque);
  }

  const double strength = std::min(may_act ? wrench.strength() : 0, gains_.strength + h / kReturn_s);
  gains_ = coupling_gains(k_, k_r_, damping_ratio_, mass_, inertia_T_);
  gains_.strength = strength;
  gains_.force_max = cap_force;
  gains_.torque_max = cap_torque;
}

}  // namespace tact::coupling
