#pragma once
#include <functional>

#include "lockstep/lockstep.hpp"

namespace tact::lockstep {

/// Is a session stable when a hand presses the tool against the obstacle, rubs it there and keeps it?
///
/// A press: the hand's motion (half a second), a rub of kRub_s (some millimetres and a degree to and fro about all
/// axes, back to where it began), kSettle_s of rest, then a window of kWindow_s in which we look. Stable:
///   finite     no value that is not finite, in poses, forces or replies
///   bounded    the tool's kinetic energy never above kEnergy_j: 0.2 kg at 0.3 m/s, five times what the hand does
///   held       the tool is in contact in at least half of the window's ticks, and never beyond the field's band
///   quiet      the ripple of the contact wrench is below kRipple_n in the window's second half, or it has fallen
///              to kDecay of that in the first half: no *sustained* oscillation. Ripple: root mean square of the
///              force (of the torque over the radius of gyration, if larger) about its straight-line fit
///   passive    the device port gave out no more than kPort_j since the beginning, and at most a tenth of that within
///              the window
struct Verdict {
  enum class Why { stable, not_finite, energy, lost, oscillates, active };
  Why why = Why::stable;
  double ripple_n = 0;               ///< in the window's second half
  double energy_max_j = 0;           ///< kinetic, of the tool
  double port_energy_j = 0;          ///< at the end
  double net_stiffness_n_per_m = 0;  ///< mean over the window
  double depth_m = 0;                ///< the same
  double contacts = 0;               ///< the same
  double force_step_rms_n = 0;       ///< of the contact force from tick to tick while touching, over the whole press

  bool stable() const { return why == Why::stable; }
};
const char* name(Verdict::Why why);

inline constexpr double kMotion_s = 0.5, kRub_s = 0.6, kSettle_s = 0.5, kWindow_s = 0.5;
inline constexpr double kEnergy_j = 0.01, kRipple_n = 0.1, kDecay = 0.8, kPort_j = 1e-3;

/// @pre setup.motion_WM is the motion that presses
Verdict press(const Experiment& setup);

/// The piece of a hand's motion that presses: from its last pose without contact (or `from_s` > 0), raised by `lift_m`
/// along z, to 30 mm from there (the hand pulls with its whole strength long before) or the end, in kMotion_s. Sets the
/// scene's start as well. Throws SetupError when the motion never touches.
void shorten_to_press(Experiment& setup, double from_s = 0, double lift_m = 0);

/// The largest value below which everything tried was stable, to a factor `ratio`: doubled from `from` while stable
/// (halved while not, down to `from` / 64), then bisected in the logarithm. 0: stable nowhere. `most`: stable up to
/// there, at least.
double largest_stable(const std::function<bool(double)>& stable, double from, double most, double ratio = 1.1);

}  // namespace tact::lockstep
