#include "lockstep/lockstep.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <set>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::lockstep {
namespace {

Experiment setup_of(AnalyticScene scene) {
  Experiment setup;
  setup.session.scene = std::move(scene.spec);
  setup.bodies = std::move(scene.bodies);
  setup.motion_WM = std::move(scene.motion_WM);
  return setup;
}

void put(std::string& bytes, const void* data, std::size_t size) { bytes.append(static_cast<const char*>(data), size); }

/// Everything a run says, as bytes.
std::string everything(const Experiment& setup, double seconds) {
  Lockstep rig(setup);
  std::string bytes;
  for (auto n = std::llround(seconds * setup.session.machine.rate_hz); n > 0; --n) {
    const TickTrace& t = rig.tick();
    put(bytes, &t.time_s, sizeof t.time_s);
    for (const Pose* X : {&t.X_WH, &t.X_WT}) {
      put(bytes, X->p.data(), 3 * sizeof(double));
      put(bytes, X->q.coeffs().data(), 4 * sizeof(double));
    }
    for (const Vec6& v : {t.V_WT.vector(), t.F_contact_W.vector(), t.F_coupling_W.vector()}) {
      put(bytes, v.data(), 6 * sizeof(double));
    }
    put(bytes, &t.contact_count, sizeof t.contact_count);
    for (const double v : {t.max_depth_m, t.net_stiffness_n_per_m, t.port_energy_j}) put(bytes, &v, sizeof v);
    put(bytes, &t.faults, sizeof t.faults);
  }
  const coupling::LoopStats s = rig.stats();
  for (const double v : {s.duration_s, s.contacts_mean, s.penetration_max_m, s.penetration_quasi_static_max_m,
                         s.force_step_rms_n, s.force_step_max_n, s.port_energy_j}) {
    put(bytes, &v, sizeof v);
  }
  return bytes;
}

TEST(Lockstep, TwoRunsOfOneSetupAgreeToTheLastBit) {
  for (const char* mode : {"pseudo-admittance", "impedance"}) {
    Experiment setup = setup_of(flat_face(100));
    setup.session.machine.mode = mode;
    setup.delay_ticks = 3;
    setup.replies = "1101";
    const std::string first = everything(setup, 1.5);
    EXPECT_TRUE(first == everything(setup, 1.5)) << mode;
    setup.replies = "1011";  // and the comparison sees a difference
    EXPECT_FALSE(first == everything(setup, 1.5)) << mode;
  }
}

/// A motion is of the tool's mesh frame, wherever its centre of mass is in that.
TEST(Lockstep, AMotionBringsTheMeshFrameWhereItSays) {
  Experiment setup = setup_of(flat_face(100));
  auto shell = *setup.bodies.shell;
  shell.X_TM = {Vec3(0.01, -0.02, 0.03), Quat(Eigen::AngleAxisd(0.5, Vec3::UnitX()))};
  setup.bodies.shell = std::make_shared<const contact::Pointshell>(shell);
  const Pose from{Vec3(0, 0, 0.2), Quat::Identity()};
  const Pose to{Vec3(0.01, 0.02, 0.22), Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ()))};  // in the air
  setup.session.scene.start_X_WM = from;
  setup.motion_WM = {{0, 0.5, 1}, {from, to, to}};
  Lockstep rig(setup);
  ASSERT_TRUE(rig.run_script(1));
  EXPECT_LT((rig.status().X_WM.p - to.p).norm(), 1e-4);
  EXPECT_LT(rig.status().X_WM.q.angularDistance(to.q), 1e-2);
}

/// All points of a flat face at one depth d: the law decides how F = net k d is shared.
TEST(Lockstep, AFlatFaceRestsAtTheDepthOfItsClosedForm) {
  constexpr double kForce_n = 10;  // the hand pulls with more, the coupling gives way at F_max
  constexpr int kPoints = 100;
  const auto net_over_k = [](const std::string& law) {
    if (law == "none") return 1.0 * kPoints;
    if (law == "global") return 10.0;
    if (law == "adaptive-3dof") return 1.0;
    return std::pow(kPoints, 2.0 / 16);  // potential, p = 16
  };
  for (const std::string law : {"none", "global", "adaptive-3dof", "potential"}) {
    for (const char* mode : {"pseudo-admittance", "impedance"}) {
      Experiment setup = setup_of(flat_face(kPoints));
      setup.session.machine.mode = mode;
      setup.session.scene.contact.law = law;
      setup.session.scene.contact.damping_ratio = 0.2;
      Lockstep rig(setup);
      ASSERT_TRUE(rig.run_script(1.5));
      const double k = rig.answer().stiffness_n_per_m;
      EXPECT_NEAR(k, kForce_n / (0.5 * rig.voxel_m()), 1e-6);
      EXPECT_EQ(rig.trace().contact_count, 1u * kPoints);
      EXPECT_NEAR(rig.trace().F_contact_W.force.z(), kForce_n, 0.01) << law;
      const double depth = kForce_n / (net_over_k(law) * k);
      EXPECT_NEAR(rig.trace().max_depth_m, depth, 0.01 * depth) << law << ' ' << mode;
    }
  }
}

/// The contact server's own field, points and law. In impedance the hand presses askew, so that torques are in it too;
/// in pseudo-admittance the arm's own spring for turns depends on the rate (driver_spring), and with it where they
/// rest.
TEST(Lockstep, OneSceneRestsAtTheSamePoseAndWrenchAtEveryRate) {
  constexpr double kForceTolerance = 2e-3, kDepthTolerance = 2e-3, kPose_m = 5e-6, kPose_rad = 1e-4;
  for (const int points : {9, 100}) {
    for (const std::string law : {"potential", "adaptive-6dof", "global"}) {
      for (const char* mode : {"pseudo-admittance", "impedance"}) {
        Pose X_rest;
        Wrench F_rest;
        double depth_rest_m = 0;
        for (const double rate_hz : {1000.0, 500.0, 2000.0, 4000.0}) {
          Experiment setup = setup_of(flat_face(points));
          setup.session.machine.mode = mode;
          setup.session.machine.rate_hz = rate_hz;
          setup.session.scene.contact.law = law;
          setup.session.scene.contact.damping_ratio = 0.2;
          if (setup.session.machine.mode == "impedance") setup.motion_WM.X_WM.back().q = exp_so3({0.05, -0.03, 0.02});
          Lockstep rig(setup);
          ASSERT_TRUE(rig.run_script(3));
          const TickTrace& t = rig.trace();
          if (rate_hz == 1000) {
            X_rest = t.X_WT;
            F_rest = t.F_contact_W;
            depth_rest_m = t.max_depth_m;
            EXPECT_GT(F_rest.force.norm(), 9);
            continue;
          }
          const std::string where = std::to_string(points) + " points, " + law + ", " + mode + ", " +
                                    std::to_string(static_cast<int>(rate_hz)) + " Hz";
          const Vec6 apart = displacement(X_rest, t.X_WT);
          EXPECT_LT(apart.head<3>().norm(), kPose_m) << where;
          EXPECT_LT(apart.tail<3>().norm(), kPose_rad) << where;
          EXPECT_LT((t.F_contact_W.force - F_rest.force).norm(), kForceTolerance * F_rest.force.norm()) << where;
          EXPECT_LT((t.F_contact_W.torque - F_rest.torque).norm(), kForceTolerance * F_rest.force.norm() * 0.02)
              << where;
          EXPECT_NEAR(t.max_depth_m, depth_rest_m, kDepthTolerance * depth_rest_m) << where;
        }
      }
    }
  }
}

TEST(Lockstep, EveryReplyComesOneTickAndTheDelayAfterItsPose) {
  for (const int delay : {0, 1, 4}) {
    Experiment setup = setup_of(flat_face(10));
    setup.delay_ticks = delay;
    Lockstep rig(setup);
    constexpr std::uint64_t kTicks = 400;
    for (std::uint64_t i = 0; i < kTicks; ++i) rig.tick();
    const auto stats = rig.stats();
    EXPECT_EQ(stats.wrench_fresh, kTicks - 1 - static_cast<std::uint64_t>(delay));
    EXPECT_EQ(stats.wrench_late + stats.wrench_stale, 0u);
    EXPECT_EQ(stats.round_trip.max_ns, delay * 1'000'000 + 50'000);
  }
}

/// The force that acts is that of the pose `delay` ticks and one ago, extrapolated by G: exact in a flat contact whose
/// points all stay, but it is missing for as long as nobody has answered yet that there is contact at all.
TEST(Lockstep, ADelayedReplyLetsTheToolInDeeperBeforeItIsFelt) {
  const auto felt_at = [](int delay) {
    Experiment setup = setup_of(flat_face(10));
    setup.delay_ticks = delay;
    Lockstep rig(setup);
    int touching = 0;
    while (rig.trace().F_contact_W.force.norm() == 0 && rig.trace().time_s < 3) {
      rig.tick();
      touching += rig.trace().contact_count > 0 ? 1 : 0;
    }
    return touching;
  };
  const int at_once = felt_at(0);
  for (const int delay : {1, 3, 10}) EXPECT_EQ(felt_at(delay), at_once + delay);
}

TEST(Lockstep, LostRepliesAreBridgedAndCounted) {
  Experiment setup = setup_of(flat_face(10));
  setup.replies = "110";
  Lockstep rig(setup);
  rig.run(1.2);  // 1200 ticks
  const auto stats = rig.stats();
  EXPECT_EQ(stats.wrench_fresh, 800u);
  EXPECT_EQ(stats.wrench_late, 399u);  // the reply to the last pose is due after the last tick
  EXPECT_EQ(stats.wrench_stale, 0u);
}

TEST(Lockstep, ABallOnAPlaneHasNoTorqueAndTheFootOnWiresOnlyTouchesThem) {
  Experiment ball = setup_of(ball_on_plane(2000));
  Lockstep rolling(ball);
  ASSERT_TRUE(rolling.run_script());
  EXPECT_GT(rolling.trace().contact_count, 3u);
  EXPECT_LT(rolling.trace().F_contact_W.torque.norm(), 1e-3 * 0.02 * rolling.trace().F_contact_W.force.norm());

  Experiment foot = setup_of(foot_on_wires(1600));
  Lockstep standing(foot);
  ASSERT_TRUE(standing.run_script());
  const auto& contacts = standing.pipeline().contacts();
  ASSERT_GT(contacts.size, 0u);
  std::set<double> wires;
  for (std::size_t i = 0; i < contacts.size; ++i) {
    const double x = contacts.r[i].x() + standing.trace().X_WT.p.x();
    const double wire = 0.015 * std::round(x / 0.015);
    EXPECT_LT(std::abs(x - wire), 1e-3);
    wires.insert(wire);
  }
  EXPECT_EQ(wires.size(), 3u);
}

TEST(Lockstep, WhatMakesNoSenseIsRefused) {
  const auto message = [](const std::function<void(Experiment&)>& change) -> std::string {
    Experiment setup = setup_of(flat_face(10));
    change(setup);
    try {
      Lockstep rig(setup);
    } catch (const SetupError& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_NE(message([](Experiment& s) { s.delay_ticks = -1; }).find("delay: found -1"), std::string::npos);
  EXPECT_NE(message([](Experiment& s) { s.replies = "1x"; }).find("replies: found \"1x\""), std::string::npos);
  EXPECT_NE(message([](Experiment& s) { s.session.machine.device = "virtuose"; }).find("device.driver"),
            std::string::npos);
  EXPECT_NE(message([](Experiment& s) { s.session.scene.contact.law = "gravity"; }).find("contact.law"),
            std::string::npos);
}

}  // namespace
}  // namespace tact::lockstep
