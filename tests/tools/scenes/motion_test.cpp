#include "scenes/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace tact::scenes {
namespace {

TEST(MinimumJerk, IsThePolynomialAndItsPeakSpeedIs15EighthsOfTheMean) {
  const HandMotion m = minimum_jerk({{0, Vec3::Zero(), Vec3::Zero()}, {2, Vec3(1, 0, 0), Vec3::Zero()}}, 1000);
  ASSERT_EQ(m.time_s.size(), 2001u);
  EXPECT_NEAR(m.X_WM[1000].p.x(), 0.5, 1e-12);
  EXPECT_NEAR(m.X_WM[500].p.x(), 10 * std::pow(.25, 3) - 15 * std::pow(.25, 4) + 6 * std::pow(.25, 5), 1e-12);
  double peak = 0;
  for (std::size_t i = 1; i < m.time_s.size(); ++i) {
    peak = std::max(peak, (m.X_WM[i].p - m.X_WM[i - 1].p).norm() * 1000);
  }
  EXPECT_NEAR(peak, 15. / 8 / 2, 1e-5);
}

TEST(MinimumJerk, ATurnAboutAHeldPointKeepsItInPlace) {
  const Vec3 held(0.1, 0, 0), where(0, 1, 0);
  const Quat quarter(Eigen::AngleAxisd(1.5, Vec3::UnitZ()));
  const HandMotion m = minimum_jerk({{0, where, held}, {1, where, held, quarter}}, 100);
  for (const Pose& X : m.X_WM) EXPECT_LT((X * held - where).norm(), 1e-12);
  EXPECT_LT(m.X_WM.back().q.angularDistance(quarter), 1e-12);
}

}  // namespace
}  // namespace tact::scenes
