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

LoopParameters loop_parameters(const CouplingSpec& spec) {
  LoopParameters parameters;
  parameters.kind = spec.kind == "direct"   ? CouplingKind::direct
                    : spec.kind == "static" ? CouplingKind::quasi_static
                                            : CouplingKind::dynamic;
  parameters.integrator = spec.integrator == "semi-implicit" ? Integrator::semi_implicit : Integrator::implicit;
  parameters.passivity_controller = spec.passivity_controller;
  parameters.saturation = spec.saturation;
  parameters.stiffness_n_per_m = spec.stiffness_n_per_m;
  parameters.damping_ratio = spec.damping_ratio;
  parameters.stiffness_nm_per_rad = spec.stiffness_nm_per_rad;
  parameters.torque_max_nm = spec.torque_max_nm;
  return parameters;
}

LoopConfig loop_config(const Session& session, const BodyModel& bodies) {
  const CouplingSpec& coupling = session.scene.coupling;
  LoopConfig config;
  config.rate_hz = session.machine.rate_hz;
  config.tool.mass_kg = coupling.mass_kg;
  config.tool.inertia_shape_m2 = bodies.inertia_shape_m2;
  config.tool.rotation_locked = coupling.rotation_locked;
  config.parameters = loop_parameters(coupling);
  const MachineSpec& machine = session.machine;
  config.mapping = {.X_WB = {machine.p_WB.value_or(Vec3::Zero()), machine.q_WB},
                    .scale = machine.workspace_scale,
                    .placed = machine.p_WB.has_value()};
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
  // A simulated hand does with the device what brings the tool where its script says.
  const WorkspaceMapping mapping(config.mapping, config.X_WT_start);
  options.X_WH_start = mapping.to_device(config.X_WT_start);
  for (Pose& X : options.hand_motion.X_WM) X = mapping.to_device(X * config.X_TM.inverse());
  options.virtual_inertia_shape_m2 = config.tool.inertia_shape_m2;
}

}  // namespace tact::coupling
