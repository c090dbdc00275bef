// Laws at equal stability margin: each at half its own largest stable k, and round closed paths.
#include <tbb/parallel_for.h>

#include <cmath>
#include <random>

#include "bench/benchmarks.hpp"
#include "bench/presses.hpp"
#include "contact/stiffness/law.hpp"
#include "lockstep/experiment.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

using lockstep::Experiment;
using lockstep::Lockstep;

std::string text(const char* format, double a, double b) {
  char out[64];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

/// Depth on the wall at -x over that at +x, at the rig's last pose.
double balance(Lockstep& rig) {
  const auto& contacts = rig.pipeline().contacts();
  const Vec3 p_OT = (rig.answer().X_WO.inverse() * rig.answer().X_WT).p;
  double depth_a = 0, depth_b = 0;
  for (std::size_t i = 0; i < contacts.size; ++i) {
    double& depth = p_OT.x() + contacts.r[i].x() < 0 ? depth_a : depth_b;
    depth = std::max(depth, contacts.depth_m[i]);
  }
  return std::max(depth_a, depth_b) / std::min(depth_a, depth_b);
}

/// The whole script at one k.
Report::Row played(const Experiment& setup, const std::string& law, const std::string& stable, double k,
                   bool two_walls) {
  Lockstep rig(at_stiffness(setup, k));
  const report::SessionReport r = run_experiment(rig, setup.session);
  const auto& s = r.stats;
  return {law,
          stable,
          newtons_per_metre(k),
          text("%.3f / %.3f", s.penetration_quasi_static_max_m / r.voxel_m, s.penetration_max_m / r.voxel_m),
          text("%.3f / %.2f", s.force_step_rms_n, s.force_step_max_n),
          newtons_per_metre(s.net_stiffness_max_n_per_m),
          number(s.force_max_n),
          two_walls ? number(balance(rig)) : "",
          r.goal_reached && !two_walls ? "reached" : ""};
}

/// What is compared: every law as it stands, [P]'s own form of two of them, and other numbers for `potential`.
struct Contender {
  std::string name;
  std::vector<std::pair<const char*, const char*>> settings;  ///< keys of the scene

  Experiment of(Experiment setup) const {
    for (const auto& [key, value] : settings) set_scene_key(setup.session.scene, key, value);
    return setup;
  }
};

std::vector<Contender> contenders(const Effort& effort) {
  std::vector<Contender> all;
  for (const std::string_view law : contact::law_names()) {
    if (effort.quick && law != "adaptive-6dof" && law != "potential") continue;
    all.push_back({std::string(law), {{"contact.law", law.data()}}});
  }
  if (effort.quick) return all;
  all.push_back({"adaptive-6dof, along N", {{"contact.law", "adaptive-6dof"}, {"contact.force_along", "normal"}}});
  all.push_back({"potential, along N", {{"contact.force_along", "normal"}}});
  all.push_back({"potential, p 8", {{"contact.p", "8"}}});
  all.push_back({"potential, p 32, q 16", {{"contact.p", "32"}, {"contact.q", "16"}}});
  all.push_back({"potential, reach 90", {{"contact.reach_deg", "90"}}});
  all.push_back({"potential, reach 45", {{"contact.reach_deg", "45"}}});
  return all;
}

/// What a hand takes for even: a twentieth of F_max a tick.
constexpr double kEven_n = 0.05 * kForceMax_n;

/// The largest k at which the press is stable and even, from above: on thin wires a soft contact slips, and is not.
double largest_even(const Experiment& setup, double ratio) {
  const auto even = [&](double k) {
    const lockstep::Verdict verdict = lockstep::press(at_stiffness(setup, k));
    return verdict.stable() && verdict.force_step_rms_n <= kEven_n;
  };
  double k = kStiffest;
  while (k > 1e3 && !even(k)) k /= 2;
  return k > 1e3 ? lockstep::largest_stable(even, k, std::min(2 * k, kStiffest), ratio) : 0;
}

struct Contest {
  const char *scene, *script;
};
constexpr Contest kContests[] = {{"alpha", "cheat"},  {"cone", "insert"},       {"two-walls", "press"},
                                 {"peg", "press"},    {"peg-round", "press"},   {"wedge", "press"},
                                 {"engine", "cheat"}, {"landing-gear", "cheat"}};

/// Where the tool rests when pressed at the k the scene states.
struct Rest {
  Pose X_WT;
  double amplitude_m = 0;
};

Rest rest_of(const Experiment& setup) {
  Lockstep rig(setup);
  rig.run_script();
  return {rig.trace().X_WT, 0.25 * rig.voxel_m()};
}

/// Work of the contact wrench round closed paths through contact, over the work without its sign: 0 for an energy.
struct Work {
  double share = 0;    ///< mean of |sum F dx| / sum |F dx|
  double worst_j = 0;  ///< largest |sum F dx|
};

Work round_closed_paths(const Experiment& setup, const Rest& rest, int paths, int steps) {
  contact::ContactPipeline pipeline(
      setup.bodies.field, setup.bodies.shell, 16384,
      contact::pipeline_params(setup.session.scene.contact, setup.bodies.field.voxel_m(), 1, 0));
  std::mt19937 rng(7);
  std::normal_distribution<double> normal;
  const double radius_m = setup.bodies.shell->bounding_radius_m;
  const auto direction = [&] {  // as far for the farthest point by turning as by moving
    Vec6 v;
    for (double& x : v) x = normal(rng);
    v.normalize();
    v.tail<3>() /= radius_m;
    return v;
  };
  Work work;
  for (int path = 0; path < paths; ++path) {
    const Vec6 a = rest.amplitude_m * direction(), b = rest.amplitude_m * direction();
    const auto pose_at = [&](int i) {
      const double angle = 2 * M_PI * i / steps;
      return displaced(rest.X_WT, std::cos(angle) * a + std::sin(angle) * b);
    };
    double sum_j = 0, absolute_j = 0;
    for (int i = 0; i < steps; ++i) {  // midpoint rule
      const Pose X_0 = pose_at(i), X_1 = pose_at(i + 1);
      const Vec6 x = displacement(X_0, X_1);
      const Vec6 F = pipeline.step({displaced(X_0, 0.5 * x), {}, setup.session.scene.X_WO, {}}).response_W.F.vector();
      sum_j += F.dot(x);
      absolute_j += std::fabs(F.dot(x));
    }
    if (absolute_j > 0) work.share += std::fabs(sum_j) / absolute_j / paths;
    work.worst_j = std::max(work.worst_j, std::fabs(sum_j));
  }
  return work;
}

}  // namespace

void bench_judgement(const Effort& effort, Report& report) {
  const double ratio = effort.quick ? 1.5 : 1.1;
  report.say(
      "Each law at half the largest k at which the press is stable at 1 kHz with every reply one tick late, F_max " +
      number(kForceMax_n) +
      " N: equal stability margin. And at the largest k at which it is stable and the contact "
      "force steps by at most " +
      number(kEven_n) +
      " N a tick (root mean square while touching): equally even. Then the whole script. Depth in voxels, quasi-static "
      "/ "
      "largest; force step in N, rms / largest; net: largest eigenvalue of K, N/m; balance: depths on the walls.");
  const std::vector<Contender> all = contenders(effort);
  for (const auto& [scene, script] : kContests) {
    if (effort.quick && std::string(scene) != "wedge") continue;
    const Press press = make_press(scene, script);
    const bool two_walls = std::string(scene) == "two-walls";
    std::vector<Report::Row> margin(all.size()), smooth(all.size());
    tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
      const Experiment whole = all[i].of(press.whole), setup = all[i].of(press.setup);
      const StableStiffness stable = stable_stiffness(setup, ratio);
      const double stated = stated_stiffness(whole);
      margin[i] = played(whole, all[i].name, text_of(stable), stable.k > 0 ? stable.k / 2 : stated, two_walls);
      const double even = largest_even(setup, ratio);
      smooth[i] =
          played(whole, all[i].name, even > 0 ? newtons_per_metre(even) : "none", even > 0 ? even : stated, two_walls);
    });
    const auto say = [&](const std::string& how, const std::vector<Report::Row>& table) {
      report.say(press.name + ", k as stated " + newtons_per_metre(stated_stiffness(press.whole)) + "; " + how + ":");
      report.table({"law", "largest k", "k", "depth", "force step", "net", "force", "balance", "goal"}, table);
    };
    say("at half the largest stable k", margin);
    say("at the largest k with even forces", smooth);
  }
}

void bench_work(const Effort& effort, Report& report) {
  report.say(
      "Work of the contact wrench round closed paths about the pose of rest, a quarter of a voxel wide, moving and "
      "turning at random: share of the work done to and fro (0: forces have an energy), largest in microjoules.");
  for (const auto& [scene, script] : kContests) {
    const std::string name = scene;
    if (name == "engine" || name == "landing-gear" || (effort.quick && name != "peg" && name != "two-walls")) continue;
    const Press press = make_press(name, script);
    const Rest rest = rest_of(press.whole);
    const auto laws = contact::law_names();
    std::vector<Report::Row> table(laws.size());
    tbb::parallel_for(std::size_t{0}, laws.size(), [&](std::size_t i) {
      Report::Row row{std::string(laws[i])};
      for (const char* along : {"gradient", "normal"}) {
        Experiment setup = press.whole;
        setup.session.scene.contact.law = std::string(laws[i]);
        setup.session.scene.contact.force_along = along;
        const Work work = round_closed_paths(setup, rest, effort.quick ? 2 : 20, effort.quick ? 1000 : 4000);
        row.push_back(number(100 * work.share) + " %");
        row.push_back(number(1e6 * work.worst_j));
      }
      table[i] = row;
    });
    report.say(press.name + ":");
    report.table({"law", "along g", "uJ", "along N", "uJ"}, table);
  }
}

}  // namespace tact::bench
