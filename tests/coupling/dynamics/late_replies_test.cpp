// A ball of no size, thrown against a wall whose replies come late: what comes back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "coupling/dynamics/tool_integrator.hpp"
#include "coupling/dynamics/wrench_model.hpp"

namespace tact::coupling {
namespace {

constexpr double kH = 1e-3, kMass_kg = 0.2;

/// The wall z < 0 of stiffness k.
ContactLinearisation wall(const Pose& X_WT, double k) {
  ContactLinearisation reply;
  reply.X_WT = X_WT;
  if (X_WT.p.z() >= 0) return reply;
  reply.F_W.force.z() = -k * X_WT.p.z();
  reply.K(2, 2) = k;
  reply.G(2, 2) = -k;
  return reply;
}

/// Speed away from the wall over the speed at which the ball came, every reply `late` ticks late. `damped`: as the
/// product has it; otherwise the step meets K alone.
double rebound(double k, int late, double start_m, bool damped) {
  constexpr double kSpeed = 0.1;
  ToolIntegrator::Params params;
  params.mass_kg = kMass_kg;
  ToolIntegrator tool(params);
  tool.set_tool({{{0, 0, start_m}, Quat::Identity()}, {{0, 0, -kSpeed}, Vec3::Zero()}});
  WrenchModel model;
  std::deque<ContactLinearisation> under_way;
  double fastest = 0;
  for (int tick = 0; tick < 400; ++tick) {
    under_way.push_back(wall(tool.tool().X_W, k));
    const bool any = under_way.size() > static_cast<std::size_t>(late);
    if (any) {
      model.begin_tick(&under_way.front());
    } else {
      model.begin_tick(nullptr);
    }
    ContactLoad load = model.at(tool.tool().X_W, static_cast<std::uint64_t>(late));
    if (!damped && any) load.K = under_way.front().K;
    if (any) under_way.pop_front();
    tool.step(BodyState{}, load, CouplingGains{}, 0, kH);
    fastest = std::max(fastest, tool.tool().V_W.linear.z());
  }
  return fastest / kSpeed;
}

TEST(LateReplies, ATouchReturnsTheBallNoFasterThanItCameHoweverLateAndStiff) {
  for (const int late : {0, 1, 2, 3, 5, 10}) {
    for (const double k : {1e3, 1e4, 1e5, 1e6, 1e8, 1e10}) {
      for (const double start_m : {0.0102, 0.01, 0.00999, 0.01005}) {  // a whole tick's way is 0.1 mm
        EXPECT_LE(rebound(k, late, start_m, true), 1 + 1e-9) << late << " late, k " << k << ", from " << start_m;
      }
    }
  }
}

/// Why: without the damper a stiff wall that answers n ticks late returns n + 1 times the speed.
TEST(LateReplies, WithoutTheDamperAStiffWallReturnsItNPlusOneTimesAsFast) {
  for (const int late : {0, 1, 2, 5}) EXPECT_NEAR(rebound(1e10, late, 0.01000001, false), late + 1, 0.01) << late;
}

/// The damper is gone as soon as a reply knows of no contact: a hand that lifts the tool is not held.
TEST(LateReplies, ALiftedToolIsFreeOnceAReplySaysSo) {
  for (const int late : {0, 1, 3}) {
    ToolIntegrator::Params params;
    params.mass_kg = kMass_kg;
    ToolIntegrator tool(params);
    constexpr double k = 1e6, kPush_n = 10;
    const double rest_m = -kPush_n / k;
    tool.set_tool({{{0, 0, rest_m}, Quat::Identity()}, {}});
    WrenchModel model;
    std::deque<ContactLinearisation> under_way;
    for (int n = 0; n < late; ++n) under_way.push_back(wall(tool.tool().X_W, k));
    ContactLoad load;
    const auto tick = [&](double force_n) {
      under_way.push_back(wall(tool.tool().X_W, k));
      model.begin_tick(&under_way.front());
      under_way.pop_front();
      load = model.at(tool.tool().X_W, static_cast<std::uint64_t>(late));
      load.F_W.force.z() += force_n;
      tool.step(BodyState{}, load, CouplingGains{}, 0, kH);
    };
    for (int n = 0; n < 50; ++n) tick(-kPush_n);
    ASSERT_NEAR(tool.tool().X_W.p.z(), rest_m, 1e-9);
    int ticks = 0;
    while (load.K.norm() > 0 && ++ticks < 100) tick(kPush_n);
    EXPECT_LE(ticks, 3 + 3 * late) << late;
  }
}

}  // namespace
}  // namespace tact::coupling
