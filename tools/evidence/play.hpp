#pragma once
#include <functional>
#include <string>
#include <vector>

#include "bench/scene.hpp"
#include "lockstep/experiment.hpp"

namespace tact::evidence {

/// A scene's script on the rig: 1 kHz, pseudo-admittance, dynamic and implicit, every reply a tick late, unless
/// changed.
lockstep::Experiment experiment_of(const bench::LoadedScene& scene, const std::string& script);

/// Changes one thing of an experiment.
using Change = std::function<void(lockstep::Experiment&)>;
Change law(const std::string& name);

/// The laws [P] speaks of and ours, `none` first, ours last.
const std::vector<std::string>& laws();

/// What a run was.
struct Played {
  report::SessionReport report;
  std::vector<lockstep::TickTrace> ticks;

  double quasi_static_voxels() const { return report.stats.penetration_quasi_static_max_m / report.voxel_m; }
  double deepest_voxels() const { return report.stats.penetration_max_m / report.voxel_m; }
  unsigned most_contacts() const;
};

/// Plays the whole script. `at_end` sees the rig as the script left it.
Played play(const lockstep::Experiment& setup, const std::function<void(lockstep::Lockstep&)>& at_end = {});

/// Plays all at once, in the order given.
std::vector<Played> play_all(const std::vector<lockstep::Experiment>& setups,
                             const std::function<void(std::size_t, lockstep::Lockstep&)>& at_end = {});

}  // namespace tact::evidence
