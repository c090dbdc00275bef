// What a simulated arm and hand have beyond the perfect: each against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "coupling/device/simulated_device.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kRate = 1000;

SimulatedDevice::Params params_in(DeviceMode mode = DeviceMode::impedance) {
  SimulatedDevice::Params params;
  params.mode = mode;
  params.rate_hz = kRate;
  return params;
}

SimulatedDevice::Params let_go() {
  SimulatedDevice::Params params = params_in();
  params.hand.grip = SimulatedHand::Grip::absent;
  return params;
}

void run(SimulatedDevice& device, double seconds, const Wrench& F = {}) {
  for (int i = 0; i < static_cast<int>(std::lround(seconds * kRate)); ++i) device.write(F);
}

const Wrench kPush{{0, 0, -10}, Vec3::Zero()};

TEST(Tremor, ShakesAtEightToTwelveHertzAndAlikeForOneSeed) {
  SimulatedDevice::Params params = params_in();
  params.hand.tremor_n = 1;
  SimulatedDevice a(params, {}, Pose{}), b(params, {}, Pose{});
  params.hand.seed = 2;
  SimulatedDevice c(params, {}, Pose{});
  std::vector<double> force;
  double apart = 0;
  for (int i = 0; i < 4000; ++i) {
    for (SimulatedDevice* d : {&a, &b, &c}) d->write(Wrench{});
    EXPECT_EQ(a.true_X_WH().p, b.true_X_WH().p);
    apart = std::max(apart, (a.true_X_WH().p - c.true_X_WH().p).norm());
    force.push_back(a.true_X_WH().p.x());
  }
  EXPECT_GT(apart, 1e-5);
  double inside = 0, all = 0;
  for (int f = 1; f < 100; ++f) {  // quarter hertz steps
    std::complex<double> sum;
    for (std::size_t i = 0; i < force.size(); ++i) {
      sum += force[i] * std::polar(1.0, -2 * std::numbers::pi * 0.25 * f * static_cast<double>(i) / kRate);
    }
    all += std::norm(sum);
    if (0.25 * f >= 8 && 0.25 * f <= 12) inside += std::norm(sum);
  }
  EXPECT_GT(inside, 0.9 * all);
  EXPECT_GT(inside, 0);
}

TEST(Grip, ChangesTheHandsStiffnessWithoutAJump) {
  for (const auto& [event, stiffness] : {std::pair{DeviceEvent::grip_soft, 200.0}, {DeviceEvent::grip_stiff, 2000.0}}) {
    SimulatedDevice::Params params = params_in();
    params.events = {{1.0, 10.0, event}};
    SimulatedDevice device(params, {}, Pose{});
    device.cue({.live = true, .hold = false, .X_WH_target = {}});
    const Wrench push{{4, 0, 0}, Vec3::Zero()};
    run(device, 1.0, push);
    EXPECT_NEAR(device.true_X_WH().p.x(), 4.0 / 800, 1e-5);
    double fastest = 0;
    for (int i = 0; i < 4000; ++i) {
      device.write(push);
      fastest = std::max(fastest, device.true_V_WH().linear.norm());
    }
    EXPECT_NEAR(device.true_X_WH().p.x(), 4.0 / stiffness, 1e-5);
    EXPECT_LT(fastest, 0.2);
  }
}

TEST(Grip, AnAbsentHandLeavesTheArmToItselfAndTakesHoldWhereItIs) {
  SimulatedDevice::Params params = params_in();
  params.events = {{0.0, 1.0, DeviceEvent::grip_absent}};
  SimulatedDevice device(params, {}, Pose{});
  device.cue({.live = true, .hold = false, .X_WH_target = {}});
  run(device, 1.0, {{0.5, 0, 0}, Vec3::Zero()});
  EXPECT_EQ(device.true_hand_wrench_W().force.norm(), 0);
  const double there = device.true_X_WH().p.x();
  EXPECT_GT(there, 0.05);
  double strongest = 0;
  for (int i = 0; i < 3000; ++i) {
    device.write(Wrench{});
    strongest = std::max(strongest, device.true_hand_wrench_W().force.norm());
  }
  EXPECT_LT(strongest, 30) << "braked, then led back at a person's pace";
}

TEST(Arm, DryFrictionHoldsBelowItsForceAndTakesItAbove) {
  SimulatedDevice::Params params = let_go();
  params.arm.coulomb_n = 2;
  params.arm.friction_n_s_per_m = 0;
  SimulatedDevice device(params, {}, Pose{});
  run(device, 1.0, {{1.99, 0, 0}, Vec3::Zero()});
  EXPECT_EQ(device.true_X_WH().p.norm(), 0);
  run(device, 0.5, {{3.0, 0, 0}, Vec3::Zero()});
  EXPECT_NEAR(device.true_V_WH().linear.x(), 0.5 * (3.0 - 2.0) / 0.8, 1e-3);
  const double speed = device.true_V_WH().linear.x();
  run(device, speed * 0.8 / 2.0 + 0.01);  // v m / F
  EXPECT_EQ(device.true_V_WH().linear.norm(), 0);
}

TEST(Arm, AWorkspaceBorderEndsTheMotionAndHoldsTheForceBack) {
  SimulatedDevice::Params params = let_go();
  params.arm.workspace_m = 0.05;
  SimulatedDevice device(params, {}, Pose{{1, 2, 3}, Quat::Identity()});
  run(device, 2.0, {{5, 5, 0}, Vec3::Zero()});
  EXPECT_NEAR((device.true_X_WH().p - Vec3(1, 2, 3)).norm(), 0.05, 1e-9);
  EXPECT_LT(device.true_V_WH().linear.norm(), 0.05) << "may slide along it, not out of it";
  run(device, 0.05, {{-5, -5, 0}, Vec3::Zero()});
  EXPECT_LT((device.true_X_WH().p - Vec3(1, 2, 3)).norm(), 0.0499) << "inwards it is free";
}

TEST(Arm, TooHotItGivesFourFifthsOfTheContinuousForceAfterTheTimeOfItsThermalModel) {
  SimulatedDevice::Params params = params_in();
  params.hand.force_max_n = 100;
  params.hand.stiffness_n_per_m = 20000;
  params.hand.damping_n_s_per_m = 300;
  params.arm.force_continuous_n = 8;
  params.arm.thermal_s = 2;
  SimulatedDevice device(params, {}, Pose{});
  const Wrench twice{{16, 0, 0}, Vec3::Zero()};
  // q = 4 (1 - exp(-t / 2 s)) reaches 1 at 2 ln(4/3) s.
  const double hot_after = 2 * std::log(4.0 / 3.0);
  run(device, hot_after - 0.01, twice);
  EXPECT_EQ(device.read().faults, 0u);
  EXPECT_NEAR(device.true_hand_wrench_W().force.norm(), 16, 0.1);
  run(device, 0.02, twice);
  EXPECT_EQ(device.read().faults, bit(Fault::device_alarm));
  EXPECT_TRUE(device.read().engaged) << "it still works, with less force";
  double last = device.true_hand_wrench_W().force.norm();
  for (int i = 0; i < 700; ++i) {
    device.write(twice);
    const double now = device.true_hand_wrench_W().force.norm();
    EXPECT_LT(std::abs(now - last), 0.3) << "the limit moves, it does not jump";
    last = now;
  }
  EXPECT_NEAR(last, 0.8 * 8, 0.05);
  run(device, 10);
  EXPECT_EQ(device.read().faults, 0u) << "it cools down";
}

TEST(Encoders, GivePosesInStepsAndATwistThatIsTheirMean) {
  SimulatedDevice::Params params = let_go();
  params.quantum_m = 1e-4;
  params.quantum_rad = 1e-3;
  params.arm.friction_n_s_per_m = 0;
  SimulatedDevice device(params, {}, Pose{});
  run(device, 0.2, {{0.4, 0, 0}, {0, 0, 0.003}});  // to 0.1 m/s and 0.2 rad/s
  double mean = 0;
  for (int i = 0; i < 500; ++i) {
    device.write(Wrench{});
    const DeviceReading reading = device.read();
    const double steps = reading.X_WH.p.x() / 1e-4;
    EXPECT_NEAR(steps, std::round(steps), 1e-6);
    const double turns = log_so3(reading.X_WH.q).z() / 1e-3;
    EXPECT_NEAR(turns, std::round(turns), 1e-6);
    EXPECT_LT((reading.X_WH.p - device.true_X_WH().p).cwiseAbs().maxCoeff(), 0.51e-4);
    mean += reading.V_WH.linear.x() / 500;
  }
  EXPECT_NEAR(mean, device.true_V_WH().linear.x(), 0.01 * mean);
}

TEST(Encoders, ReadingsAreAsOldAsSampledAndSent) {
  SimulatedDevice::Params params = let_go();
  SimulatedDevice now(params, {}, Pose{});
  params.delay_ticks = 5;
  SimulatedDevice late(params, {}, Pose{});
  std::vector<Pose> earlier(6, Pose{});
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(late.read().X_WH.p, earlier[earlier.size() - 6].p) << i;
    now.write(kPush);
    late.write(kPush);
    earlier.push_back(now.read().X_WH);
  }
}

TEST(Indexing, TheArmMovesThePoseStandsAndGoesOnFromThere) {
  SimulatedDevice::Params params = params_in();
  params.events = {{0.5, 0.5, DeviceEvent::indexing}};
  SimulatedDevice device(params, {{0, 1.5}, {Pose{}, Pose{{0.3, 0, 0}, exp_so3({0, 0, 0.6})}}}, Pose{});
  device.cue({.live = true, .hold = false, .X_WH_target = {}});
  DeviceReading last = device.read();
  for (int i = 0; i < 2500; ++i) {
    device.write(Wrench{});
    const DeviceReading reading = device.read();
    EXPECT_LT(displacement(last.X_WH, reading.X_WH).norm(), 2e-3) << i;
    const bool indexing = i >= 501 && i < 999;
    if (indexing) {
      EXPECT_EQ(reading.X_WH.p, last.X_WH.p) << i;
      EXPECT_FALSE(reading.engaged);
    }
    last = reading;
  }
  EXPECT_TRUE(last.engaged);
  EXPECT_NEAR(device.true_X_WH().p.x(), 0.3, 1e-3);
  EXPECT_NEAR(last.X_WH.p.x(), 0.2, 0.02) << "a third of the way was indexed away";
}

}  // namespace
}  // namespace tact::coupling
