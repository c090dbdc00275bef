#include "coupling/link/messages.hpp"

#include <cmath>

#include "link/convert.hpp"

namespace tact::coupling {

void to_wire(const ToolSample& in, std::uint64_t session_id, std::uint64_t epoch, wire::ToolPose& out) noexcept {
  out = {};
  out.session_id = session_id;
  out.epoch = epoch;
  out.seq = in.seq;
  out.t_mono_ns = in.t_mono_ns;
  out.step_ns = in.step_ns;
  out.flags = in.flags;
  tact::to_wire(in.X_WT, out.X_WT);
  tact::to_wire(in.V_WT, out.V_WT);
  tact::to_wire(in.X_WO, out.X_WO);
  tact::to_wire(in.V_WO, out.V_WO);
}

void from_wire(const wire::ContactWrench& in, ContactReply& out) noexcept {
  out.server_epoch = in.server_epoch;
  out.pose_seq = in.pose_seq;
  out.pose_t_mono_ns = in.pose_t_mono_ns;
  out.compute_ns = in.compute_ns;
  out.X_WT = tact::from_wire(in.X_WT);
  out.X_WO = tact::from_wire(in.X_WO);
  out.F_W = wrench_from_wire(in.F);
  out.G = tact::from_wire(in.G);
  out.K = symmetric_from_wire(in.K);
  out.B = symmetric_from_wire(in.B);
  out.contact_count = in.contact_count;
  out.dropped = in.dropped;
  out.status = in.status;
  out.max_depth_m = in.max_depth_m;
  out.clearance_m = in.clearance_m;
  out.stiffness_n_per_m = in.stiffness_n_per_m;
  out.x_max_m = in.x_max_m;
  out.params_version = in.params_version;
}

bool finite(const wire::ContactWrench& reply) noexcept {
  double sum = reply.max_depth_m + reply.clearance_m + reply.stiffness_n_per_m + reply.x_max_m;
  for (const double v : reply.F) sum += 0 * v;
  for (const double v : reply.G) sum += 0 * v;
  for (const double v : reply.K) sum += 0 * v;
  for (const double v : reply.B) sum += 0 * v;
  return std::isfinite(sum) && tact::from_wire(reply.X_WT).finite() && tact::from_wire(reply.X_WO).finite();
}

void to_wire(const LoopStatus& in, std::uint64_t epoch, const char* device, const char* mode,
             wire::DeviceState& out) noexcept {
  out = {};
  out.schema = wire::kSchema;
  out.epoch = epoch;
  out.tick = in.tick;
  out.t_mono_ns = in.t_mono_ns;
  tact::to_wire(in.X_WH, out.X_WH);
  tact::to_wire(in.V_WH, out.V_WH);
  tact::to_wire(in.X_WT, out.X_WT);
  tact::to_wire(in.V_WT, out.V_WT);
  tact::to_wire(in.X_WM, out.X_WM);
  tact::to_wire(in.F_contact_W, out.F_contact_W);
  tact::to_wire(in.F_coupling_W, out.F_coupling_W);
  tact::to_wire(in.F_hand_W, out.F_hand_W);
  out.contact_count = in.contact_count;
  out.max_depth_m = in.max_depth_m;
  out.net_stiffness_n_per_m = in.net_stiffness_n_per_m;
  out.force_max_n = in.force_max_n;
  out.tick_us_max = static_cast<double>(in.tick_ns_max) * 1e-3;
  out.round_trip_us = static_cast<double>(in.round_trip_ns) * 1e-3;
  out.script_time_s = in.script_time_s;
  out.script_done = in.script_done;
  out.engaged = in.engaged;
  out.capped = in.capped;
  out.faults = in.faults;
  out.faults_ever = in.stats.faults_ever;
  wire::set_text(out.device, device);
  wire::set_text(out.mode, mode);
}

void to_wire(const LoopStats& in, std::uint64_t epoch, const Pose& X_WM, wire::SessionStats& out) noexcept {
  out = {};
  out.schema = wire::kSchema;
  out.epoch = epoch;
  out.duration_s = in.duration_s;
  out.rate_hz = in.rate_hz;
  out.ticks = in.ticks;
  out.missed_ticks = in.missed_ticks;
  out.wrench_fresh = in.wrench_fresh;
  out.wrench_late = in.wrench_late;
  out.wrench_stale = in.wrench_stale;
  tact::to_wire(in.loop_jitter, out.loop_jitter);
  tact::to_wire(in.tick, out.tick);
  tact::to_wire(in.round_trip, out.round_trip);
  tact::to_wire(in.contact_compute, out.contact_compute);
  out.contacts_mean = in.contacts_mean;
  out.contacts_max = in.contacts_max;
  out.penetration_quasi_static_max_m = in.penetration_quasi_static_max_m;
  out.penetration_max_m = in.penetration_max_m;
  out.force_max_n = in.force_max_n;
  out.torque_max_nm = in.torque_max_nm;
  out.pull_max_n = in.pull_max_n;
  out.force_step_rms_n = in.force_step_rms_n;
  out.force_step_max_n = in.force_step_max_n;
  out.net_stiffness_max_n_per_m = in.net_stiffness_max_n_per_m;
  out.port_energy_j = in.port_energy_j;
  out.passivity_ticks = in.passivity_ticks;
  out.passivity_dissipated_j = in.passivity_dissipated_j;
  out.static_residual_max_n = in.static_residual_max_n;
  out.static_unsolved_ticks = in.static_unsolved_ticks;
  out.faults_ever = in.faults_ever;
  out.page_faults = static_cast<std::uint32_t>(in.page_faults);
  tact::to_wire(X_WM, out.X_WM);
}

}  // namespace tact::coupling
