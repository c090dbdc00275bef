#include "coupling/dynamics/tool_integrator.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

namespace tact::coupling {
namespace {

constexpr double kH = 1e-3;
using Mat12 = Eigen::Matrix<double, 12, 12>;
using Vec12 = Eigen::Matrix<double, 12, 1>;

ToolIntegrator::Params brick() {
  ToolIntegrator::Params params;
  params.mass_kg = 0.2;
  params.inertia_shape_m2 << 2e-3, 3e-4, 0, 3e-4, 1e-3, -1e-4, 0, -1e-4, 5e-4;
  return params;
}

ToolIntegrator with(Integrator integrator, const ToolIntegrator::Params& params = brick(),
                    CouplingKind kind = CouplingKind::dynamic) {
  ToolIntegrator tool(params);
  tool.select(kind, integrator);
  return tool;
}

CouplingGains gains_of(const ToolIntegrator& tool, double k = 2000, double k_r = 5) {
  return coupling_gains(k, k_r, 1.0, tool.mass(), tool.inertia_T());
}

Vec3 angular_momentum(const ToolIntegrator& tool, const BodyState& body) {
  const Mat3 R = body.X_W.R();
  return R * tool.inertia_T() * R.transpose() * body.V_W.angular;
}

class BothIntegrators : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(All, BothIntegrators, ::testing::Values(Integrator::semi_implicit, Integrator::implicit),
                         [](const auto& i) { return i.param == Integrator::implicit ? "Implicit" : "SemiImplicit"; });

TEST_P(BothIntegrators, FreeMotionConservesBothMomentaAndMovesInAStraightLine) {
  ToolIntegrator tool = with(GetParam());
  const Twist V{{0.3, -0.2, 0.1}, {4, -7, 5}};
  tool.set_tool({{{1, 2, 3}, exp_so3({0.3, 0.2, 0.9})}, V});
  const Vec3 L = angular_momentum(tool, tool.tool());
  const CouplingGains none;  // k = 0
  for (int i = 0; i < 2000; ++i) tool.step(BodyState{}, ContactLoad{}, none, 0, kH);
  EXPECT_TRUE(tool.tool().V_W.linear.isApprox(V.linear, 1e-12));
  EXPECT_TRUE(tool.tool().X_W.p.isApprox(Vec3(1, 2, 3) + 2.0 * V.linear, 1e-12));
  EXPECT_TRUE(angular_momentum(tool, tool.tool()).isApprox(L, 1e-10));
}

TEST_P(BothIntegrators, ASphericalBodySpinsUniformly) {
  auto params = brick();
  params.inertia_shape_m2 = 1e-3 * Mat3::Identity();
  ToolIntegrator tool = with(GetParam(), params);
  const Vec3 w(1, -2, 0.5);
  tool.set_tool({{}, {Vec3::Zero(), w}});
  for (int i = 0; i < 500; ++i) tool.step(BodyState{}, ContactLoad{}, CouplingGains{}, 0, kH);
  EXPECT_LT(log_so3(tool.tool().X_W.q * exp_so3(0.5 * w).conjugate()).norm(), 1e-10);
}

TEST_P(BothIntegrators, OscillationAboutAFixedHandleConvergesToTheCosineAtFirstOrder) {
  const double k = 800;
  const auto error = [&](double h) {
    ToolIntegrator tool = with(GetParam());
    tool.set_tool({{{0.01, 0, 0}, Quat::Identity()}, {}});
    CouplingGains gains;
    gains.k = k;
    const int n = static_cast<int>(std::lround(0.1 / h));
    for (int i = 0; i < n; ++i) tool.step(BodyState{}, ContactLoad{}, gains, 0, h);
    return std::abs(tool.tool().X_W.p.x() - 0.01 * std::cos(std::sqrt(k / tool.mass()) * 0.1));
  };
  const double ratio = error(1e-4) / error(5e-5);
  EXPECT_GT(ratio, 1.8);
  EXPECT_LT(ratio, 2.2);
}

TEST_P(BothIntegrators, TheCouplingPullsTheToolTowardsTheHandleAndTheHandleTowardsTheTool) {
  ToolIntegrator tool = with(GetParam());
  tool.set_handle({{{0.01, 0, 0}, exp_so3({0, 0, 0.1})}, {}});
  tool.step(Wrench{}, ContactLoad{}, gains_of(tool), 0, kH);
  EXPECT_GT(tool.F_coupling_W().force.x(), 0);
  EXPECT_GT(tool.F_coupling_W().torque.z(), 0);
  EXPECT_GT(tool.tool().V_W.linear.x(), 0);
  EXPECT_LT(tool.handle().V_W.linear.x(), 0);
}

TEST_P(BothIntegrators, ActionEqualsReactionAlsoUnderTheCap) {
  for (const double force_max : {1e9, 3.0}) {
    ToolIntegrator tool = with(GetParam());
    tool.set_handle({{{0.02, 0.01, 0}, exp_so3({0, 0.4, 0.2})}, {{0.1, 0.2, 0.3}, Vec3::Zero()}});
    CouplingGains gains = gains_of(tool);
    gains.force_max = force_max;
    gains.torque_max = 0.05 * force_max;
    const Vec3 P = tool.mass() * (tool.tool().V_W.linear + tool.handle().V_W.linear);
    const Vec3 L = angular_momentum(tool, tool.tool()) + angular_momentum(tool, tool.handle());
    for (int i = 0; i < 100; ++i) tool.step(Wrench{}, ContactLoad{}, gains, 0, kH);
    EXPECT_TRUE((tool.mass() * (tool.tool().V_W.linear + tool.handle().V_W.linear)).isApprox(P, 1e-10));
    EXPECT_LT((angular_momentum(tool, tool.tool()) + angular_momentum(tool, tool.handle()) - L).norm(), 1e-10);
  }
}

TEST_P(BothIntegrators, TheCapIsExactForceAndTorqueApart) {
  ToolIntegrator tool = with(GetParam());
  CouplingGains gains = gains_of(tool);
  gains.force_max = 10;
  gains.torque_max = 0.4;
  // Against a stiff wall: all of the pull is carried by the contact.
  Mat6 K = Mat6::Zero();
  K.topLeftCorner<3, 3>() = 2e4 * Mat3::Identity();
  K.bottomRightCorner<3, 3>() = 20 * Mat3::Identity();
  BodyState handle{{{0.05, 0.02, 0}, exp_so3({0, 0, 1.5})}, {}};
  for (int i = 0; i < 2000; ++i) {
    handle.V_W.linear = Vec3(std::sin(0.1 * i), 0, 0);
    ContactLoad contact;
    contact.K = K;
    contact.F_W = Wrench::from(-K * displacement(Pose{}, tool.tool().X_W));
    tool.step(handle, contact, gains, 0, kH);
    ASSERT_LE(tool.F_coupling_W().force.norm(), 10 * (1 + 1e-12));
    ASSERT_LE(tool.F_coupling_W().torque.norm(), 0.4 * (1 + 1e-12));
    if (i > 1000) {
      ASSERT_TRUE(tool.saturated());
      ASSERT_NEAR(tool.F_coupling_W().force.norm(), 10, 1e-9);
      ASSERT_NEAR(tool.F_coupling_W().torque.norm(), 0.4, 1e-9);
    }
  }
}

TEST(Implicit, TwoBodiesBySchurComplementSolveTheFullSystemOfTwelve) {
  ToolIntegrator tool(brick());
  const BodyState T{{{0.01, -0.02, 0.03}, exp_so3({0.2, 0.1, -0.3})}, {{0.1, 0.2, -0.1}, {1, -2, 3}}};
  const BodyState H{{{0.012, -0.017, 0.028}, exp_so3({0.25, 0.05, -0.2})}, {{0.2, 0.1, 0.1}, {-1, 0.5, 0.2}}};
  tool.set_tool(T);
  tool.set_handle(H);
  Mat6 A = Mat6::Random();
  ContactLoad contact;
  contact.K = 1e4 * A * A.transpose();
  A = Mat6::Random();
  contact.B = 10 * A * A.transpose();
  contact.F_W = {{1, -2, 3}, {0.1, 0.2, -0.1}};
  const Wrench F_hand{{0.5, 1, -2}, {0.02, -0.01, 0.03}};
  const CouplingGains gains = gains_of(tool);

  RotationError error;
  error.update(H.X_W.q, T.X_W.q);
  const auto mass = [&](const BodyState& body) {
    Mat6 M = tool.mass() * Mat6::Identity();
    M.bottomRightCorner<3, 3>() = body.X_W.R() * tool.inertia_T() * body.X_W.R().transpose();
    return M;
  };
  Mat6 D = Mat6::Zero();
  D.topLeftCorner<3, 3>() = (kH * gains.k + gains.b) * Mat3::Identity();
  D.bottomRightCorner<3, 3>() = kH * gains.k_r * error.gradient() + T.X_W.R() * gains.B_r_T * T.X_W.R().transpose();
  Vec6 s0;
  s0 << gains.k * (H.X_W.p - T.X_W.p), gains.k_r * error.value();
  Mat12 S;
  S << mass(T) + kH * kH * contact.K + kH * contact.B + kH * D, -kH * D, -kH * D, mass(H) + kH * D;
  Vec12 r;
  r << mass(T) * T.V_W.vector() + kH * (contact.F_W.vector() + contact.B * T.V_W.vector() + s0),
      mass(H) * H.V_W.vector() + kH * (F_hand.vector() - s0);
  const Vec12 V = S.partialPivLu().solve(r);

  tool.step(F_hand, contact, gains, 0, kH);
  EXPECT_TRUE(displacement(T.X_W, tool.tool().X_W).isApprox(kH * V.head<6>(), 1e-9));
  EXPECT_TRUE(displacement(H.X_W, tool.handle().X_W).isApprox(kH * V.tail<6>(), 1e-9));
  EXPECT_TRUE(tool.F_coupling_W().vector().isApprox(s0 + D * (V.tail<6>() - V.head<6>()), 1e-9));
}

TEST(Implicit, IsStableOnAWallAMillionNewtonPerMetreStiffAtTwoHundredFiftyHertz) {
  ToolIntegrator tool(brick());
  const CouplingGains gains = gains_of(tool);
  const BodyState handle{{{0, 0, -0.004}, Quat::Identity()}, {}};
  const double k = 1e6, h = 4e-3;
  for (int i = 0; i < 2000; ++i) {
    ContactLoad contact;
    const double z = tool.tool().X_W.p.z();
    if (z < 0) {
      contact.F_W.force.z() = -k * z;
      contact.K(2, 2) = k;
    }
    tool.step(handle, contact, gains, 0, h);
  }
  const double expected = -gains.k * 0.004 / (k + gains.k);
  EXPECT_NEAR(tool.tool().X_W.p.z(), expected, 1e-9);
  EXPECT_LT(tool.tool().V_W.linear.norm(), 1e-9);
}

TEST(Implicit, AHandleTurnedByHalfATurnIsReachedWithoutDrift) {
  ToolIntegrator tool(brick());
  const Quat q = exp_so3({0, 3.1, 0});
  for (int i = 0; i < 5000; ++i) tool.step(BodyState{{Vec3::Zero(), q}, {}}, ContactLoad{}, gains_of(tool), 0, kH);
  EXPECT_LT(log_so3(tool.tool().X_W.q * q.conjugate()).norm(), 1e-6);
  EXPECT_NEAR(tool.tool().X_W.q.norm(), 1, 1e-12);
}

TEST(RotationLocked, NeitherBodyTurnsAndNoTorqueReachesTheHand) {
  auto params = brick();
  params.rotation_locked = true;
  ToolIntegrator tool(params);
  ContactLoad contact;
  contact.F_W = {{1, 2, 3}, {4, 5, 6}};
  contact.K = 1e4 * Mat6::Identity();
  for (int i = 0; i < 10; ++i) tool.step(Wrench{{1, 0, 0}, {1, 1, 1}}, contact, gains_of(tool), 0, kH);
  EXPECT_EQ(tool.tool().X_W.q.angularDistance(Quat::Identity()), 0);
  EXPECT_EQ(tool.handle().X_W.q.angularDistance(Quat::Identity()), 0);
  EXPECT_EQ(tool.F_coupling_W().torque.norm(), 0);
  EXPECT_GT(tool.tool().X_W.p.norm(), 0);
}

TEST(ToolDamping, BringsTheToolToRestWithoutOvershoot) {
  ToolIntegrator tool(brick());
  tool.set_tool({{}, {{1, 0, 0}, {0, 10, 0}}});
  double speed = 1;
  for (int i = 0; i < 100; ++i) {
    tool.step(BodyState{}, ContactLoad{}, CouplingGains{}, 1e4, kH);
    ASSERT_LT(tool.tool().V_W.linear.x(), speed);
    ASSERT_GE(tool.tool().V_W.linear.x(), 0);
    speed = tool.tool().V_W.linear.x();
  }
  EXPECT_LT(speed, 1e-9);
  EXPECT_LT(tool.tool().V_W.angular.norm(), 1e-9);
}

}  // namespace
}  // namespace tact::coupling
