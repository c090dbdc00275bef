// Speed against error of the time step: integrators and rates.
#include <algorithm>
#include <cmath>

#include "bench/measure.hpp"
#include "evidence/experiments.hpp"
#include "evidence/play.hpp"
#include "math/exp_log.hpp"

namespace tact::evidence {
namespace {

using bench::number;
using bench::Report;

/// Where a point one tool radius away may be off, at most, between two poses.
double apart_m(const Pose& a, const Pose& b, double radius_m) {
  return (a.p - b.p).norm() + radius_m * log_so3(a.q * b.q.conjugate()).norm();
}

struct Error {
  double path_rms_m = 0, rest_m = 0, force_n = 0;
};

/// The tick in which the script ended.
std::ptrdiff_t end_of_script(const Played& run) {
  const auto done = std::find_if(run.ticks.begin(), run.ticks.end(), [](const auto& tick) { return tick.script_done; });
  return done - run.ticks.begin();
}

/// Against the same run in finer steps, at equal times of the script: becoming live takes ticks, not seconds.
Error against(const Played& run, double rate_hz, const Played& fine, double fine_hz, double radius_m) {
  Error error;
  const std::ptrdiff_t done = end_of_script(run), fine_done = end_of_script(fine);
  double sum = 0, count = 0;
  for (std::ptrdiff_t n = 0; n < static_cast<std::ptrdiff_t>(run.ticks.size()); ++n) {
    const std::ptrdiff_t m = fine_done + std::llround(static_cast<double>(n - done) * fine_hz / rate_hz);
    if (m < 0 || m >= static_cast<std::ptrdiff_t>(fine.ticks.size())) continue;
    const double d =
        apart_m(run.ticks[static_cast<std::size_t>(n)].X_WT, fine.ticks[static_cast<std::size_t>(m)].X_WT, radius_m);
    sum += d * d;
    ++count;
  }
  error.path_rms_m = std::sqrt(sum / count);
  const auto &last = run.ticks.back(), &last_fine = fine.ticks.back();
  error.rest_m = apart_m(last.X_WT, last_fine.X_WT, radius_m);
  error.force_n = (last.F_contact_W.force - last_fine.F_contact_W.force).norm();
  return error;
}

}  // namespace

void rates(const bench::Effort& effort, Report& report) {
  constexpr double kFinest_hz = 16000;
  const bench::LoadedScene scene = bench::load_scene_by_name("peg");
  const double radius_m = scene.shell->bounding_radius_m, voxel = scene.field.voxel_m();
  struct Run {
    std::string law, integrator;
    double rate_hz;
  };
  std::vector<Run> runs;
  const std::vector<double> hz =
      effort.quick ? std::vector<double>{500, 1000} : std::vector<double>{250, 500, 1000, 2000, 4000};
  const std::vector<std::string> some = effort.quick ? std::vector<std::string>{"potential"}
                                                     : std::vector<std::string>{"global", "adaptive-6dof", "potential"};
  for (const std::string& name : some) {
    for (const char* integrator : {"implicit", "semi-implicit"}) {
      for (const double rate : hz) runs.push_back({name, integrator, rate});
    }
    runs.push_back({name, "implicit", kFinest_hz});
  }
  std::vector<lockstep::Experiment> setups;
  for (const Run& run : runs) {
    setups.push_back(experiment_of(scene, "press"));
    law(run.law)(setups.back());
    setups.back().delay_ticks = 0;
    setups.back().session.scene.coupling.integrator = run.integrator;
    setups.back().session.machine.rate_hz = run.rate_hz;
  }
  const auto played = play_all(setups);
  // A tick's cost, alone on its core: a second of the press.
  const auto cost_us = [&](const lockstep::Experiment& setup) {
    lockstep::Lockstep rig(setup);
    rig.run(2);
    bench::Timings time;
    for (int n = 0; n < 1000; ++n) time.add(bench::seconds_of([&] { rig.tick(); }));
    return 1e6 * time.median();
  };
  std::vector<Report::Row> rows, times;
  bench::Chart pareto{"Time step: load of a core against error of the path",
                      "load of a core, %",
                      "path error, voxels, rms",
                      true,
                      true,
                      {}};
  for (const std::string& name : some) {
    const auto finest = static_cast<std::size_t>(
        std::find_if(runs.begin(), runs.end(), [&](const Run& r) { return r.law == name && r.rate_hz == kFinest_hz; }) -
        runs.begin());
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].law != name || i == finest) continue;
      const Error error = against(played[i], runs[i].rate_hz, played[finest], kFinest_hz, radius_m);
      rows.push_back({name, runs[i].integrator, number(runs[i].rate_hz), number(error.path_rms_m / voxel),
                      number(error.rest_m / voxel), number(error.force_n)});
      const double us = cost_us(setups[i]);
      const double load = 1e-4 * us * runs[i].rate_hz;
      times.push_back({name, runs[i].integrator, number(runs[i].rate_hz), number(us), number(load)});
      if (name != "potential") continue;
      if (pareto.lines.empty() || pareto.lines.back().name != runs[i].integrator)
        pareto.lines.push_back({runs[i].integrator, {}});
      pareto.lines.back().points.push_back({load, error.path_rms_m / voxel});
    }
  }
  report.say("Peg press, replies at once, against the implicit run at " + number(kFinest_hz) +
             " Hz. Path: rms distance over the run of the farthest point; rest: the same at the end.");
  report.table({"law", "integrator", "rate, Hz", "path, voxels", "rest, voxels", "force at rest, N"}, rows);
  report.say("Device, loop and contact server in one thread, microseconds a tick:");
  report.times({"law", "integrator", "rate, Hz", "tick, us", "load of a core, %"}, times);
  report.chart(pareto);
}

}  // namespace tact::evidence
