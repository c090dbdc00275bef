#pragma once
#include "coupling/dynamics/virtual_coupling.hpp"
#include "coupling/dynamics/wrench_model.hpp"
#include "coupling/loop/loop_parameters.hpp"

namespace tact::coupling {

/// The gains in force this tick: the parameters asked for, reached without a jump; the saturation k x_max of the
/// latest reply, slewed, also to and from none at all; and the strength, which follows the wrench model down through
/// its fade at once and comes back over kReturn_s. While it fades the coupling force may not grow: what the hand feels
/// only falls. Real time: no allocation.
class CouplingStrength {
 public:
  static constexpr double kReturn_s = 0.5;                ///< from calm to full strength
  static constexpr double kRelax_s = 0.05;                ///< time constant of stiffness changes
  static constexpr double kRise_s = 0.2, kFall_s = 0.02;  ///< of the saturation over its full range: quick only down

  CouplingStrength(const LoopParameters& parameters, double mass, const Mat3& inertia_T, double gyration_radius_m,
                   double force_max);

  void set(const LoopParameters& parameters) noexcept { wanted_ = parameters; }
  /// F_max = k x_max of a reply ([P] eq. 15); ignored unless positive.
  void set_force_max(double force_max) noexcept;

  /// One tick of h seconds. `may_act`: the device is engaged. `F_coupling_W`: of the last step.
  void advance(const WrenchModel& wrench, bool may_act, const Wrench& F_coupling_W, double h) noexcept;

  const CouplingGains& gains() const noexcept { return gains_; }
  double strength() const noexcept { return gains_.strength; }
  /// k x_max and its torque now in force, also with the saturation off.
  double force_max() const noexcept { return force_max_; }
  double torque_max() const noexcept;
  /// Brakes the tool while the coupling is weak, N s/m.
  double tool_damping() const noexcept;
  std::uint64_t parameters_version() const noexcept { return wanted_.version; }

 private:
  LoopParameters wanted_;
  double mass_;
  Mat3 inertia_T_;
  double gyration_radius_m_;
  double force_max_wanted_, force_max_;
  double k_, k_r_, damping_ratio_;
  CouplingGains gains_;
};

}  // namespace tact::coupling
