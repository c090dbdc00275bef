// How stiff contact and coupling may be before a press no longer rests: by law, coupling, integrator, device mode,
// rate, delay and hand.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/benchmarks.hpp"
#include "bench/presses.hpp"
#include "bench/stability_results.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::bench {
namespace {

using lockstep::Experiment;

/// A point of the design: a hard case and everything the factors set.
struct Point {
  std::string name, scene, hand;
  Experiment setup;
};
/// One level of one factor. A new coupling or hand is one more line in these lists.
struct Level {
  std::string name;
  std::function<void(Point&)> apply;
};
using Axis = std::vector<Level>;

Level law(const std::string& name) {
  return {name, [name](Point& p) { p.setup.session.scene.contact.law = name; }};
}
Axis laws() {
  Axis axis;
  for (const std::string_view name : contact::law_names()) axis.push_back(law(std::string(name)));
  return axis;
}

Level coupling(const std::string& name, const char* mode, const char* kind, const char* integrator) {
  return {name, [=](Point& p) {
            p.setup.session.machine.mode = mode;
            p.setup.session.scene.coupling.kind = kind;
            p.setup.session.scene.coupling.integrator = integrator;
          }};
}
/// Everything that runs. In lockstep a reply is a tick old also for direct coupling in impedance, which waits for it in
/// a session.
Axis couplings() {
  constexpr const char *kP = "pseudo-admittance", *kI = "impedance";
  return {coupling("pseudo, dynamic, implicit", kP, "dynamic", "implicit"),
          coupling("pseudo, dynamic, semi-impl.", kP, "dynamic", "semi-implicit"),
          coupling("pseudo, static, implicit", kP, "static", "implicit"),
          coupling("pseudo, static, semi-impl.", kP, "static", "semi-implicit"),
          coupling("pseudo, direct, implicit", kP, "direct", "implicit"),
          coupling("pseudo, direct, semi-impl.", kP, "direct", "semi-implicit"),
          coupling("imped., dynamic, implicit", kI, "dynamic", "implicit"),
          coupling("imped., dynamic, semi-impl.", kI, "dynamic", "semi-implicit"),
          coupling("imped., static", kI, "static", "auto"),
          coupling("imped., direct", kI, "direct", "auto")};
}
/// Direct has no spring.
Axis sprung_couplings() {
  Axis axis = couplings();
  std::erase_if(axis, [](const Level& level) { return level.name.find("direct") != std::string::npos; });
  return axis;
}

/// Absent: nobody's arm, only a weight of 8 N on the handle: neither stiffness nor damping of a hand.
Axis hands() {
  const auto use = [](const char* name, double stiffness, double damping, double tissue, double mass, double force) {
    return Level{name, [=](Point& p) {
                   coupling::SimulatedHand::Params hand;
                   const double part = stiffness / hand.stiffness_n_per_m;
                   hand.stiffness_n_per_m = stiffness;
                   hand.stiffness_nm_per_rad *= part;
                   hand.damping_nm_s_per_rad *= damping / hand.damping_n_s_per_m;
                   hand.damping_n_s_per_m = damping;
                   hand.tissue_nm_s_per_rad *= tissue / hand.tissue_n_s_per_m;
                   hand.tissue_n_s_per_m = tissue;
                   hand.inertia_kg_m2 *= mass / hand.mass_kg;
                   hand.mass_kg = mass;
                   hand.force_max_n = force;
                   p.setup.hand = hand;
                   p.hand = name;
                 }};
  };
  return {{"usual", [](Point&) {}},
          use("soft", 400, 10, 2, 0.3, 20),
          use("stiff", 3000, 120, 10, 1.0, 40),
          use("absent", 2000, 0, 0, 0.01, 8)};
}

Axis rates(std::vector<int> hz) {
  Axis axis;
  for (const int rate : hz) {
    axis.push_back({std::to_string(rate) + " Hz", [rate](Point& p) { p.setup.session.machine.rate_hz = rate; }});
  }
  return axis;
}
Axis rates(const Effort& effort) {
  return effort.quick ? rates({500, 1000, 2000}) : rates({250, 500, 1000, 2000, 4000});
}

Axis delays(std::vector<int> ticks) {
  Axis axis;
  for (const int n : ticks) axis.push_back({"+" + std::to_string(n), [n](Point& p) { p.setup.delay_ticks = n; }});
  return axis;
}
Axis delays(const Effort& effort) { return effort.quick ? delays({0, 1, 3}) : delays({0, 1, 2, 3, 4, 6, 8, 10}); }

Axis dampings() {
  Axis axis;
  for (const double ratio : {0.0, 0.1}) {
    axis.push_back({ratio == 0 ? "undamped" : "damped",
                    [ratio](Point& p) { p.setup.session.scene.contact.damping_ratio = ratio; }});
  }
  return axis;
}

/// All combinations of the factors' levels, named by them.
std::vector<Point> points(const Press& press, const std::vector<Axis>& axes) {
  std::vector<Point> all{{press.name, press.name, "usual", press.setup}};
  for (const Axis& axis : axes) {
    std::vector<Point> longer;
    for (const Point& point : all) {
      for (const Level& level : axis) {
        Point changed = point;
        level.apply(changed);
        changed.name += ", " + level.name;
        longer.push_back(std::move(changed));
      }
    }
    all = std::move(longer);
  }
  return all;
}

StabilityResult contact_stiffness(const Point& point, double ratio) {
  return result_of(Quantity::contact, point.scene, point.hand, point.setup, stable_stiffness(point.setup, ratio),
                   kStiffest);
}

StabilityResult coupling_stiffness(const Point& point, double ratio) {
  constexpr double kMost = 1e5;  // of the key coupling.stiffness_n_per_m
  const auto press_at = [&](double k) {
    Experiment changed = point.setup;
    changed.session.scene.coupling.stiffness_n_per_m = k;
    return press(changed);
  };
  const StableStiffness found =
      largest_stable(press_at, point.setup.session.scene.coupling.stiffness_n_per_m, kMost, ratio);
  return result_of(Quantity::coupling, point.scene, point.hand, point.setup, found, kMost);
}

using Search = StabilityResult (*)(const Point&, double ratio);

/// The whole comparison: prints as it goes, keeps all results.
class Comparison {
 public:
  Comparison(const Effort& effort, Report& report) : ratio_(effort.quick ? 1.5 : 1.1), report_(report) {}

  /// Searches at every point, on all cores.
  std::vector<StabilityResult> search(const std::vector<Point>& points, Search one) {
    std::vector<StabilityResult> found(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) { found[i] = one(points[i], ratio_); });
    all_.insert(all_.end(), found.begin(), found.end());
    return found;
  }

  /// Rows by columns of one quantity; `net` adds the translational stiffness there.
  void table(const std::string& title, const std::string& corner, const std::vector<Point>& rows, const Axis& columns,
             Search one, bool net = false) {
    std::vector<Point> points;
    for (const Point& row : rows) {
      for (const Level& column : columns) column.apply(points.emplace_back(row));
    }
    const auto found = search(points, one);
    std::vector<Report::Row> table;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      Report::Row cells{rows[r].name};
      for (std::size_t c = 0; c < columns.size(); ++c) cells.push_back(found[r * columns.size() + c].text());
      table.push_back(std::move(cells));
    }
    Report::Row head{corner};
    for (const Level& column : columns) head.push_back(column.name);
    report_.say(title);
    report_.table(head, table);
    if (!net) return;
    for (std::size_t i = 0; i < found.size(); ++i) {
      table[i / columns.size()][i % columns.size() + 1] = newtons_per_metre(found[i].found.at_k.net_stiffness_n_per_m);
    }
    report_.say("Net stiffness there:");
    report_.table(head, table);
  }

  /// Both ends of every factor at once: how many of them are stable at what the scene states, and how stiff they may
  /// be.
  void corners(const std::vector<const Press*>& presses) {
    const Axis ends = rates({250, 4000});
    Axis hard = hands();
    hard.erase(hard.begin());
    std::vector<Point> all;
    for (const Press* press : presses) {
      for (Point& p : points(*press, {couplings(), {law("potential"), law("none")}, ends, delays({0, 10}), hard})) {
        all.push_back(std::move(p));
      }
    }
    const auto found = search(all, contact_stiffness);
    std::vector<Report::Row> table;
    for (const Level& level : couplings()) {
      Report::Row row{level.name};
      for (const char* law : {"potential", "none"}) {
        std::vector<double> k;
        std::size_t none = 0;
        for (std::size_t i = 0; i < all.size(); ++i) {
          const bool here = all[i].name.find(", " + level.name + ", " + law + ",") != std::string::npos;
          if (!here) continue;
          k.push_back(found[i].found.k);
          none += found[i].found.k == 0 ? 1 : 0;
        }
        std::sort(k.begin(), k.end());
        row.push_back(std::to_string(k.size() - none) + " of " + std::to_string(k.size()));
        row.push_back(newtons_per_metre(k.front()));
        row.push_back(newtons_per_metre(k[k.size() / 2]));
        row.push_back(newtons_per_metre(k.back()));
      }
      table.push_back(std::move(row));
    }
    report_.say("Corners: " + std::to_string(all.size()) +
                " points, both ends of rate, delay (0, 10 ticks) and hand (" + "soft, stiff, absent) at once, " +
                std::to_string(presses.size()) + " scenes. Stable at any k; least, median, largest contact stiffness:");
    report_.table({"mode, coupling", "potential", "least", "median", "largest", "none", "least", "median", "largest"},
                  table);
  }

  const std::vector<StabilityResult>& all() const { return all_; }

 private:
  const double ratio_;
  Report& report_;
  std::vector<StabilityResult> all_;
};

}  // namespace

void bench_stability(const Effort& effort, Report& report) {
  report.say("Largest stable stiffness, N/m, to " + std::string(effort.quick ? "50" : "10") +
             " %, in lockstep. Unless said: law potential, 1 kHz, every reply one tick late, pseudo-admittance, "
             "dynamic, implicit, usual hand, undamped contact, F_max 10 N. One or two factors at a time about that, "
             "then the corners.");
  Comparison comparison(effort, report);

  std::vector<Press> presses;
  for (const char* name : {"flat-10", "flat-30", "flat-100", "flat-300", "flat-1000", "ball", "wires"}) {
    if (!effort.quick || std::string(name) == "flat-10" || std::string(name) == "flat-100") {
      presses.push_back(make_press(name));
    }
  }
  for (const char* name : {"peg", "wedge", "peg-round", "two-walls"}) {
    if (!effort.quick || std::string(name) == "peg") presses.push_back(make_press(name, "press"));
  }
  if (!effort.quick) presses.push_back(make_press("cone", "insert"));
  const auto of_name = [&](const char* name) -> const Press& {
    return *std::find_if(presses.begin(), presses.end(), [&](const Press& p) { return p.name == name; });
  };
  const Press &flat = of_name("flat-100"), &peg = of_name("peg press");
  const std::vector<const Press*> both = effort.quick ? std::vector{&flat} : std::vector{&flat, &peg};
  const auto of_both = [&](const std::vector<Axis>& axes) {
    std::vector<Point> rows;
    for (const Press* press : both) {
      for (Point& p : points(*press, axes)) rows.push_back(std::move(p));
    }
    return rows;
  };

  std::vector<Point> cases;
  for (const Press& press : presses) {
    for (Point& p : points(press, effort.quick ? std::vector<Axis>{} : std::vector<Axis>{dampings()}))
      cases.push_back(std::move(p));
  }
  comparison.table("Contact stiffness k by hard case and law:", "scene", cases, laws(), contact_stiffness, true);
  comparison.table("Contact stiffness k by rate and extra delay in ticks:", "scene, law, rate",
                   of_both({{law("potential"), law("none")}, rates(effort)}), delays(effort), contact_stiffness);
  comparison.table("Contact stiffness k by coupling and law:", "scene, mode, coupling", of_both({couplings()}), laws(),
                   contact_stiffness);
  comparison.table("Contact stiffness k by coupling and hand:", "scene, mode, coupling", of_both({couplings()}),
                   hands(), contact_stiffness);
  comparison.table("Contact stiffness k by coupling and rate:", "scene, mode, coupling", of_both({couplings()}),
                   rates(effort), contact_stiffness);
  comparison.table("Contact stiffness k by coupling and extra delay:", "scene, mode, coupling", of_both({couplings()}),
                   delays(effort), contact_stiffness);

  const auto sprung = points(flat, {sprung_couplings()});
  comparison.table("Coupling stiffness by coupling and rate (k as the scene states):", "scene, mode, coupling", sprung,
                   rates(effort), coupling_stiffness);
  comparison.table("Coupling stiffness by coupling and extra delay:", "scene, mode, coupling", sprung, delays(effort),
                   coupling_stiffness);
  if (!effort.quick) {
    comparison.table("Coupling stiffness by coupling and hand:", "scene, mode, coupling", sprung, hands(),
                     coupling_stiffness);
    comparison.table("Coupling stiffness by coupling and law:", "scene, mode, coupling", of_both({sprung_couplings()}),
                     laws(), coupling_stiffness);
  }
  if (!effort.quick) comparison.corners(both);

  draw(comparison.all(), report);
  if (!report.draws()) return;
  const auto csv = report.folder() / "stability.csv";
  write_csv(comparison.all(), csv);
  report.say("  written: " + csv.string());
}

}  // namespace tact::bench
