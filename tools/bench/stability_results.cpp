#include "bench/stability_results.hpp"

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>

#include "fault/fault.hpp"

namespace tact::bench {
namespace {

using Filter = std::function<bool(const StabilityResult&)>;

bool usual(const StabilityResult& r) { return r.hand == "usual" && r.damping_ratio == 0; }
bool default_coupling(const StabilityResult& r) {
  return r.mode == "pseudo-admittance" && r.coupling == "dynamic" && r.integrator == "implicit";
}
bool default_time(const StabilityResult& r) { return r.rate_hz == 1000 && r.delay_ticks == kDelay_ticks; }

std::string coupling_name(const StabilityResult& r) {
  const std::string integrator = r.integrator == "none" ? "" : ", " + r.integrator;
  return (r.mode == "impedance" ? "imped., " : "pseudo, ") + r.coupling + integrator;
}

/// Curves of one panel: title -> x -> k. Stable nowhere is drawn nowhere.
using Curves = std::map<std::string, std::map<double, double>>;
Curves curves(const std::vector<StabilityResult>& results, const Filter& take,
              const std::function<std::string(const StabilityResult&)>& title,
              const std::function<double(const StabilityResult&)>& x) {
  Curves found;
  for (const StabilityResult& r : results) {
    if (take(r) && r.found.k > 0) found[title(r)][x(r)] = r.found.k;
  }
  return found;
}

Chart chart_of(const std::string& title, const std::string& x_label, const Curves& curves,
               const std::vector<std::string>& x_names = {}) {
  Chart chart{title, x_label, "N/m", false, true, {}, x_names};
  for (const auto& [name, points] : curves) {
    Chart::Line line{name, {}};
    for (const auto& [x, k] : points) line.points.push_back({x, k});
    chart.lines.push_back(line);
  }
  return chart;
}

}  // namespace

StabilityResult result_of(Quantity quantity, const std::string& scene, const std::string& hand,
                          const lockstep::Experiment& setup, const StableStiffness& found, double most) {
  const SceneSpec& spec = setup.session.scene;
  const MachineSpec& machine = setup.session.machine;
  const bool integrates = machine.mode == "pseudo-admittance" || spec.coupling.kind == "dynamic";
  return {quantity,
          scene,
          spec.contact.law,
          machine.mode,
          spec.coupling.kind,
          !integrates                          ? "none"
          : spec.coupling.integrator == "auto" ? "implicit"
                                               : spec.coupling.integrator,
          hand,
          machine.rate_hz,
          spec.contact.damping_ratio,
          setup.delay_ticks,
          found,
          most};
}

void write_csv(const std::vector<StabilityResult>& results, const std::filesystem::path& csv) {
  std::ofstream out(csv);
  out << "quantity,scene,law,damping_ratio,mode,coupling,integrator,rate_hz,delay_ticks,hand,largest_stable_n_per_m,"
         "end_of_search,fails_by,contacts,net_stiffness_n_per_m,depth_m\n";
  for (const StabilityResult& r : results) {
    const bool end = r.found.k >= r.most;
    out << (r.quantity == Quantity::contact ? "contact" : "coupling") << ',' << r.scene << ',' << r.law << ','
        << r.damping_ratio << ',' << r.mode << ',' << r.coupling << ',' << r.integrator << ',' << r.rate_hz << ','
        << r.delay_ticks << ',' << r.hand << ',' << r.found.k << ',' << (end ? 1 : 0) << ','
        << (end ? "" : name((r.found.k == 0 ? r.found.stated : r.found.above).why)) << ',' << r.found.at_k.contacts
        << ',' << r.found.at_k.net_stiffness_n_per_m << ',' << r.found.at_k.depth_m << '\n';
  }
  if (!out.flush()) throw SetupError(csv.string() + ": cannot write here");
}

void draw(const std::vector<StabilityResult>& results, Report& report) {
  std::vector<std::string> scenes;
  const auto by_case = [&](const StabilityResult& r) {
    return r.quantity == Quantity::contact && usual(r) && default_coupling(r) && default_time(r);
  };
  for (const StabilityResult& r : results) {
    if (by_case(r) && std::find(scenes.begin(), scenes.end(), r.scene) == scenes.end()) scenes.push_back(r.scene);
  }
  const auto index_of = [&](const StabilityResult& r) {
    return static_cast<double>(std::find(scenes.begin(), scenes.end(), r.scene) - scenes.begin());
  };
  const auto law_of = [](const StabilityResult& r) { return r.law; };
  const auto delay_of = [](const StabilityResult& r) { return static_cast<double>(r.delay_ticks); };
  const auto flat = [](const StabilityResult& r) { return r.scene == "flat-100" && usual(r); };

  report.chart(chart_of("Largest stable contact stiffness by hard case", "", curves(results, by_case, law_of, index_of),
                        scenes));
  report.chart(chart_of(
      "The same by extra delay, flat-100", "ticks late",
      curves(
          results,
          [&](const StabilityResult& r) { return r.quantity == Quantity::contact && flat(r) && default_coupling(r); },
          [](const StabilityResult& r) { return r.law + ", " + number(r.rate_hz) + " Hz"; }, delay_of)));
  report.chart(chart_of("The same by coupling, flat-100, potential", "ticks late",
                        curves(
                            results,
                            [&](const StabilityResult& r) {
                              return r.quantity == Quantity::contact && flat(r) && r.rate_hz == 1000 &&
                                     r.law == "potential";
                            },
                            coupling_name, delay_of)));
  report.chart(chart_of("Largest stable coupling stiffness, flat-100", "Hz",
                        curves(
                            results,
                            [&](const StabilityResult& r) {
                              return r.quantity == Quantity::coupling && flat(r) && r.delay_ticks == kDelay_ticks &&
                                     r.law == "potential";
                            },
                            coupling_name, [](const StabilityResult& r) { return r.rate_hz; })));
}

}  // namespace tact::bench
