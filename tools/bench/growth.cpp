// How a tick grows with points, voxels and contacts.
#include <array>
#include <cmath>

#include "bench/benchmarks.hpp"
#include "bench/measure.hpp"
#include "bench/scene.hpp"

namespace tact::bench {
namespace {

/// A tick's time by something, both as logarithms see them: time ~ factor * x^exponent, by least squares.
struct Growth {
  std::string what;
  std::vector<std::array<double, 3>> points;  ///< x, median and 99th percentile in us
  double exponent = 0, factor = 0;

  void fit() {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const auto& [x, y, p99] : points) {
      const double u = std::log(x), v = std::log(y);
      n += 1, sx += u, sy += v, sxx += u * u, sxy += u * v;
    }
    exponent = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    factor = std::exp((sy - exponent * sx) / n);
  }
};

Chart chart_of(const Growth& growth) {
  Chart chart{"Contact tick, alpha: x^" + number(growth.exponent), growth.what, "us", true, true, {}};
  Chart::Line median{"median", {}, true}, p99{"99th percentile", {}, true}, fitted{"fitted", {}};
  for (const auto& [x, p50, slow] : growth.points) {
    median.points.push_back({x, p50});
    p99.points.push_back({x, slow});
    fitted.points.push_back({x, growth.factor * std::pow(x, growth.exponent)});
  }
  chart.lines = {median, p99, fitted};
  return chart;
}

void tell(Report& report, Growth& growth) {
  growth.fit();
  report.say("  tick ~ " + growth.what + "^" + number(growth.exponent));
  report.chart(chart_of(growth));
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
  Growth growth{what, {}};
  for (const int value : values) {
    const LoadedScene scene = load_scene_by_name("alpha", [&](SceneSpec& spec) { set(spec, value); });
    const Tick t = tick(scene, poses, 10);
    const double p50 = 1e6 * t.time.median(), p99 = 1e6 * t.time.percentile(0.99);
    rows.push_back({std::to_string(value), number(t.contacts), number(p50), number(p99),
                    number(1e-6 * static_cast<double>(scene.field.bytes()))});
    growth.points.push_back({static_cast<double>(value), p50, p99});
  }
  report.times({what, "contacts, mean", "tick p50, us", "p99, us", "field, MB"}, rows);
  tell(report, growth);
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
  Growth by_contacts{"contacts", {}};
  const auto far = poses_along(scene, "cheat", 20000, 0.012, 0.12, 24);
  for (const auto& [fewest, most] : {std::pair{8, 12}, {28, 35}, {90, 110}, {280, 350}, {500, 900}}) {
    const Tick t = tick(
        scene,
        with_contacts(scene, far, static_cast<std::size_t>(fewest), static_cast<std::size_t>(most), effort.scaled(100)),
        10);
    const double p50 = 1e6 * t.time.median(), p99 = 1e6 * t.time.percentile(0.99);
    rows.push_back({number(t.contacts), number(p50), number(p99)});
    by_contacts.points.push_back({t.contacts, p50, p99});
  }
  report.times({"contacts, mean", "tick p50, us", "p99, us"}, rows);
  tell(report, by_contacts);
}

}  // namespace tact::bench
