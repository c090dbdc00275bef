#include "coupling/loop/session_config.hpp"

namespace tact::coupling {

DeviceOptions device_options(const Session& session) {
  DeviceOptions options;
  options.name = session.machine.device;
  options.mode = session.machine.mode;
  options.rate_hz = session.machine.rate_hz;
  options.virtual_mass_kg = session.scene.coupling.mass_kg;
  options.virtuose = session.machine.virtuose;
  options.force_limit_n = session.machine.force_limit_n;
  options.torque_limit_nm = session.machine.torque_limit_nm;
  options.simulated = session.machine.simulated;
  if (const auto hand = scripted_hand(session)) {
    options.hand.force_max_n = hand->hand_force_max_n;
    options.hand_motion = load_hand_motion(hand->hand_csv);
  }
  return options;
}

LoopConfig loop_config(const Session& session, const BodyModel& bodies) {
  const CouplingSpec& coupling = session.scene.coupling;
  LoopConfig config;
  config.rate_hz = session.machine.rate_hz;
  config.tool.mass_kg = coupling.mass_kg;
  config.tool.inertia_shape_m2 = bodies.inertia_shape_m2;
  config.tool.rotation_locked = coupling.rotation_locked;
  config.parameters = {.version = 0,
                       .saturation = coupling.saturation,
                       .stiffness_n_per_m = coupling.stiffness_n_per_m,
                       .damping_ratio = coupling.damping_ratio,
                       .stiffness_nm_per_rad = coupling.stiffness_nm_per_rad,
                       .torque_max_nm = coupling.torque_max_nm};
  config.gate.force_n = session.machine.force_limit_n;
  config.gate.torque_nm = session.machine.torque_limit_nm;
  config.gate.force_slope_n_per_s = session.machine.force_slope_n_per_s;
  config.gate.torque_slope_nm_per_s = session.machine.torque_slope_nm_per_s;
  config.X_WT_start = session.scene.start_X_WM * bodies.X_TM.inverse();
  config.X_WO = bodies.X_WO;
  config.X_TM = bodies.X_TM;
  config.gyration_radius_m = bodies.gyration_radius_m;
  config.tool_radius_m = bodies.tool_radius_m;
  config.voxel_m = bodies.voxel_m;
  config.force_max_n = bodies.stiffness_n_per_m * bodies.x_max_m;
  return config;
}

void take_bodies(const LoopConfig& config, DeviceOptions& options) {
  options.X_WH_start = config.X_WT_start;
  options.X_TM = config.X_TM;
  options.virtual_inertia_shape_m2 = config.tool.inertia_shape_m2;
}

}  // namespace tact::coupling
