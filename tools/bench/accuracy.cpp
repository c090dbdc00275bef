// Speed against error: what a coarser field or fewer points cost in wrench and depth, by law.
#include <algorithm>
#include <cmath>
#include <map>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"

namespace tact::bench {
namespace {

struct Answer {
  Vec3 force, torque;
  Mat3 gradient;  ///< of the force by translation
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
      out.answers.push_back({F.force, F.torque + (query.X_WT.p - X_WM.p).cross(F.force),
                             result.response_W.G.topLeftCorner<3, 3>(), result.max_depth_m});
    }
  }
  return out;
}

double median(std::vector<double> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

/// Medians over the poses; percent of the reference's, but depth.
struct Errors {
  double force, torque, gradient, depth_mm;
};

Errors errors_of(const Run& run, const Run& reference) {
  std::vector<double> force, torque, gradient, depth;
  for (std::size_t i = 0; i < run.answers.size(); ++i) {
    const Answer &a = run.answers[i], &b = reference.answers[i];
    force.push_back((a.force - b.force).norm() / std::max(b.force.norm(), 1e-9));
    torque.push_back((a.torque - b.torque).norm() / std::max(b.torque.norm(), 1e-9));
    gradient.push_back((a.gradient - b.gradient).norm() / std::max(b.gradient.norm(), 1e-9));
    depth.push_back(std::fabs(a.depth_m - b.depth_m));
  }
  return {100 * median(force), 100 * median(torque), 100 * median(gradient), 1e3 * median(depth)};
}

struct Measured {
  int cells, points;
  Errors errors;
  double p50_us, p99_us, field_mb;
};

/// Cheapest first; each next one costs more and errs less.
std::vector<Measured> front_of(std::vector<Measured> all) {
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.p50_us < b.p50_us; });
  std::vector<Measured> front;
  for (const Measured& m : all) {
    if (front.empty() || m.errors.force < front.back().errors.force) front.push_back(m);
  }
  return front;
}

}  // namespace

void bench_accuracy(const Effort& effort, Report& report) {
  constexpr double kStiffness = 10000;
  const std::vector<int> cells = effort.quick ? std::vector{128, 256} : std::vector{128, 256, 512, 1024};
  const std::vector<int> points = effort.quick ? std::vector{1000, 5000} : std::vector{1000, 5000, 25269, 100000};
  const auto with = [&](int n_cells, int n_points) {
    return load_scene_by_name("alpha", [&](SceneSpec& spec) {
      spec.field_resolution = n_cells;
      spec.points = n_points;
      spec.contact.stiffness_n_per_m = kStiffness;
    });
  };
  report.say("Alpha at " + number(kStiffness) +
             " N/m, poses along the cheat in contact, depths up to 2 voxels of 512. Reference of each law: itself at " +
             std::to_string(cells.back()) + " cells and " + std::to_string(points.back()) +
             " points. Medians over the poses: error of force, torque and gradient (of the force by translation) in "
             "percent of "
             "the reference's, of depth in mm.");
  const LoadedScene finest = with(cells.back(), points.back());
  const auto near = poses_along(finest, "cheat", 20000, 0.003, 0.03, 25);
  const LoadedScene usual = with(std::min(512, cells.back()), std::min(25269, points.back()));
  const auto poses = with_contacts(usual, near, effort.quick ? 5 : 20, 200, effort.scaled(200), 1e-3);

  std::map<std::string, std::vector<Measured>> by_law;
  std::map<std::string, Run> references;
  for (const std::string_view law : contact::law_names()) {
    references[std::string(law)] = run(finest, std::string(law), poses);
  }
  for (const int n_cells : cells) {
    for (const int n_points : points) {
      const LoadedScene scene = with(n_cells, n_points);
      for (const auto& [law, reference] : references) {
        const Run coarse = run(scene, law, poses);
        by_law[law].push_back({n_cells, n_points, errors_of(coarse, reference), 1e6 * coarse.time.median(),
                               1e6 * coarse.time.percentile(0.99), 1e-6 * static_cast<double>(scene.field.bytes())});
      }
    }
  }
  std::vector<Report::Row> errors, times, advice;
  Chart chart{"Tick against error of the force", "tick, us, median", "force error, %", true, true, {}};
  for (const std::string_view name : contact::law_names()) {
    const std::string law(name);
    Chart::Line line{law, {}};
    for (const Measured& m : by_law[law]) {
      const std::string c = std::to_string(m.cells), p = std::to_string(m.points);
      const bool is_reference = m.cells == cells.back() && m.points == points.back();
      if (!is_reference) {
        errors.push_back({law, c, p, number(m.errors.force), number(m.errors.torque), number(m.errors.gradient),
                          number(m.errors.depth_mm)});
      }
      times.push_back({law, c, p, number(m.p50_us), number(m.p99_us), number(m.field_mb)});
    }
    const auto front = front_of({by_law[law].begin(), by_law[law].end() - 1});
    for (const Measured& m : front) line.points.push_back({m.p50_us, m.errors.force});
    chart.lines.push_back(line);
    for (const double bound : {40.0, 20.0, 10.0, 5.0}) {
      const auto found =
          std::find_if(front.begin(), front.end(), [&](const Measured& m) { return m.errors.force <= bound; });
      if (found == front.end()) continue;
      advice.push_back({law, number(bound), std::to_string(found->cells), std::to_string(found->points),
                        number(found->errors.force), number(found->p50_us)});
    }
  }
  report.table({"law", "cells", "points", "force, %", "torque, %", "gradient, %", "depth, mm"}, errors);
  report.say("The same, time of a tick:");
  report.times({"law", "cells", "points", "tick p50, us", "p99, us", "field, MB"}, times);
  report.say("For this error of the force, use this (the cheapest that keeps it):");
  report.times({"law", "at most, %", "cells", "points", "error, %", "tick, us"}, advice);
  report.chart(chart);
}

}  // namespace tact::bench
