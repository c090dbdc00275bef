#include "coupling/safety/gate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <random>

namespace tact::coupling {
namespace {

constexpr double kH = 1e-3;

/// Mostly sane numbers, sometimes anything a broken program or a hostile peer can produce.
class Hostile {
 public:
  double number(double scale) {
    static const std::array kEvil{std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::max(),
                                  -1e300,
                                  5e-324,
                                  0.0};
    if (random_() % 20 == 0) return kEvil[random_() % kEvil.size()];
    return scale * normal_(random_);
  }
  Vec3 vec(double scale) { return {number(scale), number(scale), number(scale)}; }
  Quat quat() {
    if (random_() % 10 == 0) return {number(1), number(1), number(1), number(1)};
    return exp_so3(Vec3(normal_(random_), normal_(random_), normal_(random_)));
  }
  Vec3 sane(double scale) { return scale * Vec3(normal_(random_), normal_(random_), normal_(random_)); }
  bool chance(unsigned percent) { return random_() % 100 < percent; }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<double> normal_;
};

TEST(WrenchGate, WhateverComesInFiniteClampedAndRateLimitedGoesOut) {
  const GateLimits limits;
  WrenchGate gate(limits);
  Hostile hostile;
  Wrench last;
  for (int i = 0; i < 100000; ++i) {
    const bool engaged = hostile.chance(99);
    const Wrench sent = gate.limit({hostile.vec(100), hostile.vec(10)}, engaged, kH);
    ASSERT_TRUE(sent.vector().allFinite());
    ASSERT_LE(sent.force.norm(), limits.force_n * (1 + 1e-12));
    ASSERT_LE(sent.torque.norm(), limits.torque_nm * (1 + 1e-12));
    if (engaged) {
      ASSERT_LE((sent.force - last.force).norm(), limits.force_slope_n_per_s * kH * (1 + 1e-12));
      ASSERT_LE((sent.torque - last.torque).norm(), limits.torque_slope_nm_per_s * kH * (1 + 1e-12));
    } else {
      ASSERT_EQ(sent.vector().norm(), 0);
    }
    last = sent;
  }
}

TEST(WrenchGate, PassesWhatIsWithinTheLimitsUnchanged) {
  WrenchGate gate(GateLimits{});
  const Wrench wanted{{1, 2, 3}, {0.1, 0.2, 0.1}};
  Wrench sent;
  for (int i = 0; i < 600; ++i) sent = gate.limit(wanted, true, kH);
  EXPECT_EQ(sent.vector(), wanted.vector());
  EXPECT_FALSE(gate.report().limited);
  EXPECT_TRUE(gate.ramped());
}

TEST(WrenchGate, RampsUpFromZeroAfterEachEngagement) {
  WrenchGate gate(GateLimits{});
  const Wrench wanted{{100, 0, 0}, Vec3::Zero()};
  for (int round = 0; round < 2; ++round) {
    gate.limit(wanted, false, kH);
    for (int i = 1; i <= 500; ++i) {
      const Wrench sent = gate.limit(wanted, true, kH);
      ASSERT_LE(sent.force.x(), 30 * i * kH / 0.5 + 1e-9);
    }
    EXPECT_NEAR(gate.limit(wanted, true, kH).force.x(), 30, 1e-9);
  }
}

TEST(WrenchGate, NotFiniteCountsAsZeroAndIsReported) {
  WrenchGate gate(GateLimits{});
  for (int i = 0; i < 600; ++i) gate.limit({{10, 0, 0}, Vec3::Zero()}, true, kH);
  const Vec3 nan = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_NEAR(gate.limit({nan, Vec3::Zero()}, true, kH).force.x(), 5, 1e-9);  // on its way down, at the slope
  EXPECT_TRUE(gate.report().not_finite);
  EXPECT_NEAR(gate.limit({nan, Vec3::Zero()}, true, kH).force.x(), 0, 1e-9);
}

TEST(SetPointGate, WhateverComesInTheDriversSpringNeverExceedsTheForceLimit) {
  GateLimits limits;
  limits.spring_n_per_m = 1500;
  limits.spring_nm_per_rad = 4;
  SetPointGate gate(limits);
  Hostile hostile;
  Pose X_WH, last;
  for (int i = 0; i < 100000; ++i) {
    X_WH = displaced(X_WH, (Vec6() << hostile.sane(0.002), hostile.sane(0.01)).finished());
    const bool engaged = hostile.chance(99);
    const Pose wanted =
        hostile.chance(50) ? Pose{hostile.vec(1), hostile.quat()} : Pose{X_WH.p + hostile.vec(0.01), X_WH.q};
    Pose sent;
    Twist V;
    gate.limit(wanted, {hostile.vec(5), hostile.vec(20)}, X_WH, engaged, kH, sent, V);
    ASSERT_TRUE(sent.finite() && V.vector().allFinite());
    ASSERT_NEAR(sent.q.norm(), 1, 1e-9);
    ASSERT_LE(V.linear.norm(), limits.speed_m_per_s * (1 + 1e-9));
    ASSERT_LE(V.angular.norm(), limits.speed_rad_per_s * (1 + 1e-9));
    const Vec6 reach = displacement(X_WH, sent);
    ASSERT_LE(limits.spring_n_per_m * reach.head<3>().norm(), limits.force_n * (1 + 1e-9));
    ASSERT_LE(limits.spring_nm_per_rad * reach.tail<3>().norm(), limits.torque_nm * (1 + 1e-9));
    last = sent;
  }
}

TEST(SetPointGate, AHandleThatLiesCannotPullTheSetPointAwayFromItsLastSanePose) {
  GateLimits limits;
  SetPointGate gate(limits);
  Hostile hostile;
  Pose good;
  for (int i = 0; i < 100000; ++i) {
    const bool lies = hostile.chance(30);
    const Quat q(hostile.number(1), hostile.number(1), hostile.number(1), hostile.number(1));
    const Pose told = lies ? Pose{hostile.vec(0.1), q} : displaced(good, 1e-4 * Vec6::Ones());
    if (told.finite() && told.p.cwiseAbs().maxCoeff() <= 1e6 && std::abs(told.q.norm() - 1) < 1e-3) good = told;
    Pose sent;
    Twist V;
    gate.limit({hostile.vec(1), hostile.quat()}, {hostile.vec(5), hostile.vec(20)}, told, hostile.chance(99), kH, sent,
               V);
    ASSERT_TRUE(sent.finite() && V.vector().allFinite());
    const Vec6 reach = displacement({good.p, good.q.normalized()}, sent);
    ASSERT_LE(limits.spring_n_per_m * reach.head<3>().norm(), limits.force_n * (1 + 1e-6));
    ASSERT_LE(limits.spring_nm_per_rad * reach.tail<3>().norm(), limits.torque_nm * (1 + 1e-6));
  }
}

TEST(SetPointGate, StepsAreLimitedUnlessTheHandleItselfMovesAway) {
  const GateLimits limits;
  SetPointGate gate(limits);
  Hostile hostile;
  Pose last;
  Twist V;
  gate.limit({}, {}, {}, true, kH, last, V);
  for (int i = 0; i < 20000; ++i) {
    Pose sent;
    gate.limit({hostile.vec(0.1), hostile.quat()}, {}, Pose{}, true, kH, sent, V);
    const Vec6 step = displacement(last, sent);
    ASSERT_LE(step.head<3>().norm(), limits.speed_m_per_s * kH * (1 + 1e-9));
    ASSERT_LE(step.tail<3>().norm(), limits.speed_rad_per_s * kH * (1 + 1e-6));
    last = sent;
  }
}

TEST(SetPointGate, ARefusedSetPointStaysWhereItWasAtRest) {
  SetPointGate gate(GateLimits{});
  Pose sent, before;
  Twist V;
  for (int i = 0; i < 600; ++i)
    gate.limit({{0.002, 0, 0}, Quat::Identity()}, {{1, 0, 0}, Vec3::Zero()}, {}, true, kH, before, V);
  EXPECT_EQ(before.p.x(), 0.002);
  gate.limit({{0.002, 0, 0}, Quat(0, 0, 0, 0)}, {{1, 0, 0}, Vec3::Zero()}, {}, true, kH, sent, V);
  EXPECT_TRUE(gate.report().not_finite);
  EXPECT_EQ(sent.p.x(), before.p.x());
  EXPECT_EQ(V.vector().norm(), 0);
}

TEST(SetPointGate, NothingMovesAtStart) {
  SetPointGate gate(GateLimits{});
  const Pose X_WH{{0.3, 0.2, 0.1}, exp_so3({0.1, 0.2, 0.3})};
  Pose sent;
  Twist V;
  gate.limit({}, {{1, 1, 1}, {1, 1, 1}}, X_WH, true, kH, sent, V);
  EXPECT_LT(displacement(X_WH, sent).norm(), 1e-12);
  EXPECT_EQ(V.vector().norm(), 0);
}

TEST(SetPointGate, TheDriversDamperNeverStepsByMoreThanHalfTheSlopeAndFollowsTheRamp) {
  GateLimits limits;
  limits.damper_n_s_per_m = 28;
  limits.damper_nm_s_per_rad = 0.3;
  SetPointGate gate(limits);
  const double h = 1e-3;
  Pose X_sent;
  Twist V_sent, V_last;
  gate.limit({}, {}, {}, true, h, X_sent, V_sent);
  for (int tick = 0; tick < 1000; ++tick) {
    // A twist that a mad caller reverses at full size every few ticks.
    const double sign = (tick / 7) % 2 == 0 ? 1 : -1;
    const Twist wanted{sign * Vec3(3, -2, 1), sign * Vec3(20, 5, -9)};
    gate.limit({}, wanted, {}, true, h, X_sent, V_sent);
    EXPECT_LE(limits.damper_n_s_per_m * (V_sent.linear - V_last.linear).norm(),
              0.5 * limits.force_slope_n_per_s * h * (1 + 1e-9));
    EXPECT_LE(limits.damper_nm_s_per_rad * (V_sent.angular - V_last.angular).norm(),
              0.5 * limits.torque_slope_nm_per_s * h * (1 + 1e-9));
    const double ramp = std::min(1.0, (tick + 2) * h / limits.ramp_s);
    EXPECT_LE(V_sent.linear.norm(), ramp * limits.speed_m_per_s * (1 + 1e-9));
    V_last = V_sent;
  }
}

}  // namespace
}  // namespace tact::coupling
