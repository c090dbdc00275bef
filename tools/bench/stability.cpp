// How stiff contact and coupling may be before a press no longer rests: by law, coupling, device mode, rate, delay.
#include <tbb/parallel_for.h>

#include <functional>

#include "bench/benchmarks.hpp"
#include "bench/presses.hpp"
#include "contact/stiffness/law.hpp"

namespace tact::bench {
namespace {

using lockstep::Experiment;

/// One value of one axis of the comparison. A new coupling or hand is one more line in these lists.
struct Option {
  std::string name;
  std::function<void(Experiment&)> apply;
};
using Axis = std::vector<Option>;

Axis laws() {
  Axis axis;
  for (const std::string_view law : contact::law_names()) {
    axis.push_back({std::string(law), [law](Experiment& s) { s.session.scene.contact.law = law; }});
  }
  return axis;
}

/// In lockstep a reply is a tick old also for direct coupling in impedance, which waits for it in a session.
Axis couplings() {
  const auto use = [](const char* kind, const char* integrator) {
    return [kind, integrator](Experiment& s) {
      s.session.scene.coupling.kind = kind;
      s.session.scene.coupling.integrator = integrator;
    };
  };
  return {{"dynamic, implicit", use("dynamic", "implicit")},
          {"dynamic, semi-implicit", use("dynamic", "semi-implicit")},
          {"static", use("static", "auto")},
          {"direct", use("direct", "auto")}};
}

Axis modes() {
  Axis axis;
  for (const char* mode : {"pseudo-admittance", "impedance"}) {
    axis.push_back({mode, [mode](Experiment& s) { s.session.machine.mode = mode; }});
  }
  return axis;
}

/// Absent: nobody's arm, only a weight of 8 N on the handle: neither stiffness nor damping of a hand.
Axis hands() {
  const auto use = [](double stiffness, double damping, double tissue, double mass, double force) {
    return [=](Experiment& s) {
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
      s.hand = hand;
    };
  };
  return {{"usual", [](Experiment&) {}},
          {"soft", use(400, 10, 2, 0.3, 20)},
          {"stiff", use(3000, 120, 10, 1.0, 40)},
          {"absent", use(2000, 0, 0, 0.01, 8)}};
}

Axis rates(const Effort& effort) {
  Axis axis;
  for (const int hz : {250, 500, 1000, 2000, 4000}) {
    if (effort.quick && hz != 500 && hz != 1000 && hz != 2000) continue;
    axis.push_back({std::to_string(hz) + " Hz", [hz](Experiment& s) { s.session.machine.rate_hz = hz; }});
  }
  return axis;
}

Axis delays(const Effort& effort) {
  Axis axis;
  for (const int ticks : {0, 1, 2, 3, 5, 10}) {
    if (effort.quick && ticks != 0 && ticks != 1 && ticks != 3) continue;
    axis.push_back({"+" + std::to_string(ticks), [ticks](Experiment& s) { s.delay_ticks = ticks; }});
  }
  return axis;
}

Axis dampings() {
  Axis axis;
  for (const double ratio : {0.0, 0.1}) {
    axis.push_back({ratio == 0 ? "undamped" : "damped",
                    [ratio](Experiment& s) { s.session.scene.contact.damping_ratio = ratio; }});
  }
  return axis;
}

Option law(const std::string& name) {
  return {name, [name](Experiment& s) { s.session.scene.contact.law = name; }};
}

/// Rows by columns of one quantity, each cell a search of its own, on all cores.
class Grid {
 public:
  using Cell = std::function<std::string(const Experiment&)>;

  void row(const std::string& name, const Experiment& setup) { rows_.push_back({name, setup}); }
  void fill(Report& report, const std::string& corner, const Axis& columns, const Cell& cell) const {
    std::vector<Report::Row> table;
    for (const auto& [name, setup] : rows_) table.push_back(Report::Row(columns.size() + 1, name));
    const std::size_t width = columns.size();
    tbb::parallel_for(std::size_t{0}, rows_.size() * width, [&](std::size_t i) {
      Experiment setup = rows_[i / width].second;
      columns[i % width].apply(setup);
      table[i / width][i % width + 1] = cell(setup);
    });
    Report::Row head{corner};
    for (const Option& column : columns) head.push_back(column.name);
    report.table(head, table);
  }

 private:
  std::vector<std::pair<std::string, Experiment>> rows_;
};

/// All combinations of the axes, named by them.
void rows(Grid& grid, const Press& press, const std::vector<Axis>& axes) {
  std::vector<std::pair<std::string, Experiment>> all{{press.name, press.setup}};
  for (const Axis& axis : axes) {
    std::vector<std::pair<std::string, Experiment>> longer;
    for (const auto& [name, setup] : all) {
      for (const Option& option : axis) {
        Experiment changed = setup;
        option.apply(changed);
        longer.emplace_back(name + ", " + option.name, std::move(changed));
      }
    }
    all = std::move(longer);
  }
  for (auto& [name, setup] : all) grid.row(name, setup);
}

std::string coupling_stiffness(const Experiment& setup, double ratio) {
  constexpr double kMost = 1e5;  // of the key coupling.stiffness_n_per_m
  lockstep::Verdict last;
  const double k = lockstep::largest_stable(
      [&](double k_vc) {
        Experiment changed = setup;
        changed.session.scene.coupling.stiffness_n_per_m = k_vc;
        const lockstep::Verdict verdict = press(changed);
        if (!verdict.stable()) last = verdict;
        return verdict.stable();
      },
      setup.session.scene.coupling.stiffness_n_per_m, kMost, ratio);
  if (k == 0) return std::string("none (") + name(last.why) + ")";
  return (k >= kMost ? "> " : "") + newtons_per_metre(k);
}

/// [P] fig. 2: a square peg on one face, 178 contacts.
void fig_2(Report& report, const Press& peg, double ratio) {
  const auto axis = laws();
  std::vector<StableStiffness> found(axis.size());
  tbb::parallel_for(std::size_t{0}, axis.size(), [&](std::size_t i) {
    Experiment setup = peg.setup;
    axis[i].apply(setup);
    found[i] = stable_stiffness(setup, ratio);
  });
  std::vector<Report::Row> table;
  for (std::size_t i = 0; i < axis.size(); ++i) {
    table.push_back({axis[i].name, number(found[i].at_k.contacts), text_of(found[i]), number(found[i].k / found[0].k),
                     newtons_per_metre(found[i].at_k.net_stiffness_n_per_m), name(found[i].above.why)});
  }
  report.say("[P] fig. 2, square peg on one face: scaling is said to permit 8 times the stiffness. k by law:");
  report.table({"law", "contacts", "largest k", "of none", "net there", "beyond it"}, table);
}

}  // namespace

void bench_stability(const Effort& effort, Report& report) {
  const double ratio = effort.quick ? 1.5 : 1.1;
  const auto contact_k = [ratio](const Experiment& setup) { return text_of(stable_stiffness(setup, ratio)); };
  const auto coupling_k = [ratio](const Experiment& setup) { return coupling_stiffness(setup, ratio); };
  report.say("Largest stable stiffness, N/m, to " + number(100 * (ratio - 1)) +
             " %, in lockstep. Unless said: 1 kHz, every reply one tick late, pseudo-admittance, implicit, usual hand, "
             "undamped contact, F_max 10 N.");

  std::vector<Press> presses;
  for (const char* name : {"flat-10", "flat-30", "flat-100", "flat-300", "flat-1000", "ball", "wires"}) {
    if (effort.quick && (std::string(name) == "flat-30" || std::string(name) == "flat-300")) continue;
    presses.push_back(make_press(name));
  }
  for (const char* name : {"wedge", "peg", "peg-round", "two-walls"}) presses.push_back(make_press(name, "press"));
  presses.push_back(make_press("cone", "insert"));

  Grid by_law;
  for (const Press& press : presses) effort.quick ? rows(by_law, press, {}) : rows(by_law, press, {dampings()});
  report.say("Contact stiffness k by law:");
  by_law.fill(report, "scene", laws(), contact_k);

  const Press& flat = presses[effort.quick ? 1 : 2];
  const Press& peg =
      *std::find_if(presses.begin(), presses.end(), [](const Press& p) { return p.name == "peg press"; });
  fig_2(report, peg, ratio);

  Grid by_rate;
  for (const Press* press : {&flat, &peg}) {
    if (!effort.quick || press == &flat) rows(by_rate, *press, {{law("potential"), law("none")}, rates(effort)});
  }
  report.say("Contact stiffness k by rate and extra delay in ticks:");
  by_rate.fill(report, "scene, law, rate", delays(effort), contact_k);

  Grid by_coupling;
  rows(by_coupling, flat, {modes(), couplings()});
  if (!effort.quick) rows(by_coupling, peg, {modes(), couplings()});
  report.say("Contact stiffness k by device mode, coupling and hand (law potential):");
  by_coupling.fill(report, "scene, mode, coupling", hands(), contact_k);

  Axis sprung = couplings();
  sprung.pop_back();  // direct has no spring
  Grid coupling_by_rate;
  rows(coupling_by_rate, flat, {modes(), sprung});
  report.say("Coupling stiffness by device mode, coupling and rate (law potential, k as the scene states):");
  coupling_by_rate.fill(report, "scene, mode, coupling", rates(effort), coupling_k);
  Grid coupling_by_delay;
  rows(coupling_by_delay, flat, {modes(), sprung});
  report.say("Coupling stiffness by extra delay:");
  coupling_by_delay.fill(report, "scene, mode, coupling", delays(effort), coupling_k);
  if (!effort.quick) {
    Grid coupling_by_law;
    for (const Press* press : {&flat, &peg}) rows(coupling_by_law, *press, {modes()});
    report.say("Coupling stiffness by law:");
    coupling_by_law.fill(report, "scene, mode", laws(), coupling_k);
  }
}

}  // namespace tact::bench
