#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "report/session_report.hpp"

namespace tact::report {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Percentiles& p) { return {{"p50", p.p50}, {"p99", p.p99}, {"p999", p.p999}, {"max", p.max}}; }

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

double voxels(const SessionReport& r, double metres) { return r.voxel_m > 0 ? metres / r.voxel_m : 0; }

template <class... Args>
std::string text(const char* format, Args... args) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, args...);
  return buffer;
}

std::string row(const char* label, const std::string& value) { return text("  %-26s", label) + value + "\n"; }

std::string row(const char* label, const Percentiles& p) {
  return row(label, text("%9.1f %9.1f %9.1f %9.1f", p.p50, p.p99, p.p999, p.max));
}

/// Each kind of fault once, when it first came and how often.
std::string fault_rows(const std::vector<FaultEvent>& faults) {
  constexpr std::size_t kShown = 16;
  struct Kind {
    const FaultEvent* first;
    int times;
  };
  std::vector<Kind> kinds;
  for (const FaultEvent& f : faults) {
    const auto known = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) {
      return k.first->name == f.name && k.first->detail == f.detail;
    });
    if (known != kinds.end()) {
      ++known->times;
    } else {
      kinds.push_back({&f, 1});
    }
  }
  if (kinds.empty()) return row("faults", "none");
  std::string out;
  for (std::size_t i = 0; i < kinds.size() && i < kShown; ++i) {
    const FaultEvent& f = *kinds[i].first;
    out +=
        row(i == 0 ? "faults" : "", text("%7.2f s  ", f.time_s) + f.name + (f.detail.empty() ? "" : ": " + f.detail) +
                                        (kinds[i].times > 1 ? text(" (%d times)", kinds[i].times) : std::string()));
  }
  if (kinds.size() > kShown) out += row("", text("and %zu kinds more (see --report)", kinds.size() - kShown));
  return out;
}

}  // namespace

std::string to_json(const SessionReport& r) {
  const Stats& s = r.stats;
  Json j;
  j["session"] = r.session;
  j["scene"] = r.scene;
  j["script"] = r.script;
  j["law"] = r.law;
  j["stiffness_n_per_m"] = r.stiffness_n_per_m;
  j["saturation"] = r.saturation;
  j["device"] = r.device;
  j["mode"] = r.mode;
  j["coupling"] = r.coupling;
  j["voxel_mm"] = r.voxel_m * 1e3;
  j["duration_s"] = r.duration_s;
  j["rate_hz"] = r.rate_hz;
  j["transport"] = r.transport;
  j["shared_memory_proven"] = r.shared_memory_proven;
  j["ticks"] = s.ticks;
  j["missed_ticks"] = s.missed_ticks;
  j["page_faults"] = s.page_faults;
  j["wrench"] = {{"fresh", s.wrench_fresh}, {"late", s.wrench_late}, {"stale", s.wrench_stale}};
  j["loop_jitter_us"] = json_of(percentiles(s.loop_jitter));
  j["tick_us"] = json_of(percentiles(s.tick));
  j["round_trip_us"] = json_of(percentiles(s.round_trip));
  j["contact_compute_us"] = json_of(percentiles(s.contact_compute));
  j["contacts"] = {{"mean", s.contacts_mean}, {"max", s.contacts_max}};
  j["penetration_mm"] = {{"quasi_static_max", s.penetration_quasi_static_max_m * 1e3},
                         {"max", s.penetration_max_m * 1e3}};
  j["penetration_voxels"] = {{"quasi_static_max", voxels(r, s.penetration_quasi_static_max_m)},
                             {"max", voxels(r, s.penetration_max_m)}};
  j["force_n"] = {{"max", s.force_max_n}};
  j["torque_nm"] = {{"max", s.torque_max_nm}};
  j["pull_n"] = {{"max", s.pull_max_n}};
  j["force_step_n"] = {{"rms", s.force_step_rms_n}, {"max", s.force_step_max_n}};
  j["net_stiffness_n_per_m"] = {{"max", s.net_stiffness_max_n_per_m}};
  j["port_energy_j"] = s.port_energy_j;
  j["passivity_controller"] = {{"ticks", s.passivity_ticks}, {"dissipated_j", s.passivity_dissipated_j}};
  j["static_coupling"] = {{"residual_max_n", s.static_residual_max_n}, {"unsolved_ticks", s.static_unsolved_ticks}};
  j["goal"] = {{"reached", r.goal_reached},
               {"distance_mm", json_of(r.goal_distance_mm)},
               {"angle_deg", json_of(r.goal_angle_deg)}};
  j["faults"] = Json::array();
  for (const auto& f : r.faults) j["faults"].push_back({{"time_s", f.time_s}, {"name", f.name}, {"detail", f.detail}});
  j["notes"] = r.notes;
  j["loaded"] = Json::array();
  for (const auto& l : r.loaded) j["loaded"].push_back({{"what", l.what}, {"seconds", l.seconds}, {"bytes", l.bytes}});
  j["services"] = Json::array();
  for (const auto& u : r.services) {
    j["services"].push_back(
        {{"name", u.name}, {"cpu_percent", u.cpu_percent}, {"memory_mb", u.memory_mb}, {"restarts", u.restarts}});
  }
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_table(const SessionReport& r) {
  const Stats& s = r.stats;
  const auto count = [](std::uint64_t n) { return text("%llu", static_cast<unsigned long long>(n)); };
  std::string out = "Session " + r.session + ": scene " + r.scene;
  if (!r.script.empty()) out += ", script " + r.script;
  out += text(", law %s at %.0f N/m, saturation %s\n", r.law.c_str(), r.stiffness_n_per_m, r.saturation ? "on" : "off");
  out += row("device", r.device + ", " + r.mode + ", " + r.coupling + " coupling" + text(", %.0f Hz", r.rate_hz));
  out += row("transport", r.transport == "shm"
                              ? std::string("shared memory, ") + (r.shared_memory_proven ? "" : "not ") + "proven"
                          : r.transport == "udp" ? "UDP on loopback"
                                                 : "none: one thread, a clock that counts ticks");
  out += row("duration, ticks",
             text("%.1f s, ", r.duration_s) + count(s.ticks) + " (" + count(s.missed_ticks) + " missed)");
  out += row("wrench",
             count(s.wrench_fresh) + " fresh, " + count(s.wrench_late) + " late, " + count(s.wrench_stale) + " stale");
  out += row("microseconds", text("%9s %9s %9s %9s", "p50", "p99", "p99.9", "max"));
  out += row("  loop jitter", percentiles(s.loop_jitter));
  out += row("  tick", percentiles(s.tick));
  out += row("  round trip", percentiles(s.round_trip));
  out += row("  contact compute", percentiles(s.contact_compute));
  out += row("contacts", text("mean %.1f, max %u", s.contacts_mean, s.contacts_max));
  out += row("penetration, quasi-static", text("max %.3f mm = %.2f voxels", s.penetration_quasi_static_max_m * 1e3,
                                               voxels(r, s.penetration_quasi_static_max_m)));
  out += row("penetration, with impacts",
             text("max %.3f mm = %.2f voxels", s.penetration_max_m * 1e3, voxels(r, s.penetration_max_m)));
  out += row("contact force, torque", text("max %.2f N, %.3f Nm", s.force_max_n, s.torque_max_nm));
  out += row("pull while in contact", text("max %.2f N", s.pull_max_n));
  out += row("force step per tick", text("rms %.4f N, max %.3f N", s.force_step_rms_n, s.force_step_max_n));
  out += row("net stiffness", text("max %.0f N/m", s.net_stiffness_max_n_per_m));
  out += row("energy out of the port", text("%.4f J", s.port_energy_j));
  if (s.passivity_ticks > 0) {
    out += row("passivity controller",
               count(s.passivity_ticks) + text(" ticks, %.4f J dissipated", s.passivity_dissipated_j));
  }
  if (s.static_residual_max_n > 0) {
    out += row("static equilibrium", text("residual max %.1e N, ", s.static_residual_max_n) +
                                         count(s.static_unsolved_ticks) + " ticks unsolved");
  }
  if (r.goal_distance_mm && r.goal_angle_deg) {
    out += row("goal", std::string(r.goal_reached ? "reached" : "not reached") +
                           text(", nearest %.2f mm, %.2f deg", *r.goal_distance_mm, *r.goal_angle_deg));
  }
  for (const auto& u : r.services) {
    out += row(u.name.c_str(), text("%.0f %% of a core, %.0f MB resident", u.cpu_percent, u.memory_mb) +
                                   (u.restarts ? text(", restarted %d times", u.restarts) : std::string()));
  }
  out += fault_rows(r.faults);
  return out;
}

}  // namespace tact::report
