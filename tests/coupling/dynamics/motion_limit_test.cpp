#include "coupling/dynamics/motion_limit.hpp"

#include <gtest/gtest.h>

#include <random>

namespace tact::coupling {
namespace {

TEST(MotionLimit, LeavesWhatIsAllowed) {
  const MotionLimit limit{0.1};
  BodyState next{{{0.001, 0, 0}, exp_so3({0, 0, 0.005})}, {{1, 0, 0}, {0, 0, 5}}};
  EXPECT_FALSE(limit.apply(Pose{}, Pose{}, next, 0.00151));
  EXPECT_EQ(next.V_W.linear.x(), 1);
}

TEST(MotionLimit, NoPointOfTheToolMovesFartherThanAllowed) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto vec = [&](double s) { return Vec3(s * normal(random), s * normal(random), s * normal(random)); };
  const MotionLimit limit{0.2};
  for (int i = 0; i < 2000; ++i) {
    const Pose answered{vec(0.1), exp_so3(vec(1))};
    const Pose before = displaced(answered, (Vec6() << vec(0.0001), vec(0.0005)).finished());
    BodyState next{displaced(before, (Vec6() << vec(0.002), vec(0.01)).finished()), {vec(1), vec(1)}};
    const bool cut = limit.apply(answered, before, next, 0.001);
    const double allowed = std::max(0.001, limit.motion_m(answered, before));
    EXPECT_LE(limit.motion_m(answered, next.X_W), allowed + 1e-9);
    const Vec3 p = 0.2 * vec(1).normalized();
    EXPECT_LE((next.X_W * p - answered * p).norm(), allowed + 1e-9);
    if (!cut) {
      EXPECT_LE(limit.motion_m(answered, next.X_W), allowed);
    }
  }
}

TEST(MotionLimit, MovingBackIsNeverCut) {
  const MotionLimit limit{0.1};
  BodyState next{{{0.004, 0, 0}, Quat::Identity()}, {}};
  EXPECT_FALSE(limit.apply(Pose{}, Pose{{0.005, 0, 0}, Quat::Identity()}, next, 0.001));
  EXPECT_EQ(next.X_W.p.x(), 0.004);
}

}  // namespace
}  // namespace tact::coupling
