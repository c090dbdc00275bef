// How well G foretells the wrench at the next pose, and how much of what it misses is the change of weights.
#include <algorithm>
#include <cmath>
#include <map>

#include "bench/benchmarks.hpp"
#include "bench/scene.hpp"
#include "math/exp_log.hpp"

namespace tact::bench {
namespace {

using Weights = std::map<std::uint32_t, double>;

/// The wrench of the last step in O, k left out; points in `weights` with these instead of their own.
Vec6 wrench_O(const contact::ContactBuffer& contacts, const Weights& weights = {}) {
  Vec6 F = Vec6::Zero();
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const auto kept = weights.find(contacts.point_id[i]);
    const double w = kept == weights.end() ? contacts.weight[i] : kept->second;
    const Vec3 f = w * contacts.depth_m[i] * contacts.force_direction(i);
    F.head<3>() += f;
    F.tail<3>() += contacts.r[i].cross(f);
  }
  return F;
}

double percentile(std::vector<double> v, double p) {
  const auto at = static_cast<std::ptrdiff_t>(p * static_cast<double>(v.size() - 1));
  std::nth_element(v.begin(), v.begin() + at, v.end());
  return v[static_cast<std::size_t>(at)];
}

struct Tally {
  std::vector<double> missed, weights;  // shares of |change of F|
  std::size_t changed = 0, all = 0;     // contact sets
};

}  // namespace

void bench_gradient(const Effort& effort, Report& report) {
  report.say(
      "From poses in contact, by random steps: |F(x + dx) - F(x) - G dx| over |F(x + dx) - F(x)|, torques in units of "
      "the "
      "radius of gyration. `weights`: the part of the change of F that is due to other weights of contacts that stay; "
      "`potential` has it in G but for contacts that come and go, the others have not. Law none has no weights: its "
      "row is "
      "what the field's curvature and new contacts alone do. All scenes, landing-gear at 256 cells (left out by "
      "--quick); median, "
      "90 %.");
  std::map<std::pair<std::string, double>, Tally> tallies;
  constexpr double kSteps[] = {0.001, 0.01, 0.1};
  for (const std::string name : {"alpha", "cone", "engine", "landing-gear", "peg", "peg-round", "two-walls", "wedge"}) {
    if (effort.quick && name == "landing-gear") continue;
    const LoadedScene scene = load_scene_by_name(name, [](SceneSpec& spec) {
      if (spec.name == "landing-gear") spec.field_resolution = 256;
    });
    const double voxel = scene.field.voxel_m(), lever = scene.shell->gyration_radius_m;
    std::string script;
    for (const std::string wanted : {"cheat", "press", "insert"}) {
      if (script.empty() && scene.spec.scripts.count(wanted) > 0) script = wanted;
    }
    const auto near = poses_along(scene, script, 20000, voxel, 0.5 * voxel / lever, 27);
    const auto poses = with_contacts(scene, near, 2, 5000, effort.scaled(100), voxel);
    for (const std::string_view law : contact::law_names()) {
      const auto pipeline = scene.pipeline(std::string(law));
      std::mt19937 rng(28);
      std::normal_distribution<double> normal;
      for (const Pose& X_WM : poses) {
        for (const double step : kSteps) {
          Vec6 dx;
          for (int c = 0; c < 6; ++c) dx[c] = normal(rng);
          dx *= step * voxel / dx.norm();
          dx.tail<3>() /= lever;
          auto query = scene.query(X_WM);
          const contact::Response here = pipeline->step(query).response_W;
          const double k = pipeline->step(query).stiffness_n_per_m;
          const contact::ContactBuffer& contacts = pipeline->contacts();
          Weights weights;
          for (std::size_t i = 0; i < contacts.size; ++i) weights[contacts.point_id[i]] = contacts.weight[i];
          query.X_WT = displaced(query.X_WT, dx);
          const contact::Response there = pipeline->step(query).response_W;
          const auto size = [&](const Vec6& F) { return std::hypot(F.head<3>().norm(), F.tail<3>().norm() / lever); };
          const Vec6 change = there.F.vector() - here.F.vector();
          if (!(size(change) > 0)) continue;
          Tally& tally = tallies[{std::string(law), step}];
          bool same = contacts.size == weights.size();
          for (std::size_t i = 0; i < contacts.size; ++i) same = same && weights.count(contacts.point_id[i]) > 0;
          tally.changed += !same;
          ++tally.all;
          tally.missed.push_back(size(change - here.G * dx) / size(change));
          tally.weights.push_back(k * size(wrench_O(contacts) - wrench_O(contacts, weights)) / size(change));
        }
      }
    }
  }
  std::vector<Report::Row> rows;
  for (const std::string_view law : contact::law_names()) {
    for (const double step : kSteps) {
      const Tally& t = tallies.at({std::string(law), step});
      const auto percent = [](double share) { return number(100 * share); };
      rows.push_back({std::string(law), number(step),
                      percent(static_cast<double>(t.changed) / static_cast<double>(t.all)),
                      percent(percentile(t.missed, 0.5)), percent(percentile(t.missed, 0.9)),
                      percent(percentile(t.weights, 0.5)), percent(percentile(t.weights, 0.9))});
    }
  }
  report.table({"law", "step, voxels", "set changed, %", "missed by G, %", "90 %", "weights, %", "90 %"}, rows);
}

}  // namespace tact::bench
