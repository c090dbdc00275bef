#pragma once
#include <functional>
#include <string>
#include <vector>

#include "lockstep/press.hpp"

namespace tact::bench {

/// A hard case: a scene, and the piece of its script that presses tool and obstacle together.
struct Press {
  std::string name;
  lockstep::Experiment setup;  ///< shortened; at the common operating point
  lockstep::Experiment whole;  ///< the script as it stands
};

/// Where laws are compared: 1 kHz, every reply a tick later than it could be, pseudo-admittance, F_max = 10 N.
inline constexpr int kDelay_ticks = 1;
inline constexpr double kForceMax_n = 10;
/// Where the search for the largest stable contact stiffness ends, N/m.
inline constexpr double kStiffest = 5e7;

/// Names without a bake: flat-N (N points), ball (no torque), wires (two voxels thick). Others: a scene and its script.
Press make_press(const std::string& scene, const std::string& script = {});

/// The setup at another contact stiffness; F_max stays.
lockstep::Experiment at_stiffness(const lockstep::Experiment& setup, double stiffness_n_per_m);
/// k that the scene states.
double stated_stiffness(const lockstep::Experiment& setup);

/// The largest contact stiffness that is stable (press.hpp), N/m, and how it is at the last one that was.
struct StableStiffness {
  double k = 0;
  lockstep::Verdict at_k;    ///< at the largest stable one
  lockstep::Verdict above;   ///< at the smallest that is not
  lockstep::Verdict stated;  ///< at the first that was tried
};
StableStiffness stable_stiffness(const lockstep::Experiment& setup, double ratio);
/// The same of any stiffness: `press_at` says how it is there.
StableStiffness largest_stable(const std::function<lockstep::Verdict(double)>& press_at, double stated, double most,
                               double ratio);

/// "412k", "> 50M" at the end of the search, "none (lost contact)": what it is like at the stiffness that is stated.
std::string text_of(const StableStiffness& found, double most = kStiffest);
std::string newtons_per_metre(double k);

}  // namespace tact::bench
