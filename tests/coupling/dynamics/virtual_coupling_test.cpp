#include "coupling/dynamics/virtual_coupling.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace tact::coupling {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Cap, KeepsDirectionAndBoundsTheNorm) {
  const Vec3 s(3, -4, 12);
  EXPECT_TRUE(cap(s, 13.5).isApprox(s));
  EXPECT_NEAR(cap(s, 6.5).norm(), 6.5, 1e-14);
  EXPECT_TRUE(cap(s, 6.5).normalized().isApprox(s.normalized(), 1e-14));
  EXPECT_EQ(cap(Vec3::Zero(), 0).norm(), 0);
}

TEST(Cap, GradientIsTheDerivative) {
  const double e = 1e-6;
  for (const Vec3& s : {Vec3(0.1, 0.2, -0.1), Vec3(3, -4, 2), Vec3(0, 0, 50)}) {
    for (int j = 0; j < 3; ++j) {
      const Vec3 d = e * Vec3::Unit(j);
      const Vec3 difference = (cap(s + d, 2.0) - cap(s - d, 2.0)) / (2 * e);
      EXPECT_TRUE(cap_gradient(s, 2.0).col(j).isApprox(difference, 1e-7) ||
                  (cap_gradient(s, 2.0).col(j) - difference).norm() < 1e-7);
    }
  }
}

TEST(CouplingGains, DampingRatioOneIsCriticalOnEachPrincipalAxis) {
  const Mat3 inertia = Vec3(1e-4, 4e-4, 9e-4).asDiagonal();
  const CouplingGains gains = coupling_gains(2000, 5, 1.0, 0.2, inertia);
  EXPECT_NEAR(gains.b * gains.b, 4 * 2000 * 0.2, 1e-9);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(gains.B_r_T(i, i) * gains.B_r_T(i, i), 4 * 5 * inertia(i, i), 1e-12);
}

TEST(RotationError, IsTheShortestWay) {
  RotationError error;
  const Vec3 axis = Vec3(1, 2, 3).normalized();
  EXPECT_TRUE(error.update(exp_so3(0.7 * axis), Quat::Identity()).isApprox(0.7 * axis, 1e-12));
  RotationError other;
  EXPECT_TRUE(other.update(exp_so3((2 * kPi - 0.5) * axis), Quat::Identity()).isApprox(-0.5 * axis, 1e-12));
}

TEST(RotationError, KeepsItsSideJustBeyondHalfATurnAndGivesUpLater) {
  RotationError error;
  const Vec3 axis = Vec3::UnitY();
  for (double a = 0; a < kPi + 0.34; a += 0.01) {
    EXPECT_NEAR(error.update(exp_so3(a * axis), Quat::Identity()).y(), a, 1e-9);
  }
  EXPECT_NEAR(error.update(exp_so3((kPi + 0.4) * axis), Quat::Identity()).y(), 0.4 - kPi, 1e-9);
  // Trembling there does not flip it back: the hysteresis works from both sides.
  EXPECT_LT(error.update(exp_so3((kPi - 0.1) * axis), Quat::Identity()).y(), 0);
}

TEST(RotationError, GradientIsTheSymmetricPartOfTheDerivative) {
  const Vec3 theta(0.9, -1.2, 0.6);
  RotationError error;
  error.update(exp_so3(theta), Quat::Identity());
  const double e = 1e-6;
  Mat3 derivative;
  for (int j = 0; j < 3; ++j) {
    const Vec3 d = e * Vec3::Unit(j);
    derivative.col(j) = (log_so3(exp_so3(d) * exp_so3(theta)) - log_so3(exp_so3(-d) * exp_so3(theta))) / (2 * e);
  }
  EXPECT_TRUE(error.gradient().isApprox(0.5 * (derivative + derivative.transpose()), 1e-7));
}

}  // namespace
}  // namespace tact::coupling
