#pragma once
#include <memory>

#include "coupling/device/playback_device.hpp"
#include "coupling/device/simulated_hand.hpp"
#include "session/session.hpp"

namespace tact::coupling {

struct DeviceOptions {
  std::string name = "simulated";
  std::string mode = "pseudo-admittance";
  double rate_hz = 1000;
  Pose X_WH_start;             ///< where a simulated handle begins
  HandMotion hand_motion;      ///< poses of the handle in the device's frame; empty: none
  SimulatedHand::Params hand;  ///< its grip and tremor are taken from `simulated`
  SimulatedSpec simulated;
  DeviceCapabilities recorded;  ///< playback: the device that was recorded, and what it gave
  std::vector<PlaybackTick> playback;
  double virtual_mass_kg = 0.2;  ///< of the handle body, pseudo-admittance
  Mat3 virtual_inertia_shape_m2 = Mat3::Identity() * 1e-3;
  VirtuoseSpec virtuose;
  double force_limit_n = 30, torque_limit_nm = 3;  ///< the gate's: told to a real arm's controller besides
  bool check_only = false;                         ///< a real arm is opened, its motors stay off
};

/// Opens the device named in the machine file. Throws SetupError for an unknown device or mode, or one that is not
/// available, saying which are.
std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options);

}  // namespace tact::coupling
