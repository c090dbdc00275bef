#pragma once
#include "contact/stiffness/direction_density.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::contact {

/// Law "adaptive-3dof": phi_i = sum_j hat(N_i, N_j), [P] eq. 6-7; w_i = 1 / phi_i in (0, 1].
///
/// Differs from [P] eq. 8 (w = phi / phi_max), which contradicts the text around it: repeated normals are to be
/// de-emphasised, so w falls with phi; a lonely contact has phi = 1 and keeps w = 1.
class Adaptive3Dof final : public Law {
 public:
  Adaptive3Dof(const Pointshell& shell, double epsilon);
  void weigh(ContactBuffer& contacts) noexcept override;

 private:
  DirectionDensity normals_;
};

/// Law "adaptive-6dof": phi_i = sum_j [hat(N_i, N_j) + hat(T_i, T_j)], [P] eq. 10-12; w_i = 2 / phi_i in (0, 1].
///
/// T = r x N / max(|r x N|, lever_floor_m). [P] eq. 10 is undefined where r x N = 0; here T fades continuously from the
/// sphere to its centre, so contacts without torque count as alike, and neighbours with tiny levers do not get
/// unrelated directions. With lever_unit_m > 0, [P] eq. 13: T = r x N / lever_unit_m, so that contacts of equal torque
/// direction and different lever are told apart; the floor is not needed then.
class Adaptive6Dof final : public Law {
 public:
  Adaptive6Dof(const Pointshell& shell, double epsilon, double lever_floor_m, double lever_unit_m = 0);
  void weigh(ContactBuffer& contacts) noexcept override;

 private:
  DirectionDensity normals_;
  DirectionDensity torques_;
};

}  // namespace tact::contact
