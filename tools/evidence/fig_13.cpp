// [P] fig. 13: is pseudo-admittance more stable than impedance?
#include <tbb/parallel_for.h>

#include <cmath>

#include "bench/presses.hpp"
#include "evidence/experiments.hpp"
#include "evidence/play.hpp"

namespace tact::evidence {

using bench::number;
using bench::Report;

void fig_13(const bench::Effort& effort, Report& report) {
  const double ratio = effort.quick ? 1.5 : 1.1;
  const std::vector<const char*> hands =
      effort.quick ? std::vector<const char*>{"normal"} : std::vector<const char*>{"soft", "normal", "stiff"};
  struct Case {
    std::string scene, step, hand, mode;
    double contact_k = 0, coupling_k = 0;
    std::string contact, coupling;
  };
  std::vector<Case> cases;
  std::vector<lockstep::Experiment> setups;
  for (const char* scene : {"flat-100", "peg"}) {
    const bench::Press press = bench::make_press(scene, std::string(scene) == "peg" ? "press" : "");
    for (const char* step : {"implicit", "semi-implicit"}) {
      for (const char* hand : hands) {
        for (const char* mode : {"impedance", "pseudo-admittance"}) {
          lockstep::Experiment setup = press.setup;
          setup.session.scene.coupling.integrator = step;
          setup.session.machine.mode = mode;
          setup.session.machine.simulated.grip = hand;
          setups.push_back(setup);
          cases.push_back({scene, step, hand, mode, 0, 0, {}, {}});
        }
      }
    }
  }
  constexpr double kMost = 1e5;  // of coupling.stiffness_n_per_m
  tbb::parallel_for(std::size_t{0}, 2 * cases.size(), [&](std::size_t at) {
    const std::size_t i = at / 2;
    if (at % 2 == 0) {
      const auto found = bench::stable_stiffness(setups[i], ratio);
      cases[i].contact_k = found.k;
      cases[i].contact = bench::text_of(found);
      return;
    }
    cases[i].coupling_k = lockstep::largest_stable(
        [&](double k) {
          lockstep::Experiment setup = setups[i];
          setup.session.scene.coupling.stiffness_n_per_m = k;
          return lockstep::press(setup).stable();
        },
        2000, kMost, ratio);
    cases[i].coupling = cases[i].coupling_k == 0 ? std::string("none")
                                                 : (cases[i].coupling_k >= kMost ? "> " : "") +
                                                       bench::newtons_per_metre(cases[i].coupling_k);
  });
  std::vector<Report::Row> rows;
  int better = 0, worse = 0, contact_better = 0, contact_worse = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    rows.push_back({cases[i].scene, cases[i].step, cases[i].hand, cases[i].mode, cases[i].contact, cases[i].coupling});
    if (i % 2 == 0) continue;
    better += cases[i].coupling_k > 1.2 * cases[i - 1].coupling_k ? 1 : 0;
    worse += cases[i].coupling_k < cases[i - 1].coupling_k / 1.2 ? 1 : 0;
    contact_better += cases[i].contact_k > 1.2 * cases[i - 1].contact_k ? 1 : 0;
    contact_worse += cases[i].contact_k < cases[i - 1].contact_k / 1.2 ? 1 : 0;
  }
  report.say(
      "Law potential, 1 kHz, replies a tick late: the largest stable stiffness of contact and of coupling; the "
      "searches end at 50 MN/m and 100 kN/m.");
  report.table({"scene", "step", "hand", "device mode", "contact k, N/m", "coupling k, N/m"}, rows);
  const int all = static_cast<int>(cases.size() / 2);
  report.claim(
      "the device is more stable in pseudo-admittance, because the driver's own virtual coupling limits what is felt",
      "pseudo-admittance bears the stiffer coupling in " + std::to_string(better) + " of " + std::to_string(all) +
          " cases, impedance in " + std::to_string(worse) + "; the stiffer contact in " +
          std::to_string(contact_better) + ", impedance in " + std::to_string(contact_worse),
      better + contact_better <= worse + contact_worse ? bench::Holds::no
      : worse + contact_worse == 0                     ? bench::Holds::yes
                                                       : bench::Holds::partly,
      "On a simulated arm, whose driver runs an inner coupling at four times the rate with gains we chose: a "
      "statement on those gains more than on Haption's.");
}

}  // namespace tact::evidence
