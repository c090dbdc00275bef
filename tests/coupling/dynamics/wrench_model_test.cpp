#include "coupling/dynamics/wrench_model.hpp"

#include <gtest/gtest.h>

namespace tact::coupling {
namespace {

ContactLinearisation push() {
  ContactLinearisation reply;
  reply.F_W = {{0, 0, 8}, {0.1, 0, 0}};
  reply.G = -1000 * Mat6::Identity();
  reply.K = 1000 * Mat6::Identity();
  return reply;
}

Pose moved(double z) { return {{0, 0, z}, Quat::Identity()}; }

TEST(WrenchModel, WaitsWithoutForceForTheFirstReply) {
  WrenchModel model;
  model.begin_tick(nullptr);
  EXPECT_EQ(model.phase(), WrenchModel::Phase::waiting);
  EXPECT_EQ(model.strength(), 0);
  EXPECT_EQ(model.at(Pose{}).F_W.force.norm(), 0);
}

TEST(WrenchModel, ExtrapolatesWithTheGradientAlsoAReplyThatIsFresh) {
  WrenchModel model;
  const auto reply = push();
  model.begin_tick(&reply);
  EXPECT_NEAR(model.at(moved(0.001)).F_W.force.z(), 7, 1e-12);
  EXPECT_NEAR(model.at(moved(-0.001)).F_W.force.z(), 9, 1e-12);
  EXPECT_EQ(model.phase(), WrenchModel::Phase::fresh);
}

TEST(WrenchModel, NeverReversesTheLastFreshForceOrTorque) {
  WrenchModel model;
  const auto reply = push();
  model.begin_tick(&reply);
  const ContactLoad load = model.at({{0.001, 0, 0.1}, exp_so3({0.01, 0, 0})});
  EXPECT_NEAR(load.F_W.force.z(), 0, 1e-12);
  EXPECT_NEAR(load.F_W.force.x(), -1, 1e-12);  // sideways is untouched
  EXPECT_NEAR(load.F_W.torque.x(), 0, 1e-12);
}

TEST(WrenchModel, MeetsTheStepWithKAndForEachTickSinceThePoseAnsweredWhatKHasBeenLately) {
  WrenchModel model;
  const auto reply = [&](double k) {
    ContactLinearisation linear;
    linear.K = k * Mat6::Identity();
    model.begin_tick(&linear);
  };
  const auto met = [&](std::uint64_t behind) { return model.at(Pose{}, behind).K(0, 0); };
  reply(100);
  EXPECT_EQ(met(0), 100 + 100);
  EXPECT_EQ(met(3), 100 + 4 * 100);
  reply(10);
  EXPECT_EQ(met(0), 10 + (10 + 50));
  EXPECT_EQ(met(1), 10 + 2 * (10 + 50));
  reply(0);  // in the open
  EXPECT_EQ(met(5), 0);
  reply(40);
  EXPECT_EQ(met(0), 40 + 40);
}

TEST(WrenchModel, FiveTicksAtFullStrengthThenALinearFadeThenZeroAtTwenty) {
  WrenchModel model;
  const auto reply = push();
  model.begin_tick(&reply);
  for (std::uint32_t age = 1; age <= 30; ++age) {
    model.begin_tick(nullptr);
    const ContactLoad load = model.at(moved(-0.0001 * age), age);
    if (age <= 5) {
      EXPECT_EQ(model.phase(), WrenchModel::Phase::late);
      EXPECT_NEAR(load.F_W.force.z(), 8 + 0.1 * age, 1e-12);
      EXPECT_EQ(load.K(0, 0), 1000 + (1 + age) * 1000);
    } else if (age < 20) {
      EXPECT_EQ(model.phase(), WrenchModel::Phase::fading);
      EXPECT_NEAR(load.F_W.force.z(), 8.5 * (20.0 - age) / 15.0, 1e-12);  // held, scaled
      EXPECT_NEAR(load.K(0, 0), (1000 + (1 + age) * 1000) * (20.0 - age) / 15.0, 1e-8);
    } else {
      EXPECT_EQ(model.phase(), WrenchModel::Phase::stale);
      EXPECT_EQ(load.F_W.force.norm(), 0);
      EXPECT_EQ(load.K.norm(), 0);
    }
  }
}

TEST(WrenchModel, TheFadeNeverGrowsWhateverTheToolDoes) {
  WrenchModel model;
  const auto reply = push();
  model.begin_tick(&reply);
  double last = 1e9;
  for (std::uint32_t age = 1; age < 25; ++age) {
    model.begin_tick(nullptr);
    const double force = model.at(moved(age % 2 ? -0.05 : 0.05)).F_W.force.norm();
    if (age > 6) {
      EXPECT_LE(force, last);
    }
    last = force;
  }
}

TEST(WrenchModel, AReplyAfterSilenceIsUsedAtOnce) {
  WrenchModel model;
  const auto reply = push();
  for (int i = 0; i < 50; ++i) model.begin_tick(nullptr);
  model.begin_tick(&reply);
  EXPECT_EQ(model.strength(), 1);
  EXPECT_NEAR(model.at(Pose{}).F_W.force.z(), 8, 1e-12);
}

}  // namespace
}  // namespace tact::coupling
