// Speed against error: what a coarser field or fewer points cost in wrench and depth, by law.
#include <algorithm>
#include <cmath>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"

namespace tact::bench {
namespace {

struct Answer {
  Vec3 force, torque;
  double depth_m;
};

struct Run {
  std::vector<Answer> answers;
  Timings time;
};

Run run(const LoadedScene& scene, const std::string& law, const std::vector<Pose>& poses) {
  Run out;
  const auto pipeline = scene.pipeline(law);
  for (int round = 0; round < 3; ++round) {
    out.answers.clear();
    for (const Pose& X_WM : poses) {
      const auto query = scene.query(X_WM);
      out.time.add(seconds_of([&] { keep(pipeline->step(query).contact_count); }));
      const auto& result = pipeline->step(query);
      // About the mesh frame's origin: the centre of mass depends a little on the points.
      const Wrench& F = result.response_W.F;
      out.answers.push_back({F.force, F.torque + (query.X_WT.p - X_WM.p).cross(F.force), result.max_depth_m});
    }
  }
  return out;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

}  // namespace

void bench_accuracy(const Effort& effort, Report& report) {
  constexpr double kStiffness = 10000;
  const int finest_cells = effort.quick ? 512 : 1024, finest_points = effort.quick ? 25269 : 100000;
  const auto with = [&](int cells, int points) {
    return load_scene_by_name("alpha", [&](SceneSpec& spec) {
      spec.field_resolution = cells;
      spec.points = points;
      spec.contact.stiffness_n_per_m = kStiffness;
    });
  };
  report.say(
      "Alpha at " + number(kStiffness) +
      " N/m, poses along the cheat in contact, depths up to 2 voxels. Reference of each law: itself at " +
      std::to_string(finest_cells) + " cells and " + std::to_string(finest_points) +
      " points. Medians over the poses: force and torque error in percent of the reference's, depth error in mm.");
  const LoadedScene finest = with(finest_cells, finest_points);
  const auto near = poses_along(finest, "cheat", 20000, 0.003, 0.03, 25);
  const LoadedScene usual = with(512, 25269);
  const auto poses = with_contacts(usual, near, 20, 200, effort.scaled(200), 2 * usual.field.voxel_m());

  std::vector<std::pair<int, int>> grids;
  for (const int cells : {128, 256, 512}) grids.emplace_back(cells, finest_points);
  for (const int points : {1000, 5000, 25269}) grids.emplace_back(finest_cells, points);
  grids.emplace_back(512, 25269);
  std::vector<LoadedScene> scenes;
  for (const auto& [cells, points] : grids) scenes.push_back(with(cells, points));

  std::vector<Report::Row> rows;
  for (const std::string_view law : contact::law_names()) {
    const Run reference = run(finest, std::string(law), poses);
    for (std::size_t g = 0; g < grids.size(); ++g) {
      const Run coarse = run(scenes[g], std::string(law), poses);
      std::vector<double> force, torque, depth;
      for (std::size_t i = 0; i < poses.size(); ++i) {
        const Answer &a = coarse.answers[i], &b = reference.answers[i];
        force.push_back((a.force - b.force).norm() / std::max(b.force.norm(), 1e-9));
        torque.push_back((a.torque - b.torque).norm() / std::max(b.torque.norm(), 1e-9));
        depth.push_back(std::fabs(a.depth_m - b.depth_m));
      }
      rows.push_back({std::string(law), std::to_string(grids[g].first), std::to_string(grids[g].second),
                      number(1e6 * coarse.time.median()), number(100 * median(force)), number(100 * median(torque)),
                      number(1e3 * median(depth))});
    }
  }
  report.table({"law", "cells", "points", "tick p50, us", "force, %", "torque, %", "depth, mm"}, rows);
}

}  // namespace tact::bench
