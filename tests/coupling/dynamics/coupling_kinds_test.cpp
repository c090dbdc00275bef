#include <gtest/gtest.h>

#include <random>

#include "coupling/dynamics/tool_integrator.hpp"

namespace tact::coupling {
namespace {

constexpr double kH = 1e-3;

ToolIntegrator brick(CouplingKind kind, Integrator integrator = Integrator::implicit, bool locked = false) {
  ToolIntegrator::Params params;
  params.inertia_shape_m2 << 2e-3, 3e-4, 0, 3e-4, 1e-3, -1e-4, 0, -1e-4, 5e-4;
  params.rotation_locked = locked;
  ToolIntegrator tool(params);
  tool.select(kind, integrator);
  return tool;
}

CouplingGains gains_of(const ToolIntegrator& tool, double force_max, double torque_max) {
  CouplingGains gains = coupling_gains(2000, 3, 1.0, tool.mass(), tool.inertia_T());
  gains.force_max = force_max;
  gains.torque_max = torque_max;
  return gains;
}

struct Random {
  Vec3 vec(double scale) { return scale * Vec3(normal(engine), normal(engine), normal(engine)); }
  Pose pose(double far_m, double far_rad) { return {vec(far_m), exp_so3(vec(far_rad))}; }
  /// Some contacts with random normals: any rank from 0 to 6.
  ContactLoad contact() {
    ContactLoad load;
    for (auto n = engine() % 8; n > 0; --n) {
      const Vec3 N = vec(1).normalized(), r = vec(0.03);
      Vec6 s;
      s << N, r.cross(N);
      load.K += 5000 * s * s.transpose();
      load.F_W = Wrench::from(load.F_W.vector() + 5000 * std::abs(normal(engine)) * 2e-4 * s);
    }
    return load;
  }
  std::mt19937 engine{3};
  std::normal_distribution<double> normal;
};

/// F_VC as virtual_coupling.hpp defines it, at given poses and twists.
Vec6 coupling(const BodyState& H, const BodyState& T, double b_r, const CouplingGains& gains) {
  Vec6 F;
  F << cap(gains.k * (H.X_W.p - T.X_W.p) + gains.b * (H.V_W.linear - T.V_W.linear), gains.force_max),
      cap(gains.k_r * log_so3(H.X_W.q * T.X_W.q.conjugate()) + b_r * (H.V_W.angular - T.V_W.angular), gains.torque_max);
  return F;
}

TEST(Static, WhereTheToolGoesContactAndCouplingAreInBalanceWhateverTheContactAndTheCap) {
  Random random;
  const double tool_gyration_m = std::sqrt(3.5e-3 / 2);
  for (int i = 0; i < 20000; ++i) {
    ToolIntegrator tool = brick(CouplingKind::quasi_static);
    const Pose X_WT = random.pose(0.1, 1);
    tool.reset(X_WT);
    const BodyState handle{displaced(X_WT, (Vec6() << random.vec(0.003), random.vec(0.2)).finished()),
                           {random.vec(0.05), random.vec(0.3)}};
    const ContactLoad contact = random.contact();
    const CouplingGains gains = i % 2 ? gains_of(tool, 1e9, 1e9) : gains_of(tool, 5, 0.2);
    tool.step(handle, contact, gains, 0, kH);
    const Vec6 x = displacement(X_WT, tool.tool().X_W);
    const BodyState T{tool.tool().X_W, Twist::from(x / kH)};
    const BodyState H{displaced(handle.X_W, kH * handle.V_W.vector()), handle.V_W};
    const Vec6 left = contact.F_W.vector() - contact.K * x + coupling(H, T, gains.b / gains.k * gains.k_r, gains);
    const double residual = std::hypot(left.head<3>().norm(), left.tail<3>().norm() / tool_gyration_m);
    ASSERT_NEAR(tool.static_residual_n(), residual, 1e-6 + 1e-6 * residual) << i;
    ASSERT_LT(tool.static_residual_n(), ToolIntegrator::kStaticResidual_n) << i;
    ASSERT_LE(tool.F_coupling_W().force.norm(), gains.force_max * (1 + 1e-12));
  }
}

/// Stiff contacts under a twist can push along their own null space, where nothing resists: no balance exists.
TEST(Static, WhereContactPushesHarderThanTheCapHoldsAndNothingResistsTheToolStaysInReachAndSaysSo) {
  Random random;
  for (int i = 0; i < 2000; ++i) {
    ToolIntegrator tool = brick(CouplingKind::quasi_static);
    const Pose X_WT = random.pose(0.1, 1);
    tool.reset(X_WT);
    const BodyState handle{displaced(X_WT, (Vec6() << random.vec(0.003), random.vec(0.2)).finished()), {}};
    ContactLoad contact;
    Vec6 s = Vec6::Zero();
    s << random.vec(1).normalized(), Vec3::Zero();
    contact.K = 1e6 * s * s.transpose();
    contact.F_W = {random.vec(50), random.vec(5)};
    tool.step(handle, contact, gains_of(tool, 5, 0.2), 0, kH);
    ASSERT_TRUE(tool.tool().X_W.finite()) << i;
    ASSERT_LE((tool.tool().X_W.p - X_WT.p).norm(), 0.1 * ToolIntegrator::kStaticSteps + 1) << i;
    if (contact.F_W.torque.norm() > 1) {
      ASSERT_GT(tool.static_residual_n(), 1) << i;
    }
  }
}

TEST(Static, OnAWallTheToolRestsWhereTheSpringsBalanceAndUnderTheCapAtForceOverStiffness) {
  for (const double force_max : {1e9, 4.0}) {
    ToolIntegrator tool = brick(CouplingKind::quasi_static);
    const CouplingGains gains = gains_of(tool, force_max, 1e9);
    const double k = 10000, pushed = 0.005;
    const BodyState handle{{{0, 0, -pushed}, Quat::Identity()}, {}};
    for (int i = 0; i < 200; ++i) {
      ContactLoad contact;
      const double z = tool.tool().X_W.p.z();
      contact.F_W.force.z() = -k * z;
      contact.K(2, 2) = k;
      tool.step(handle, contact, gains, 0, kH);
    }
    const double force = std::min(force_max, pushed / (1 / k + 1 / gains.k));
    EXPECT_NEAR(tool.tool().X_W.p.z(), -force / k, 1e-10);
    EXPECT_NEAR(tool.F_coupling_W().force.z(), -force, 1e-6);
  }
}

TEST(Static, InFreeSpaceTheHandFeelsNothingHoweverItMovesAndTheToolComesAlong) {
  ToolIntegrator tool = brick(CouplingKind::quasi_static);
  const CouplingGains gains = gains_of(tool, 10, 0.3);
  BodyState handle;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * kH;
    const Vec6 V = (Vec6() << 0.3 * std::cos(9 * t), 0.2 * std::sin(7 * t), 0, 0, 2 * std::cos(5 * t), 1).finished();
    handle.V_W = Twist::from(V);
    tool.step(handle, ContactLoad{}, gains, 0, kH);
    ASSERT_LT(tool.F_coupling_W().force.norm(), 1e-6);
    ASSERT_LT(tool.F_coupling_W().torque.norm(), 1e-6);
    handle.X_W = displaced(handle.X_W, kH * V);
  }
  handle.V_W = {};
  for (int i = 0; i < 500; ++i) tool.step(handle, ContactLoad{}, gains, 0, kH);
  EXPECT_LT(displacement(handle.X_W, tool.tool().X_W).norm(), 1e-8);
}

TEST(Static, TheHandleBodyGetsExactlyTheOppositeOfWhatTheToolCarries) {
  Random random;
  for (const Integrator integrator : {Integrator::implicit, Integrator::semi_implicit}) {
    for (int i = 0; i < 200; ++i) {
      ToolIntegrator tool = brick(CouplingKind::quasi_static, integrator);
      const Pose X_WT = random.pose(0.1, 1);
      const BodyState H{displaced(X_WT, (Vec6() << random.vec(0.003), random.vec(0.1)).finished()),
                        {random.vec(0.05), Vec3::Zero()}};
      tool.reset(X_WT);
      tool.set_handle(H);
      const Wrench F_hand{random.vec(5), random.vec(0.1)};
      tool.step(F_hand, random.contact(), gains_of(tool, 5, 0.2), 0, kH);
      const Vec3 impulse = tool.mass() * (tool.handle().V_W.linear - H.V_W.linear);
      ASSERT_LT((impulse - kH * (F_hand.force - tool.F_coupling_W().force)).norm(), 1e-12);
      ASSERT_LT(tool.static_residual_n(), ToolIntegrator::kStaticResidual_n) << i;
    }
  }
}

TEST(Direct, TheToolIsTheHandleAndTheHandGetsTheContactWrench) {
  ToolIntegrator tool = brick(CouplingKind::direct);
  tool.reset(Pose{});
  const BodyState handle{{{0.01, 0.02, 0.03}, exp_so3({0.1, 0.2, 0.3})}, {{1, 2, 3}, {4, 5, 6}}};
  tool.follow(handle, kH);
  EXPECT_LT(displacement(handle.X_W, tool.tool().X_W).norm(), 1e-15);
  EXPECT_EQ(tool.tool().V_W.vector(), handle.V_W.vector());
  tool.pass_on({{1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(tool.F_coupling_W().vector(), -(Vec6() << 1, 2, 3, 4, 5, 6).finished());
}

TEST(Direct, WhereTheyWereApartTheyJoinWithoutAJump) {
  ToolIntegrator tool = brick(CouplingKind::dynamic);
  const Pose X_WH{{0.01, -0.02, 0.005}, exp_so3({0.3, 0, -0.2})};
  tool.reset(Pose{}, X_WH);
  tool.select(CouplingKind::direct, Integrator::implicit);
  double apart = displacement(X_WH, tool.tool().X_W).norm();
  Pose last = tool.tool().X_W;
  for (int i = 0; i < 4000; ++i) {
    tool.follow({X_WH, {}}, kH);
    ASSERT_LT(displacement(last, tool.tool().X_W).norm(), 1.01 * apart * kH / ToolIntegrator::kJoin_s);
    last = tool.tool().X_W;
  }
  EXPECT_LT(displacement(X_WH, last).norm(), 1e-8);
}

TEST(Direct, OneBodyOfTheToolsMassUnderBothWrenches) {
  for (const Integrator integrator : {Integrator::implicit, Integrator::semi_implicit}) {
    ToolIntegrator tool = brick(CouplingKind::direct, integrator);
    ContactLoad contact;
    contact.F_W.force = {-1, 0, 0};
    for (int i = 0; i < 100; ++i) tool.step(Wrench{{3, 0, 0}, Vec3::Zero()}, contact, CouplingGains{}, 0, kH);
    EXPECT_NEAR(tool.handle().V_W.linear.x(), 2.0 / tool.mass() * 0.1, 1e-9);
    EXPECT_LT(displacement(tool.handle().X_W, tool.tool().X_W).norm(), 1e-12);
  }
}

class Locked : public ::testing::TestWithParam<CouplingKind> {};
INSTANTIATE_TEST_SUITE_P(All, Locked,
                         ::testing::Values(CouplingKind::direct, CouplingKind::quasi_static, CouplingKind::dynamic));

TEST_P(Locked, TheToolNeverTurnsAndNoTorqueReachesTheHandInEitherDeviceMode) {
  Random random;
  for (const bool impedance : {true, false}) {
    for (const Integrator integrator : {Integrator::implicit, Integrator::semi_implicit}) {
      ToolIntegrator tool = brick(GetParam(), integrator, true);
      const Quat q = exp_so3({0.3, 0.1, -0.7});
      tool.reset({Vec3::Zero(), q});
      for (int i = 0; i < 100; ++i) {
        const BodyState handle{random.pose(0.01, 1), {random.vec(0.1), random.vec(1)}};
        ContactLoad contact;
        contact.F_W = {random.vec(1), random.vec(1)};
        contact.K = 1e3 * Mat6::Identity();
        if (!impedance) {
          tool.step(Wrench{random.vec(1), random.vec(1)}, contact, gains_of(tool, 5, 0.2), 0, kH);
        } else if (GetParam() == CouplingKind::direct) {
          tool.follow(handle, kH);
          tool.pass_on(contact.F_W);
        } else {
          tool.step(handle, contact, gains_of(tool, 5, 0.2), 0, kH);
        }
        ASSERT_EQ(tool.tool().X_W.q.coeffs(), q.coeffs());
        ASSERT_EQ(tool.F_coupling_W().torque.norm(), 0);
      }
      EXPECT_GT(tool.tool().X_W.p.norm(), 0);
    }
  }
}

}  // namespace
}  // namespace tact::coupling
