#include "lockstep/experiment.hpp"

#include <cstdio>
#include <fstream>

#include "cli/commands.hpp"
#include "fault/fault.hpp"

namespace tact::cli {

int experiment(const RunOptions& options, const ExperimentOptions& more) {
  lockstep::Experiment setup;
  setup.session = resolve(options);
  setup.delay_ticks = more.delay_ticks;
  setup.replies = more.replies;
  const SceneSpec& scene = setup.session.scene;
  bool told = false;
  setup.bodies = lockstep::open_bodies(
      contact::ensure_baked(scene, cache_dir(setup.session.machine), [&](const contact::BakeStep&) {
        if (!told) std::fprintf(stderr, "tact experiment: baking %s (kept in the cache)\n", scene.name.c_str());
        return told = true;
      }));
  lockstep::Lockstep rig(setup);
  std::ofstream csv;
  if (!more.csv.empty()) {
    csv.open(more.csv);
    csv << lockstep::trace_columns() << '\n';
  }
  const auto report = lockstep::run_experiment(rig, setup.session, [&](const lockstep::TickTrace& trace) {
    if (csv.is_open()) csv << lockstep::trace_row(trace) << '\n';
  });
  if (!more.csv.empty() && !csv.flush()) throw SetupError(more.csv.string() + ": --csv: cannot write here");
  const std::string json = report::to_json(report);
  std::fputs((more.json ? json : report::to_table(report)).c_str(), stdout);
  if (!more.json) {
    for (const std::string& note : report.notes) std::printf("%s\n", note.c_str());
  }
  if (!setup.session.run.report.empty()) {
    std::ofstream out(setup.session.run.report);
    if (!(out << json).flush()) throw SetupError(setup.session.run.report.string() + ": run.report: cannot write here");
  }
  return 0;
}

}  // namespace tact::cli
