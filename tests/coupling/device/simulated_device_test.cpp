#include "coupling/device/simulated_device.hpp"

#include <gtest/gtest.h>

#include "coupling/device/open_device.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

HandMotion line_to(const Vec3& p, double seconds) { return {{0, seconds}, {Pose{}, Pose{p, Quat::Identity()}}}; }

SimulatedDevice device_in(DeviceMode mode, HandMotion motion = {}, double rate_hz = 1000) {
  SimulatedDevice::Params params;
  params.mode = mode;
  params.rate_hz = rate_hz;
  return {params, std::move(motion), Pose{}};
}

TEST(SimulatedHand, FollowsItsScriptAndHoldsTheLastPose) {
  SimulatedDevice device = device_in(DeviceMode::impedance, line_to({0.1, 0, 0.05}, 1.0));
  device.cue({.live = true, .hold = false, .X_WH_target = {}});
  for (int i = 0; i < 3000; ++i) device.write(Wrench{});
  const DeviceReading reading = device.read();
  EXPECT_TRUE(reading.script_done);
  EXPECT_EQ(reading.script_time_s, 1.0);
  EXPECT_LT((reading.X_WH.p - Vec3(0.1, 0, 0.05)).norm(), 1e-5);
  EXPECT_LT(reading.V_WH.linear.norm(), 1e-5);
}

TEST(SimulatedHand, WaitsWhileHapticsAreNotLive) {
  SimulatedDevice device = device_in(DeviceMode::impedance, line_to({0.1, 0, 0}, 1.0));
  for (int i = 0; i < 500; ++i) device.write(Wrench{});
  EXPECT_EQ(device.read().script_time_s, 0);
  EXPECT_LT(device.read().X_WH.p.norm(), 1e-12);
}

TEST(SimulatedHand, PushesAgainstAWallWithItsPeakForceAndNoMore) {
  for (const double wall : {500.0, 5000.0, 20000.0}) {
    SimulatedDevice device = device_in(DeviceMode::impedance, line_to({0, 0, -0.5}, 1.0), 4000);
    device.cue({.live = true, .hold = false, .X_WH_target = {}});
    double peak = 0;
    for (int i = 0; i < 16000; ++i) {
      const DeviceReading reading = device.read();
      const double depth = std::max(0.0, -reading.X_WH.p.z());
      // 35 N are the arm's peak: the wall holds 20.
      device.write(Wrench{{0, 0, depth > 0 ? wall * depth - 20 * reading.V_WH.linear.z() : 0}, Vec3::Zero()});
      if (reading.script_time_s > 0.9) {
        peak = std::max(peak, (device.true_hand_wrench_W().force + 5 * reading.V_WH.linear).norm());
      }
    }
    EXPECT_NEAR(peak, 20, 1e-4);
    EXPECT_NEAR(device.true_hand_wrench_W().force.norm(), 20, 0.01);
    EXPECT_NEAR(-device.read().X_WH.p.z(), 20 / wall, 1e-3 * 20 / wall + 1e-6);
  }
}

TEST(SimulatedHand, AMouseTargetIsApproachedWithoutAJumpAndLettingGoRestsTheHand) {
  SimulatedDevice device = device_in(DeviceMode::impedance);
  device.cue({.live = true, .hold = true, .X_WH_target = {{0.3, 0, 0}, exp_so3({0, 0, 1})}});
  double fastest = 0;
  for (int i = 0; i < 2000; ++i) {
    device.write(Wrench{});
    fastest = std::max(fastest, device.read().V_WH.linear.norm());
  }
  EXPECT_LT(fastest, 1.3);
  EXPECT_LT((device.read().X_WH.p - Vec3(0.3, 0, 0)).norm(), 1e-5);
  // Blocked by a force, then let go: it does not go on pulling.
  device.cue({.live = true, .hold = true, .X_WH_target = {{0.8, 0, 0}, Quat::Identity()}});
  for (int i = 0; i < 3000; ++i) device.write(Wrench{{-15, 0, 0}, Vec3::Zero()});
  EXPECT_NEAR(device.true_hand_wrench_W().force.norm(), 15, 0.1);
  device.cue({.live = true, .hold = false, .X_WH_target = {}});
  for (int i = 0; i < 2000; ++i) device.write(Wrench{});
  EXPECT_LT(device.true_hand_wrench_W().force.norm(), 1e-3);
}

TEST(SimulatedDevice, ReportsTheDriversSpringAsTheHandsWrenchInPseudoAdmittance) {
  SimulatedDevice device = device_in(DeviceMode::pseudo_admittance, line_to({0.1, 0, 0}, 0.5));
  device.cue({.live = true, .hold = false, .X_WH_target = {}});
  for (int i = 0; i < 3000; ++i) device.write(SetPoint{});  // an immovable set-point
  const DeviceReading reading = device.read();
  // 800 N/m of the hand against 2000 N/m of the driver, capped at 20 N.
  EXPECT_NEAR(reading.F_hand_W.force.x(), 20, 1e-3);
  EXPECT_NEAR(reading.X_WH.p.x(), 20 / device.capabilities().spring_n_per_m, 1e-6);
}

TEST(SimulatedDevice, AFreeVirtualBodyFollowsTheHandAtEveryRate) {
  for (const double rate : {250.0, 1000.0, 4000.0}) {
    SimulatedDevice device = device_in(DeviceMode::pseudo_admittance, line_to({0.1, 0, 0}, 0.5), rate);
    device.cue({.live = true, .hold = false, .X_WH_target = {}});
    SetPoint body;
    const double h = 1 / rate;
    for (int i = 0; i < static_cast<int>(3 * rate); ++i) {
      const DeviceReading reading = device.read();
      body.V_W.linear += h / 0.2 * reading.F_hand_W.force;
      body.X_W.p += h * body.V_W.linear;
      device.write(body);
    }
    EXPECT_NEAR(device.read().X_WH.p.x(), 0.1, 1e-5) << rate;
    EXPECT_NEAR(body.X_W.p.x(), 0.1, 1e-5) << rate;
    EXPECT_LT(device.read().F_hand_W.force.norm(), 1e-3) << rate;
  }
}

TEST(SimulatedDevice, PowerOffEndsEveryForceAtOnceInBothModes) {
  for (const DeviceMode mode : {DeviceMode::impedance, DeviceMode::pseudo_admittance}) {
    SimulatedDevice device = device_in(mode);
    device.power_off();
    EXPECT_FALSE(device.read().engaged);
    if (mode == DeviceMode::impedance) {
      device.write(Wrench{{30, 0, 0}, Vec3::Zero()});
    } else {
      device.write(SetPoint{{{0.01, 0, 0}, Quat::Identity()}, {}});
    }
    EXPECT_EQ(device.read().V_WH.linear.norm(), 0);
  }
}

TEST(SimulatedDevice, TheArmsPeakForceBoundsAnyCommand) {
  SimulatedDevice device = device_in(DeviceMode::impedance);
  device.write(Wrench{{1e6, 0, 0}, Vec3::Zero()});
  EXPECT_LT(device.read().V_WH.linear.x(), 35 / 1.2 * 1e-3 * 1.01);
}

TEST(OpenDevice, RefusesWhatIsNotAvailableAndSaysWhatIs) {
  DeviceOptions options;
  options.name = "joystick";
  try {
    open_device(options);
    FAIL() << "opened a joystick";
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("\"simulated\""), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("joystick"), std::string::npos) << e.what();
  }
  options = {};
  options.mode = "admittance";
  EXPECT_THROW(open_device(options), SetupError);
  options.name = "playback";
  EXPECT_THROW(open_device(options), SetupError) << "nothing was recorded";
}

}  // namespace
}  // namespace tact::coupling
