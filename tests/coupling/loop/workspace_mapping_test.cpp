#include "coupling/loop/workspace_mapping.hpp"

#include <gtest/gtest.h>

#include <random>

#include "fault/fault.hpp"
#include "loop/rig.hpp"

namespace tact::coupling {
namespace {

struct Random {
  Vec3 vec(double scale) { return scale * Vec3(normal(engine), normal(engine), normal(engine)); }
  Pose pose() { return {vec(0.2), exp_so3(vec(1))}; }
  std::mt19937 engine{5};
  std::normal_distribution<double> normal;
};

WorkspaceMapping some_mapping(Random& random, double scale) {
  WorkspaceMapping mapping({random.pose(), scale, false}, random.pose());
  DeviceReading reading;
  reading.X_WH = random.pose();
  reading.engaged = true;
  mapping.read(reading);  // the clutch has turned and moved it
  return mapping;
}

TEST(WorkspaceMapping, GoesThereAndBack) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    const WorkspaceMapping mapping = some_mapping(random, 0.1 + i * 0.1);
    const Pose X = random.pose();
    EXPECT_LT(displacement(X, mapping.to_world(mapping.to_device(X))).norm(), 1e-9);
    const Twist V{random.vec(1), random.vec(1)};
    EXPECT_LT((V.vector() - mapping.to_world(mapping.to_device(V)).vector()).norm(), 1e-12);
    const Wrench F{random.vec(1), random.vec(1)};
    EXPECT_LT((F.vector() - mapping.to_world(mapping.to_device(F)).vector()).norm(), 1e-12);
  }
}

TEST(WorkspaceMapping, TwistsAreTheDerivativesOfPoses) {
  Random random;
  const WorkspaceMapping mapping = some_mapping(random, 3);
  const Pose X_BH = random.pose();
  const Twist V_B{random.vec(1), random.vec(1)};
  const double e = 1e-6;
  const Vec6 x = displacement(mapping.to_world(X_BH), mapping.to_world(displaced(X_BH, e * V_B.vector())));
  EXPECT_LT((x / e - mapping.to_world(V_B).vector()).norm(), 1e-5);
}

TEST(WorkspaceMapping, ThePowerAtTheHandIsThatInTheWorldOverTheScaleForEveryMotion) {
  Random random;
  for (const double scale : {0.2, 1.0, 5.0}) {
    const WorkspaceMapping mapping = some_mapping(random, scale);
    for (int i = 0; i < 20; ++i) {
      const Wrench F_W{random.vec(1), random.vec(1)};
      const Twist V_B{random.vec(1), random.vec(1)};
      const double hand = mapping.to_device(F_W).vector().dot(V_B.vector());
      const double world = F_W.vector().dot(mapping.to_world(V_B).vector());
      EXPECT_NEAR(hand, world / scale, 1e-9);
      EXPECT_NEAR(mapping.to_device(F_W).force.norm(), F_W.force.norm(), 1e-12);
    }
  }
}

TEST(WorkspaceMapping, TheHandleBeginsAtTheToolUnlessTheBaseIsPlaced) {
  Random random;
  const Pose X_WB = random.pose(), X_start = random.pose();
  DeviceReading reading;
  reading.X_WH = random.pose();
  reading.engaged = true;
  WorkspaceMapping free({X_WB, 1, false}, X_start), placed({X_WB, 1, true}, X_start);
  EXPECT_LT(displacement(X_start, free.read(reading).X_WH).norm(), 1e-12);
  EXPECT_LT(displacement(X_WB * reading.X_WH, placed.read(reading).X_WH).norm(), 1e-12);
}

TEST(WorkspaceMapping, LetGoMovedElsewhereAndTakenAgainTheHandleGoesOnWhereItWas) {
  Random random;
  for (const bool placed : {false, true}) {
    WorkspaceMapping mapping({random.pose(), 2, placed}, random.pose());
    DeviceReading reading;
    for (int grip = 0; grip < 5; ++grip) {
      reading.X_WH = random.pose();
      reading.V_WH = {random.vec(1), random.vec(1)};
      reading.F_hand_W = {random.vec(1), random.vec(1)};
      reading.engaged = true;
      const Pose X_WH = mapping.read(reading).X_WH;
      reading.engaged = false;
      for (int i = 0; i < 3; ++i) {
        reading.X_WH = random.pose();
        const DeviceReading out = mapping.read(reading);
        EXPECT_EQ(displacement(X_WH, out.X_WH).norm(), 0);
        EXPECT_EQ(out.V_WH.vector().norm(), 0);
        EXPECT_EQ(out.F_hand_W.vector().norm(), 0);
      }
      reading.engaged = true;
      EXPECT_LT(displacement(X_WH, mapping.read(reading).X_WH).norm(), 1e-9);
    }
  }
}

/// The simulated arm with a button: pressed, it moves free of the scene.
class Indexing final : public HapticDevice {
 public:
  Indexing(const SimulatedDevice::Params& params, const HandMotion& motion, const Pose& X)
      : device_(params, motion, X) {}
  const DeviceCapabilities& capabilities() const noexcept override { return device_.capabilities(); }
  rt::Tick wait_tick() noexcept override { return device_.wait_tick(); }
  DeviceReading read() noexcept override {
    DeviceReading reading = device_.read();
    reading.engaged = reading.engaged && !pressed;
    reading.X_WH = elsewhere * reading.X_WH;
    reading.V_WH = {elsewhere.q * reading.V_WH.linear, elsewhere.q * reading.V_WH.angular};
    reading.F_hand_W = {elsewhere.q * reading.F_hand_W.force, elsewhere.q * reading.F_hand_W.torque};
    return reading;
  }
  void write(const Wrench& F) noexcept override {
    sent = F;
    const Quat back = elsewhere.q.conjugate();
    device_.write(pressed ? Wrench{} : Wrench{back * F.force, back * F.torque});
  }
  void write(const SetPoint& X) noexcept override {
    const Quat back = elsewhere.q.conjugate();
    device_.write(SetPoint{elsewhere.inverse() * X.X_W, {back * X.V_W.linear, back * X.V_W.angular}});
  }
  SetPoint last_set_point() const noexcept override { return device_.last_set_point(); }
  void power_off() noexcept override { device_.power_off(); }

  bool pressed = false;
  Pose elsewhere;  ///< where the arm went with the button pressed, beyond what the hand's motion says
  Wrench sent;

 private:
  SimulatedDevice device_;
};

class Clutch : public ::testing::TestWithParam<std::tuple<DeviceMode, CouplingKind>> {};
INSTANTIATE_TEST_SUITE_P(All, Clutch,
                         ::testing::Combine(::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                                            ::testing::Values(CouplingKind::direct, CouplingKind::quasi_static,
                                                              CouplingKind::dynamic)));

TEST_P(Clutch, TheArmIsMovedElsewhereWithNeitherPoseNorWrenchJumping) {
  Rig::Options options;
  std::tie(options.mode, options.parameters.kind) = GetParam();
  options.motion = straight(options.start, {0, 0, -0.02}, 0.5);  // presses on the wall
  Indexing device(Rig::device_of(options), options.motion, Pose{options.start, Quat::Identity()});
  const auto mail = std::make_unique<Mailboxes>();
  CouplingLoop loop(Rig::config_of(options), device, *mail, nullptr);
  HalfSpace wall;
  LoopStatus status;
  std::uint64_t index = 0;
  std::int64_t now = 0;
  const auto tick = [&] {
    loop.step({index++, now, now, 1'000'000, 0});
    now += 1'000'000;
    wall.serve(*mail);
    mail->status.read(status);
  };
  for (int i = 0; i < 3000; ++i) tick();
  ASSERT_TRUE(status.engaged);
  const Pose X_WH = status.X_WH, X_WT = status.X_WT;
  device.pressed = true;
  for (int i = 0; i < 500; ++i) {
    if (i == 100) device.elsewhere = {{0.2, -0.1, 0.3}, exp_so3({0.4, 0.2, -0.6})};
    tick();
    ASSERT_EQ(displacement(X_WH, status.X_WH).norm(), 0);
    ASSERT_LT(displacement(X_WT, status.X_WT).norm(), 1e-4);
    ASSERT_EQ(status.F_coupling_W.force.norm(), 0);
  }
  device.pressed = false;
  Pose X_last = status.X_WH;
  double F_last = 0;
  for (int i = 0; i < 2000; ++i) {
    tick();
    ASSERT_LT((status.X_WH.p - X_last.p).norm(), 0.5e-3) << i;
    const double F = device.sent.force.norm();
    ASSERT_LT(std::abs(F - F_last), 0.5) << i;
    X_last = status.X_WH;
    F_last = F;
  }
  EXPECT_TRUE(status.engaged);
  EXPECT_EQ(status.stats.faults_ever & bit(Fault::not_finite), 0u);
}

TEST(WorkspaceScale, TheSameSceneAtAnotherScaleRestsAtTheSameForceWithTheHandleMovedLess) {
  for (const DeviceMode mode : {DeviceMode::impedance, DeviceMode::pseudo_admittance}) {
    for (const double scale : {0.5, 1.0, 2.0}) {
      Rig::Options options;
      options.mode = mode;
      options.mapping = {{Vec3::Zero(), exp_so3({0.3, -0.5, 1})}, scale, false};
      options.motion = straight(options.start, {0, 0, -0.1}, 0.5);
      Rig rig(options);
      rig.run(3);
      EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 1e-2) << scale;
      EXPECT_NEAR(-rig.status.X_WT.p.z(), 10 / options.k, 1e-5);
      // The handle: where the hand's spring of 800 N/m holds 10 N.
      const double hand = 10.0 / 800;
      const double handle_B = rig.device.read().X_WH.p.dot(options.mapping.X_WB.q.conjugate() * Vec3::UnitZ());
      const double aim_B = -0.1 / scale;
      EXPECT_NEAR(handle_B - aim_B, hand, 1e-3) << scale;
    }
  }
}

}  // namespace
}  // namespace tact::coupling
