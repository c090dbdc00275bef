#include "bench/presses.hpp"

#include <cstdio>
#include <utility>

#include "bench/scene.hpp"

namespace tact::bench {
namespace {

lockstep::Experiment setup_of(lockstep::AnalyticScene scene) {
  lockstep::Experiment setup;
  setup.session.scene = std::move(scene.spec);
  setup.bodies = std::move(scene.bodies);
  setup.motion_WM = std::move(scene.motion_WM);
  return setup;
}

}  // namespace

Press make_press(const std::string& scene, const std::string& script) {
  Press press;
  press.name = script.empty() ? scene : scene + " " + script;
  if (scene.rfind("flat-", 0) == 0) {
    press.whole = setup_of(lockstep::flat_face(std::stoi(scene.substr(5))));
  } else if (scene == "ball") {
    press.whole = setup_of(lockstep::ball_on_plane(2000));
  } else if (scene == "wires") {
    press.whole = setup_of(lockstep::foot_on_wires(1600));
  } else {
    const LoadedScene loaded = load_scene_by_name(scene);
    press.whole.session.scene = loaded.spec;
    press.whole.session.run.script = script;
    press.whole.bodies = loaded;
  }
  press.whole.delay_ticks = kDelay_ticks;
  press.setup = press.whole;
  if (script.empty()) return press;
  // The cone slides along the floor for a while before it meets the gap: from there.
  scene == "cone" ? shorten_to_press(press.setup, 3.86, 0.001) : shorten_to_press(press.setup);
  return press;
}

lockstep::Experiment at_stiffness(const lockstep::Experiment& setup, double stiffness_n_per_m) {
  lockstep::Experiment changed = setup;
  lockstep::set_stiffness(changed.session.scene, stiffness_n_per_m, kForceMax_n, setup.bodies.field.voxel_m());
  return changed;
}

double stated_stiffness(const lockstep::Experiment& setup) {
  const SceneSpec& scene = setup.session.scene;
  return contact::pipeline_params(scene.contact, setup.bodies.field.voxel_m(), scene.coupling.mass_kg, 0)
      .stiffness_n_per_m;
}

StableStiffness stable_stiffness(const lockstep::Experiment& setup, double ratio) {
  return largest_stable([&](double k) { return press(at_stiffness(setup, k)); }, stated_stiffness(setup), kStiffest,
                        ratio);
}

StableStiffness largest_stable(const std::function<lockstep::Verdict(double)>& press_at, double stated, double most,
                               double ratio) {
  StableStiffness found;
  bool first = true;
  const auto stable = [&](double k) {
    const lockstep::Verdict verdict = press_at(k);
    if (std::exchange(first, false)) found.stated = verdict;
    (verdict.stable() ? found.at_k : found.above) = verdict;
    return verdict.stable();
  };
  found.k = lockstep::largest_stable(stable, stated, most, ratio);
  return found;
}

std::string newtons_per_metre(double k) {
  char text[32];
  if (k >= 1e6) {
    std::snprintf(text, sizeof text, "%.3gM", k * 1e-6);
  } else {
    std::snprintf(text, sizeof text, "%.3gk", k * 1e-3);
  }
  return text;
}

std::string text_of(const StableStiffness& found, double most) {
  if (found.k == 0) return std::string("none (") + name(found.stated.why) + ")";
  return (found.k >= most ? "> " : "") + newtons_per_metre(found.k);
}

}  // namespace tact::bench
