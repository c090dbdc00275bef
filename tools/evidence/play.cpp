#include "evidence/play.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace tact::evidence {

lockstep::Experiment experiment_of(const bench::LoadedScene& scene, const std::string& script) {
  lockstep::Experiment setup;
  setup.session.scene = scene.spec;
  setup.session.run.script = script;
  setup.bodies = scene;
  return setup;
}

Change law(const std::string& name) {
  return [name](lockstep::Experiment& setup) { setup.session.scene.contact.law = name; };
}

const std::vector<std::string>& laws() {
  static const std::vector<std::string> all{"none", "global", "adaptive-3dof", "adaptive-6dof", "potential"};
  return all;
}

unsigned Played::most_contacts() const {
  unsigned most = 0;
  for (const auto& tick : ticks) most = std::max(most, tick.contact_count);
  return most;
}

Played play(const lockstep::Experiment& setup, const std::function<void(lockstep::Lockstep&)>& at_end) {
  Played played;
  lockstep::Lockstep rig(setup);
  played.report = lockstep::run_experiment(rig, setup.session,
                                           [&](const lockstep::TickTrace& tick) { played.ticks.push_back(tick); });
  if (at_end) at_end(rig);
  return played;
}

std::vector<Played> play_all(const std::vector<lockstep::Experiment>& setups,
                             const std::function<void(std::size_t, lockstep::Lockstep&)>& at_end) {
  std::vector<Played> all(setups.size());
  tbb::parallel_for(std::size_t{0}, setups.size(), [&](std::size_t i) {
    all[i] = play(setups[i], [&](lockstep::Lockstep& rig) {
      if (at_end) at_end(i, rig);
    });
  });
  return all;
}

}  // namespace tact::evidence
