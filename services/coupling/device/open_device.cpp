#include "coupling/device/open_device.hpp"

#include <Eigen/Eigenvalues>

#include "coupling/device/simulated_device.hpp"
#include "fault/fault.hpp"

namespace tact::coupling {
namespace {

DeviceMode parse_mode(const std::string& mode) {
  for (const DeviceMode m : {DeviceMode::impedance, DeviceMode::pseudo_admittance}) {
    if (mode == name(m)) return m;
  }
  throw SetupError("machine: mode: found \"" + mode + "\", expected \"pseudo-admittance\" or \"impedance\"");
}

std::unique_ptr<HapticDevice> open_simulated(const DeviceOptions& options) {
  SimulatedDevice::Params params;
  params.mode = parse_mode(options.mode);
  params.rate_hz = options.rate_hz;
  params.hand = options.hand;
  params.virtual_mass_kg = options.virtual_mass_kg;
  const Eigen::SelfAdjointEigenSolver<Mat3> eigen(options.virtual_inertia_shape_m2);
  params.virtual_inertia_kg_m2 =
      options.virtual_mass_kg * std::max(eigen.eigenvalues().minCoeff(), 0.01 * eigen.eigenvalues().maxCoeff());
  HandMotion motion = options.hand_motion;
  const Pose X_MT = options.X_TM.inverse();
  for (Pose& X : motion.X_WM) X = X * X_MT;
  return std::make_unique<SimulatedDevice>(params, std::move(motion), options.X_WH_start);
}

}  // namespace

const char* name(DeviceMode mode) noexcept { return mode == DeviceMode::impedance ? "impedance" : "pseudo-admittance"; }

std::unique_ptr<HapticDevice> open_device(const DeviceOptions& options) {
  if (options.name == "simulated") return open_simulated(options);
  if (options.name == "playback" || options.name == "virtuose") {
    throw SetupError("machine: device: \"" + options.name +
                     "\" is not available in this version; available: \"simulated\"");
  }
  throw SetupError("machine: device: found \"" + options.name + "\", expected \"simulated\"");
}

}  // namespace tact::coupling
