#include <gtest/gtest.h>

#include "loop/rig.hpp"

namespace tact::coupling {
namespace {

/// A wall that pushes harder when it is left than when it is entered, with nothing between it and the hand: it gives
/// energy at every touch. (A spring wall with late replies is no such thing here: replies are extrapolated by G.)
Rig::Options active(DeviceMode mode, bool controlled) {
  Rig::Options options;
  options.mode = mode;
  options.parameters.kind = CouplingKind::direct;
  options.parameters.passivity_controller = controlled;
  options.motion = straight(options.start, {0, 0, -0.004}, 0.3);
  options.k = 8000;
  options.b = -100;
  return options;
}

struct Outcome {
  double energy_max_j = -1e9;
  LoopStats stats;
};
Outcome run(const Rig::Options& options) {
  Rig rig(options);
  Outcome outcome;
  for (int i = 0; i < 4000; ++i) {
    rig.tick();
    outcome.energy_max_j = std::max(outcome.energy_max_j, rig.status.stats.port_energy_j);
  }
  outcome.stats = rig.status.stats;
  return outcome;
}

class Passivity : public ::testing::TestWithParam<DeviceMode> {};
INSTANTIATE_TEST_SUITE_P(BothModes, Passivity, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance));

TEST_P(Passivity, TheControllerBoundsTheEnergyAnActiveEnvironmentGivesAndIsOffUnlessAskedFor) {
  const Outcome off = run(active(GetParam(), false)), on = run(active(GetParam(), true));
  std::printf("energy out of the port: off %.3f J, on %.3f J (%.3f J dissipated in %d ticks)\n", off.energy_max_j,
              on.energy_max_j, on.stats.passivity_dissipated_j, static_cast<int>(on.stats.passivity_ticks));
  EXPECT_FALSE(LoopParameters{}.passivity_controller);
  EXPECT_EQ(off.stats.passivity_ticks, 0u);
  EXPECT_GT(off.energy_max_j, 0.02);
  EXPECT_LT(on.energy_max_j, 0.1 * off.energy_max_j);
  EXPECT_GT(on.stats.passivity_ticks, 0u);
  EXPECT_GT(on.stats.passivity_dissipated_j, 0);
}

TEST_P(Passivity, APassiveSceneIsRenderedTheSameWithTheController) {
  Rig::Options options;
  options.mode = GetParam();
  options.motion = straight(options.start, {0, 0, -0.02}, 0.3);
  const Outcome off = run(options);
  options.parameters.passivity_controller = true;
  const Outcome on = run(options);
  EXPECT_LT(off.energy_max_j, 1e-3);
  EXPECT_NEAR(on.stats.port_energy_j, off.stats.port_energy_j, 1e-3);
  EXPECT_LT(on.stats.passivity_dissipated_j, 1e-3);
}

}  // namespace
}  // namespace tact::coupling
