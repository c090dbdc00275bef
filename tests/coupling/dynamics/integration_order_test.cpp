#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <functional>

#include "coupling/dynamics/tool_integrator.hpp"

namespace tact::coupling {
namespace {

constexpr double kMass = 0.2, kWall = 5000;

ToolIntegrator body(Integrator integrator, const Vec3& inertia_shape) {
  ToolIntegrator::Params params;
  params.mass_kg = kMass;
  params.inertia_shape_m2 = inertia_shape.asDiagonal();
  ToolIntegrator tool(params);
  tool.select(CouplingKind::dynamic, integrator);
  return tool;
}

/// A spring to z = 0, or a wall there.
ContactLoad spring(const BodyState& tool, double k, bool one_sided) {
  ContactLoad contact;
  const double z = tool.X_W.p.z();
  if (one_sided && z >= 0) return contact;
  contact.F_W.force.z() = -k * z;
  contact.K(2, 2) = k;
  return contact;
}

double energy(const ToolIntegrator& tool) {
  const BodyState& body = tool.tool();
  return 0.5 * kMass * body.V_W.linear.squaredNorm() + 0.5 * kWall * body.X_W.p.z() * body.X_W.p.z();
}

class Order : public ::testing::TestWithParam<Integrator> {};
INSTANTIATE_TEST_SUITE_P(All, Order, ::testing::Values(Integrator::semi_implicit, Integrator::implicit),
                         [](const auto& i) { return i.param == Integrator::implicit ? "Implicit" : "SemiImplicit"; });

void expect_first_order(const std::function<double(double)>& error, double ratio_max = 2.2) {
  for (const double h : {4e-4, 2e-4, 1e-4}) {
    const double ratio = error(h) / error(h / 2);
    EXPECT_GT(ratio, 1.8) << h;
    EXPECT_LT(ratio, ratio_max) << h;
  }
}

// A symmetric top: R(t) = exp(t L / I_1) R_0 exp(t (1 - I_3 / I_1) w_3 e_3).
TEST_P(Order, AFreeSymmetricTopPrecessesAtFirstOrder) {
  const Vec3 shape(4e-4, 4e-4, 7e-4), w(3, 1, 6);
  expect_first_order([&](double h) {
    ToolIntegrator tool = body(GetParam(), shape);
    tool.set_tool({{}, {Vec3::Zero(), w}});
    const double t = 0.4;
    for (auto n = std::lround(t / h); n > 0; --n) tool.step(BodyState{}, ContactLoad{}, CouplingGains{}, 0, h);
    const Vec3 precession = shape.cwiseProduct(w) / shape.x();
    const Quat exact = exp_so3(t * precession) * exp_so3(t * (1 - shape.z() / shape.x()) * w.z() * Vec3::UnitZ());
    return log_so3(tool.tool().X_W.q * exact.conjugate()).norm();
  });
}

// z = z0 - v t to the wall, -(v / w) sin(w (t - z0 / v)) in it, away at v after half a period.
TEST_P(Order, ABounceOffASpringWallConvergesAtFirstOrderOrBetter) {
  const double v = 0.1, z0 = 0.001, w = std::sqrt(kWall / kMass);
  const auto after = [&](double t, double h) {
    ToolIntegrator tool = body(GetParam(), {4e-4, 5e-4, 6e-4});
    tool.set_tool({{{0, 0, z0}, Quat::Identity()}, {{0, 0, -v}, Vec3::Zero()}});
    for (auto n = std::lround(t / h); n > 0; --n) {
      tool.step(BodyState{}, spring(tool.tool(), kWall, true), CouplingGains{}, 0, h);
    }
    return tool.tool().X_W.p.z();
  };
  const double inside = 0.02, outside = z0 / v + M_PI / w + 0.01;
  for (const double h : {2e-5, 1e-5}) {
    EXPECT_NEAR(after(inside, h), -v / w * std::sin(w * (inside - z0 / v)), 10 * v * h);
    EXPECT_NEAR(after(outside, h), v * 0.01, 20 * v * h);
  }
  // The positions of semi-implicit Euler that came from free flight are those of leapfrog: of second order.
  expect_first_order([&](double h) { return std::abs(after(inside, h) + v / w * std::sin(w * (inside - z0 / v))); },
                     GetParam() == Integrator::implicit ? 2.2 : 4.2);
}

TEST(SemiImplicit, TheEnergyOfAnOscillationStaysWithinItsBandForAMillionSteps) {
  const double h = 1e-3, w = std::sqrt(kWall / kMass);
  ToolIntegrator tool = body(Integrator::semi_implicit, {4e-4, 5e-4, 6e-4});
  tool.set_tool({{{0, 0, 0.001}, Quat::Identity()}, {}});
  const double start = energy(tool);
  double least = 1e9, most = 0;
  for (int i = 0; i < 1000000; ++i) {
    tool.step(BodyState{}, spring(tool.tool(), kWall, false), CouplingGains{}, 0, h);
    least = std::min(least, energy(tool));
    most = std::max(most, energy(tool));
  }
  // v^2 + w^2 z^2 - h w^2 z v is conserved exactly: the energy moves by at most w h / 2 of itself to either side.
  EXPECT_GT(least, start * (1 - w * h / 2) / (1 + w * h / 2) * (1 - 1e-9));
  EXPECT_LT(most, start / (1 - w * h / 2) * (1 + 1e-9));
}

TEST(Implicit, AnOscillationLosesEnergyAtTheRateOfImplicitEulerAndNeverGains) {
  const double h = 1e-3;
  ToolIntegrator tool = body(Integrator::implicit, {4e-4, 5e-4, 6e-4});
  tool.set_tool({{{0, 0, 0.001}, Quat::Identity()}, {}});
  for (int i = 0; i < 1000; ++i) {
    const double before = energy(tool);
    tool.step(BodyState{}, spring(tool.tool(), kWall, false), CouplingGains{}, 0, h);
    ASSERT_NEAR(energy(tool) / before, 1 / (1 + kWall / kMass * h * h), 1e-9);
  }
}

TEST_P(Order, AMillionTicksOfTurningAddUpToTheExactRotation) {
  ToolIntegrator tool = body(GetParam(), {5e-4, 5e-4, 5e-4});
  const Vec3 w(1, -2, 0.5);
  tool.set_tool({{}, {Vec3::Zero(), w}});
  const int n = GetParam() == Integrator::implicit ? 100000 : 1000000;
  for (int i = 0; i < n; ++i) tool.step(BodyState{}, ContactLoad{}, CouplingGains{}, 0, 1e-3);
  EXPECT_LT(log_so3(tool.tool().X_W.q * exp_so3(1e-3 * n * w).conjugate()).norm(), 1e-6);  // of two thousand radians
  EXPECT_NEAR(tool.tool().X_W.q.norm(), 1, 1e-14);
  EXPECT_LT((tool.tool().V_W.angular - w).norm(), 1e-8);
}

TEST_P(Order, HandleAndToolKeepTheirMomentumTogetherAndLoseEnergyToTheDamperOnly) {
  ToolIntegrator tool = body(GetParam(), {4e-4, 5e-4, 7e-4});
  tool.set_tool({{}, {{0.2, 0, 0.1}, {1, 2, -1}}});
  tool.set_handle({{{0.003, 0, 0}, exp_so3({0, 0.1, 0})}, {{-0.1, 0.3, 0}, {0, -1, 2}}});
  const CouplingGains gains = coupling_gains(2000, 1, 0.2, tool.mass(), tool.inertia_T());
  const auto momentum = [&](const BodyState& b) {
    const Mat3 R = b.X_W.R();
    return (Vec6() << kMass * b.V_W.linear, R * tool.inertia_T() * R.transpose() * b.V_W.angular).finished();
  };
  const auto energy_of_both = [&] {
    double E = 0.5 * gains.k * (tool.handle().X_W.p - tool.tool().X_W.p).squaredNorm() +
               0.5 * gains.k_r * log_so3(tool.handle().X_W.q * tool.tool().X_W.q.conjugate()).squaredNorm();
    for (const BodyState& b : {tool.tool(), tool.handle()}) E += 0.5 * b.V_W.vector().dot(momentum(b));
    return E;
  };
  const Vec6 before = momentum(tool.tool()) + momentum(tool.handle());
  double last = energy_of_both();
  for (int i = 0; i < 2000; ++i) {
    tool.step(Wrench{}, ContactLoad{}, gains, 0, 1e-3);
    ASSERT_LT((momentum(tool.tool()) + momentum(tool.handle()) - before).norm(), 1e-10) << i;
    if (i % 100 == 99) {
      EXPECT_LT(energy_of_both(), last * (1 + 1e-5)) << i;  // the turning of what is left is of first order
      last = energy_of_both();
    }
  }
}

/// Both bodies and the cap by dense Newton on twelve unknowns, to the end.
TEST(Implicit, UnderTheCapTwoBodiesSolveTheFullNonlinearSystemOfTwelve) {
  using Mat12 = Eigen::Matrix<double, 12, 12>;
  using Vec12 = Eigen::Matrix<double, 12, 1>;
  const double h = 1e-3;
  ToolIntegrator tool = body(Integrator::implicit, {4e-4, 5e-4, 7e-4});
  const BodyState T{{{0, 0, 0}, exp_so3({0.2, 0.1, -0.3})}, {{0.1, 0.2, -0.1}, {1, -2, 3}}};
  const BodyState H{{{0.012, -0.007, 0.008}, exp_so3({0.5, 0.05, -0.2})}, {{0.2, 0.1, 0.1}, {-1, 0.5, 0.2}}};
  tool.set_tool(T);
  tool.set_handle(H);
  CouplingGains gains = coupling_gains(2000, 3, 1.0, tool.mass(), tool.inertia_T());
  gains.force_max = 8;
  gains.torque_max = 0.1;
  ContactLoad contact;
  Mat6 A = Mat6::Random();
  contact.K = 2e3 * A * A.transpose();
  contact.F_W = {{1, -2, 3}, {0.1, 0.2, -0.1}};
  const Wrench F_hand{{0.5, 1, -2}, {0.02, -0.01, 0.03}};

  RotationError error;
  error.update(H.X_W.q, T.X_W.q);
  const auto mass = [&](const BodyState& b) {
    Mat6 M = tool.mass() * Mat6::Identity();
    M.bottomRightCorner<3, 3>() = b.X_W.R() * tool.inertia_T() * b.X_W.R().transpose();
    return M;
  };
  Mat6 D = Mat6::Zero();
  D.topLeftCorner<3, 3>() = (h * gains.k + gains.b) * Mat3::Identity();
  D.bottomRightCorner<3, 3>() = h * gains.k_r * error.gradient() + T.X_W.R() * gains.B_r_T * T.X_W.R().transpose();
  Vec6 s0;
  s0 << gains.k * (H.X_W.p - T.X_W.p), gains.k_r * error.value();
  Vec12 V;
  V << T.V_W.vector(), H.V_W.vector();
  Vec6 F_VC;
  for (int i = 0; i < 50; ++i) {
    const Vec6 s = s0 + D * (V.tail<6>() - V.head<6>());
    F_VC << cap(s.head<3>(), gains.force_max), cap(s.tail<3>(), gains.torque_max);
    Mat6 J = Mat6::Zero();
    J.topLeftCorner<3, 3>() = cap_gradient(s.head<3>(), gains.force_max);
    J.bottomRightCorner<3, 3>() = cap_gradient(s.tail<3>(), gains.torque_max);
    Vec12 r;
    r << mass(T) * (V.head<6>() - T.V_W.vector()) - h * (contact.F_W.vector() - h * contact.K * V.head<6>() + F_VC),
        mass(H) * (V.tail<6>() - H.V_W.vector()) - h * (F_hand.vector() - F_VC);
    Mat12 S;
    S << mass(T) + h * h * contact.K + h * J * D, -h * J * D, -h * J * D, mass(H) + h * J * D;
    V -= S.partialPivLu().solve(r);
  }
  tool.step(F_hand, contact, gains, 0, h);
  EXPECT_TRUE(tool.saturated());
  EXPECT_LT((tool.F_coupling_W().vector() - F_VC).norm(), 1e-6 * F_VC.norm());
  EXPECT_LT((displacement(T.X_W, tool.tool().X_W) - h * V.head<6>()).norm(), 1e-9);
  EXPECT_LT((displacement(H.X_W, tool.handle().X_W) - h * V.tail<6>()).norm(), 1e-9);
}

}  // namespace
}  // namespace tact::coupling
