#include "lockstep/experiment.hpp"

#include <sstream>

#include "coupling/link/messages.hpp"
#include "fault/fault.hpp"
#include "lockstep/felt_mass.hpp"

namespace tact::lockstep {

report::SessionReport run_experiment(Lockstep& rig, const Session& session,
                                     const std::function<void(const TickTrace&)>& each) {
  const SceneSpec& scene = session.scene;
  report::GoalWatch goal(scene.goal_X_WM, scene.goal_distance_mm, scene.goal_angle_deg);
  report::FaultLog faults;
  const bool played = rig.run_script(1, [&](const TickTrace& trace) {
    goal.see(rig.status().X_WM);
    faults.see(trace.time_s, "coupling", trace.faults);
    if (each) each(trace);
  });
  if (rig.status().script_time_s < 0) {
    throw SetupError("run.script: found none, expected a script of scene " + scene.name + " or a hand motion");
  }
  report::SessionReport report;
  report.session = scene.name;
  report.scene = scene.name;
  report.script = session.run.script;
  report.law = scene.contact.law;
  report.device = session.machine.device;
  report.mode = session.machine.mode;
  report.coupling = scene.coupling.kind;
  report.transport = "none";
  report.stiffness_n_per_m = rig.answer().stiffness_n_per_m;
  report.voxel_m = rig.voxel_m();
  report.rate_hz = session.machine.rate_hz;
  report.saturation = scene.coupling.saturation;
  const coupling::LoopStats stats = rig.stats();
  report.duration_s = stats.duration_s;
  coupling::to_wire(stats, 1, rig.status().X_WM, report.stats);
  report.goal_reached = goal.reached();
  report.goal_distance_mm = goal.distance_mm();
  report.goal_angle_deg = goal.angle_deg();
  report.faults = faults.events();
  if (!played) report.notes.push_back("the script was not played to its end: haptics did not become live");
  report.notes.push_back("felt in free motion: " + felt_mass(rig.setup()).text());
  return report;
}

std::string trace_columns() {
  return "time_s,x_m,y_m,z_m,qw,qx,qy,qz,contact_fx_n,contact_fy_n,contact_fz_n,contact_tx_nm,contact_ty_nm,"
         "contact_tz_nm,coupling_fx_n,coupling_fy_n,coupling_fz_n,coupling_tx_nm,coupling_ty_nm,coupling_tz_nm,"
         "contacts,max_depth_m,net_stiffness_n_per_m,port_energy_j,faults";
}

std::string trace_row(const TickTrace& t) {
  std::ostringstream out;
  out.precision(9);
  const auto put = [&out](const auto& v) {
    for (Eigen::Index i = 0; i < v.size(); ++i) out << ',' << v[i];
  };
  out << t.time_s;
  put(t.X_WT.p);
  out << ',' << t.X_WT.q.w() << ',' << t.X_WT.q.x() << ',' << t.X_WT.q.y() << ',' << t.X_WT.q.z();
  put(t.F_contact_W.vector());
  put(t.F_coupling_W.vector());
  out << ',' << t.contact_count << ',' << t.max_depth_m << ',' << t.net_stiffness_n_per_m << ',' << t.port_energy_j
      << ',' << t.faults;
  return out.str();
}

}  // namespace tact::lockstep
