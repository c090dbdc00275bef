#pragma once
#include <cstdint>

#include "coupling/dynamics/tool_integrator.hpp"

namespace tact::coupling {

/// What may be changed while the loop runs; keys as in the scene file ("coupling.saturation"). The whole set travels,
/// and is applied at the beginning of a tick, slewed so that no wrench jumps.
struct LoopParameters {
  std::uint64_t version = 0;  ///< echoed in LoopStatus once in force
  CouplingKind kind = CouplingKind::dynamic;
  Integrator integrator = Integrator::implicit;  ///< where something is integrated
  bool saturation = true;                        ///< of the virtual coupling: direct has none
  bool passivity_controller = false;
  double stiffness_n_per_m = 2000;  ///< k_VC
  double damping_ratio = 1.0;       ///< of the coupling, fraction of critical at the tool's mass
  double stiffness_nm_per_rad = 0;  ///< k_r; 0: k_VC gyration_radius^2
  double torque_max_nm = 0;         ///< saturation; 0: F_max gyration_radius
};

}  // namespace tact::coupling
