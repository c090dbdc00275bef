#include "coupling/device/open_device.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "coupling/device/driver_spring.hpp"
#include "coupling/device/simulated_device.hpp"
#include "coupling/device/virtuose/virtuose_device.hpp"
#include "fault/fault.hpp"

namespace tact::coupling {
namespace {

DeviceMode parse_mode(const std::string& mode) {
  for (const DeviceMode m : {DeviceMode::impedance, DeviceMode::pseudo_admittance}) {
    if (mode == name(m)) return m;
  }
  throw SetupError("machine: mode: found \"" + mode + "\", expected \"pseudo-admittance\" or \"impedance\"");
}

/// Smallest moment of the handle body; a needle's counts as 1 % of its largest.
double virtual_inertia(const DeviceOptions& options) {
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(options.virtual_inertia_shape_m2);
  return options.virtual_mass_kg * std::max(eigen.eigenvalues().minCoeff(), 0.01 * eigen.eigenvalues().maxCoeff());
}

SimulatedHand::Grip parse_grip(const std::string& grip) {
  using Grip = SimulatedHand::Grip;
  return grip == "soft" ? Grip::soft : grip == "stiff" ? Grip::stiff : grip == "absent" ? Grip::absent : Grip::normal;
}

std::unique_ptr<HapticDevice> open_simulated(const DeviceOptions& options) {
  SimulatedDevice::Params params;
  params.mode = parse_mode(options.mode);
  params.rate_hz = options.rate_hz;
  params.hand = options.hand;
  const SimulatedSpec& spec = options.simulated;
  params.hand.grip = parse_grip(spec.grip);
  params.hand.tremor_n = spec.tremor_n;
  params.hand.tremor_hz = spec.tremor_hz;
  params.hand.seed = static_cast<std::uint64_t>(spec.seed);
  params.arm.coulomb_n = spec.coulomb_n;
  params.arm.force_continuous_n = std::min(spec.force_continuous_n, params.arm.force_peak_n);
  params.arm.thermal_s = spec.thermal_s;
  params.arm.workspace_m = spec.workspace_m;
  params.quantum_m = spec.quantum_m;
  params.quantum_rad = spec.quantum_rad;
  params.delay_ticks = spec.delay_ticks;
  if (!spec.events.empty()) params.events = load_device_events(spec.events);
  params.virtual_mass_kg = options.virtual_mass_kg;
  params.virtual_inertia_kg_m2 = virtual_inertia(options);
  return std::make_unique<SimulatedDevice>(params, options.hand_motion, options.X_WH_start);
}

virtuose::IndexingMode parse_indexing(const std::string& indexing) {
  if (indexing == "translation") return virtuose::index_translation;
  if (indexing == "rotation") return virtuose::index_rotation;
  return indexing == "none" ? virtuose::index_none : virtuose::index_all;
}

/// What is not stated is chosen by rule; a stated spring has the rule's damping ratio unless that is stated too.
DriverSpring stated_spring(const VirtuoseSpec& spec, DriverSpring spring) {
  const auto state = [](double stiffness, double damping, double& k, double& b) {
    if (stiffness > 0) {
      b *= std::sqrt(stiffness / k);
      k = stiffness;
    }
    if (damping > 0) b = damping;
  };
  state(spec.spring_n_per_m, spec.damper_n_s_per_m, spring.n_per_m, spring.n_s_per_m);
  state(spec.spring_nm_per_rad, spec.damper_nm_s_per_rad, spring.nm_per_rad, spring.nm_s_per_rad);
  return spring;
}

std::unique_ptr<HapticDevice> open_virtuose(const DeviceOptions& options) {
  const VirtuoseSpec& spec = options.virtuose;
  virtuose::VirtuoseDevice::Params params;
  params.stale_after_s = spec.stale_after_s;
  params.check_only = options.check_only;
  virtuose::Settings& s = params.settings;
  s.address = spec.address;
  s.mode = parse_mode(options.mode);
  s.rate_hz = options.rate_hz;
  s.timeout_s = spec.timeout_s;
  s.force_factor = spec.force_factor;
  s.speed_factor = spec.speed_factor;
  s.indexing = parse_indexing(spec.indexing);
  s.spring = stated_spring(spec, driver_spring(options.rate_hz, options.virtual_mass_kg, virtual_inertia(options)));
  s.force_limit_n = options.force_limit_n;
  s.torque_limit_nm = options.torque_limit_nm;
  return std::make_unique<virtuose::VirtuoseDevice>(virtuose::load_library(spec.library), params);
}

}  // namespace

const char* name(DeviceMode mode) noexcept { return mode == DeviceMode::impedance ? "impedance" : "pseudo-admittance"; }

std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options) {
  if (options.name == "simulated") return open_simulated(options);
  if (options.name == "virtuose") return open_virtuose(options);
  if (options.name == "playback") {
    if (options.playback.empty()) throw SetupError("machine: device: \"playback\" needs a recording with a tick in it");
    return std::make_unique<PlaybackDevice>(options.recorded, options.rate_hz, options.playback);
  }
  throw SetupError("machine: device: found \"" + options.name +
                   "\", expected \"simulated\", \"playback\" or \"virtuose\"");
}

}  // namespace tact::coupling
