#include "coupling/loop/coupling_strength.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace tact::coupling {
namespace {

constexpr double kTick_s = 1e-3, kForceMax_n = 10;

/// A coupling whose spring and damper are pulled by a given force, along x.
struct Pulled {
  explicit Pulled(bool saturation)
      : strength({.saturation = saturation}, 0.2, 1e-4 * Mat3::Identity(), 0.025, kForceMax_n) {}

  double tick(bool reply, double pull_n) {
    const ContactLinearisation answer;
    wrench.begin_tick(reply ? &answer : nullptr);
    strength.advance(wrench, true, {Vec3(force_n, 0, 0), Vec3::Zero()}, kTick_s);
    force_n = strength.strength() * std::min(pull_n, strength.gains().force_max);
    return force_n;
  }

  WrenchModel wrench;
  CouplingStrength strength;
  double force_n = 0;
};

class Silence : public ::testing::TestWithParam<std::tuple<bool, int>> {};
INSTANTIATE_TEST_SUITE_P(OfTicks, Silence,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(6, 7, 10, 15, 19, 20, 21, 40)),
                         [](const auto& i) {
                           return std::string(std::get<0>(i.param) ? "Saturated" : "Free") +
                                  std::to_string(std::get<1>(i.param));
                         });

// While no reply comes the hand goes on and pulls ten times as hard: whenever the replies return, the force comes back
// no faster than its ramps.
TEST_P(Silence, EndsWithoutABumpWhateverTheHandDidMeanwhile) {
  const auto [saturation, silence] = GetParam();
  Pulled coupling(saturation);
  const double before = 6, after = 60;
  for (int i = 0; i < 1000; ++i) coupling.tick(true, before);
  ASSERT_DOUBLE_EQ(coupling.force_n, before);
  double last = before;
  for (int i = 1; i <= silence; ++i) {
    const double force = coupling.tick(false, i <= 5 ? before : after);
    EXPECT_LE(force, last + 1e-9) << "it only falls, tick " << i;
    last = force;
  }
  const double step = after * kTick_s * (1 / CouplingStrength::kReturn_s + 1 / CouplingStrength::kRise_s);
  for (int i = 0; i < 3000; ++i) {
    const double force = coupling.tick(true, after);
    EXPECT_LE(force, last + step) << i << " ticks after the return";
    EXPECT_GE(force, last - 1e-9);
    last = force;
  }
  EXPECT_DOUBLE_EQ(last, saturation ? kForceMax_n : after) << "and comes back whole";
}

TEST(CouplingStrength, SwitchingTheSaturationOffUnderAHardPullMakesNoBump) {
  Pulled coupling(true);
  for (int i = 0; i < 1000; ++i) coupling.tick(true, 60);
  ASSERT_DOUBLE_EQ(coupling.force_n, kForceMax_n);
  coupling.strength.set({.saturation = false});
  double last = coupling.force_n;
  for (int i = 0; i < 1000; ++i) {
    const double force = coupling.tick(true, 60);
    EXPECT_LE(force, last + 60 * kTick_s / CouplingStrength::kRise_s);
    last = force;
  }
  EXPECT_DOUBLE_EQ(last, 60);
}

}  // namespace
}  // namespace tact::coupling
