#include "coupling/safety/passivity_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>

#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kH = 1e-3;

PassivityController controller(bool on) {
  PassivityController passivity({.rho_m = 0.03, .brake_max_n_s_per_m = 100});
  passivity.enable(on);
  return passivity;
}

/// A handle of 1 kg thrown against a spring wall whose force comes `delay` ticks late: an active environment.
struct DelayedWall {
  double energy_max_j = -1e9, speed_at_end = 0, position_max_m = 0;
  PassivityController passivity;

  DelayedWall(bool on, int delay, double seconds) : passivity(controller(on)) {
    const double k = 1000, mass = 1;
    double x = 0.005, v = -0.1;
    std::deque<double> late(static_cast<std::size_t>(delay), 0.0);
    Wrench sent;
    for (int i = 0; i < seconds / kH; ++i) {
      late.push_back(x < 0 ? -k * x : 0);
      const Wrench F{{late.front(), 0, 0}, Vec3::Zero()};
      late.pop_front();
      sent = passivity.braked(F, {{v, 0, 0}, Vec3::Zero()}, kH);
      const double dx = kH * v + 0.5 * kH * kH * sent.force.x() / mass;  // exactly, under a held force
      v += kH * sent.force.x() / mass;
      x += dx;
      passivity.observe(sent.force.x() * dx);
      energy_max_j = std::max(energy_max_j, passivity.energy_j());
      position_max_m = std::max(position_max_m, std::abs(x));
    }
    speed_at_end = std::abs(v);
  }
};

TEST(PassivityController, ADelayedWallGivesEnergyWithoutItAndBarelyAnyWithIt) {
  const double thrown_j = 0.5 * 1 * 0.1 * 0.1;
  const DelayedWall off(false, 8, 0.4), on(true, 8, 0.4);
  EXPECT_GT(off.energy_max_j, 0.3 * thrown_j);
  EXPECT_EQ(off.passivity.activity().ticks, 0u);
  EXPECT_EQ(off.passivity.activity().dissipated_j, 0);
  EXPECT_LT(on.energy_max_j, 0.1 * thrown_j);
  EXPECT_LE(on.passivity.energy_j(), on.energy_max_j);
  EXPECT_LE(on.speed_at_end, 0.1 * 1.001);
  EXPECT_GT(on.passivity.activity().ticks, 0u);
  EXPECT_GT(on.passivity.activity().dissipated_j, 0.3 * thrown_j);
}

TEST(PassivityController, APassiveWallIsLeftAsItIs) {
  const DelayedWall with_memory(true, 0, 0.04);  // until it turns back: only credit
  EXPECT_EQ(with_memory.passivity.activity().ticks, 0u);
}

TEST(PassivityController, TheBrakeOpposesTheTwistAndIsBounded) {
  PassivityController passivity = controller(true);
  passivity.observe(1000);
  const Twist V{{0.1, -0.2, 0.3}, {1, 2, -1}};
  const Wrench F = passivity.braked(Wrench{}, V, kH);
  EXPECT_TRUE(F.force.isApprox(-100 * V.linear, 1e-12));
  EXPECT_TRUE(F.torque.isApprox(-100 * 0.03 * 0.03 * V.angular, 1e-12));
  EXPECT_EQ(passivity.braked(Wrench{}, Twist{}, kH).vector().norm(), 0) << "at rest nothing is dissipated";
}

// A set-point that runs along with no regard for the hand that pushes against it: it gives energy.
TEST(PassivityController, ASetPointYieldsToTheHandUntilThePortIsPassive) {
  for (const bool on : {false, true}) {
    PassivityController passivity = controller(on);
    for (int i = 0; i < 500; ++i) {
      const Wrench F_hand{{-3, 0.5, 0}, {0, 0.02, 0}};
      const Vec6 planned = (Vec6() << 2e-5, 0, 0, 0, 1e-4, 0).finished();
      const Vec6 step = planned + passivity.yielding(F_hand, planned);
      passivity.observe(-F_hand.vector().dot(step));
      if (on) {
        ASSERT_LE(passivity.energy_j(), 1e-12);
      }
    }
    if (!on) {
      EXPECT_GT(passivity.energy_j(), 0.025);
    }
    EXPECT_EQ(passivity.activity().ticks, on ? 500u : 0u);
  }
}

TEST(PassivityController, CreditIsSpentBeforeItActs) {
  PassivityController passivity = controller(true);
  passivity.observe(-0.01);
  passivity.observe(0.009);
  EXPECT_EQ(passivity.braked(Wrench{}, {{1, 0, 0}, Vec3::Zero()}, kH).force.norm(), 0);
  passivity.observe(0.002);
  EXPECT_LT(passivity.braked(Wrench{}, {{1, 0, 0}, Vec3::Zero()}, kH).force.x(), 0);
  EXPECT_NEAR(passivity.activity().dissipated_j, 0.001, 1e-12);
}

}  // namespace
}  // namespace tact::coupling
