// How a tick grows with points, voxels and contacts.
#include <cmath>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"

namespace tact::bench {
namespace {

/// Slope of log y over log x by least squares.
double exponent(const std::vector<std::pair<double, double>>& points) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (const auto& [x, y] : points) {
    const double u = std::log(x), v = std::log(y);
    n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

struct Tick {
  double contacts = 0;
  Timings time;
};

Tick tick(const LoadedScene& scene, const std::vector<Pose>& poses, std::size_t rounds) {
  Tick t;
  const auto pipeline = scene.pipeline();
  for (std::size_t round = 0; round < rounds; ++round) {
    for (const Pose& X_WM : poses) {
      const auto query = scene.query(X_WM);
      t.time.add(seconds_of([&] { keep(pipeline->step(query).contact_count); }));
      t.contacts +=
          static_cast<double>(pipeline->step(query).contact_count) / static_cast<double>(rounds * poses.size());
    }
  }
  return t;
}

void sweep(Report& report, const std::string& what, const std::vector<int>& values,
           const std::function<void(SceneSpec&, int)>& set, const std::vector<Pose>& poses) {
  std::vector<Report::Row> rows;
  std::vector<std::pair<double, double>> points;
  for (const int value : values) {
    const LoadedScene scene = load_scene_by_name("alpha", [&](SceneSpec& spec) { set(spec, value); });
    const Tick t = tick(scene, poses, 10);
    rows.push_back({std::to_string(value), number(t.contacts), number(1e6 * t.time.median()),
                    number(1e6 * t.time.percentile(0.99)), number(1e-6 * static_cast<double>(scene.field.bytes()))});
    points.emplace_back(value, t.time.median());
  }
  report.table({what, "contacts, mean", "tick p50, us", "p99, us", "field, MB"}, rows);
  report.say("  tick ~ " + what + "^" + number(exponent(points)));
}

}  // namespace

void bench_growth(const Effort& effort, Report& report) {
  report.say("Alpha, law of the scene, the same poses along the cheat for all; tick: traversal, law, wrench.");
  const LoadedScene scene = load_scene_by_name("alpha");
  const auto near = poses_along(scene, "cheat", 20000, 0.003, 0.03, 23);
  const auto poses = with_contacts(scene, near, 75, 130, effort.scaled(200));
  const std::vector<int> points =
      effort.quick ? std::vector{1000, 5000, 25269} : std::vector{1000, 3000, 10000, 25269, 50000, 100000};
  const std::vector<int> cells = effort.quick ? std::vector{128, 256, 512} : std::vector{128, 256, 512, 1024};
  sweep(
      report, "points", points, [](SceneSpec& spec, int n) { spec.points = n; }, poses);
  sweep(
      report, "voxels along the longest side", cells, [](SceneSpec& spec, int n) { spec.field_resolution = n; }, poses);

  std::vector<Report::Row> rows;
  std::vector<std::pair<double, double>> by_contacts;
  const auto far = poses_along(scene, "cheat", 20000, 0.012, 0.12, 24);
  for (const auto& [fewest, most] : {std::pair{8, 12}, {28, 35}, {90, 110}, {280, 350}, {500, 900}}) {
    const Tick t = tick(
        scene,
        with_contacts(scene, far, static_cast<std::size_t>(fewest), static_cast<std::size_t>(most), effort.scaled(100)),
        10);
    rows.push_back({number(t.contacts), number(1e6 * t.time.median()), number(1e6 * t.time.percentile(0.99))});
    by_contacts.emplace_back(t.contacts, t.time.median());
  }
  report.table({"contacts, mean", "tick p50, us", "p99, us"}, rows);
  report.say("  tick ~ contacts^" + number(exponent(by_contacts)));
}

}  // namespace tact::bench
