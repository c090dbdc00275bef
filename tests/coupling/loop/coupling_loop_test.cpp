#include "coupling/loop/coupling_loop.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fault/fault.hpp"
#include "loop/rig.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::coupling {
namespace {

const Vec3 kStart(0, 0, 0.01);

// Sanitizer builds are a hundred times slower: they look for bad memory, not for stability.
#ifdef TACT_SANITIZED
const std::vector<double> kRates{250}, kWalls{1e4};
#else
const std::vector<double> kRates{250, 500, 1000, 2000, 4000}, kWalls{1e3, 1e4, 1e5, 1e6};
#endif

Rig::Options pressing(DeviceMode mode, double depth = 0.05) {
  Rig::Options options;
  options.mode = mode;
  options.motion = straight(kStart, {0, 0, -depth}, 0.5);
  return options;
}

class BothModes : public ::testing::TestWithParam<DeviceMode> {};
INSTANTIATE_TEST_SUITE_P(All, BothModes, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                         [](const auto& i) {
                           return i.param == DeviceMode::impedance ? "Impedance" : "PseudoAdmittance";
                         });

TEST_P(BothModes, TheToolFollowsTheHandThroughFreeSpace) {
  Rig::Options options;
  options.mode = GetParam();
  options.motion = {{0, 1}, {Pose{kStart, Quat::Identity()}, Pose{{0.05, 0.02, 0.1}, exp_so3({0.2, -0.5, 0.3})}}};
  Rig rig(options);
  rig.run(3.5);
  EXPECT_TRUE(rig.status.script_done);
  EXPECT_LT(displacement(options.motion.X_WM.back(), rig.status.X_WT).norm(), 1e-4);
  EXPECT_LT(rig.status.F_coupling_W.force.norm(), 1e-2);
  EXPECT_EQ(rig.status.stats.force_max_n, 0);
  EXPECT_EQ(rig.status.faults, 0u);
}

TEST_P(BothModes, PressedOnAWallTheToolRestsAtForceOverStiffnessWithTheSaturationForce) {
  Rig rig(pressing(GetParam()));
  rig.run(4);
  // The hand pulls with up to 20 N, the coupling gives way at k x_max = 10 N.
  EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 1e-3);
  EXPECT_NEAR(rig.status.F_coupling_W.force.z(), -10, 1e-3);
  EXPECT_NEAR(-rig.status.X_WT.p.z(), 10.0 / rig.options.k, 1e-6);
  EXPECT_LT(rig.status.V_WT.linear.norm(), 1e-4);
  EXPECT_LE(rig.status.stats.penetration_quasi_static_max_m, 10.0 / rig.options.k * 1.1);
  EXPECT_TRUE(rig.status.capped);
  EXPECT_TRUE(rig.status.engaged);
}

TEST_P(BothModes, UnsaturatedTheWallFeelsTheWholeHand) {
  Rig::Options options = pressing(GetParam(), 0.2);
  options.parameters.saturation = false;
  Rig rig(options);
  rig.run(4);
  EXPECT_NEAR(rig.status.F_contact_W.force.z(), 20, 0.05);
  EXPECT_NEAR(-rig.status.X_WT.p.z(), 20.0 / rig.options.k, 1e-5);
}

TEST_P(BothModes, PressingLightlyIsAChainOfSprings) {
  Rig::Options options = pressing(GetParam(), 0.005);
  Rig rig(options);
  rig.run(5);
  double compliance = 1 / 800.0 + 1 / 2000.0 + 1 / options.k;  // hand, coupling, wall
  if (GetParam() == DeviceMode::pseudo_admittance) compliance += 1 / rig.device.capabilities().spring_n_per_m;
  EXPECT_NEAR(rig.status.F_contact_W.force.z(), 0.005 / compliance, 1e-3);
}

TEST_P(BothModes, RestsOnWallsOfAnyStiffnessAtAnyRate) {
  for (const double rate : kRates) {
    for (const double k : kWalls) {
      Rig::Options options = pressing(GetParam());
      options.rate_hz = rate;
      options.k = k;
      options.b = 0.2 * std::sqrt(k * 0.2);  // a tenth of critical
      Rig rig(options);
      rig.run(3.0);
      double quiet = 0;
      for (int i = 0; i < rate; ++i) {
        rig.tick();
        quiet = std::max(quiet, rig.status.V_WT.vector().norm());
      }
      EXPECT_LT(quiet, 1e-3) << rate << " Hz, k " << k;
      EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 0.05) << rate << " Hz, k " << k;
      EXPECT_LT(rig.status.stats.port_energy_j, 1e-3) << rate << " Hz, k " << k;
    }
  }
}

TEST_P(BothModes, AnUndampedWallUnderTheCapRingsDownAndNeverUp) {
  for (const double rate : {kRates.front(), kRates.back()}) {
    for (const double k : kWalls) {
      Rig::Options options = pressing(GetParam());
      options.rate_hz = rate;
      options.k = k;
      Rig rig(options);
      rig.run(2.0);
      double last = 1e9;
      for (int second = 0; second < 3; ++second) {
        double loudest = 0;
        for (int i = 0; i < rate; ++i) {
          rig.tick();
          loudest = std::max(loudest, rig.status.V_WT.vector().norm());
        }
        EXPECT_LT(loudest, std::max(0.7 * last, 1e-6)) << rate << " Hz, k " << k;
        last = loudest;
      }
    }
  }
}

TEST_P(BothModes, RestsOnAWallWhenRepliesComeTicksLate) {
  for (const int delay : {1, 3, 10}) {
    for (const double rate : {kRates.front(), kRates.back()}) {
      for (const double k : {1e4, 1e5, 1e6, 1e7}) {
        Rig::Options options = pressing(GetParam());
        options.delay = delay;
        options.rate_hz = rate;
        options.k = k;
        Rig rig(options);
        rig.run(4);
        EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 0.2) << delay << " late, " << rate << " Hz, k " << k;
        EXPECT_LT(rig.status.V_WT.linear.norm(), 5e-3) << delay << " late, " << rate << " Hz, k " << k;
      }
    }
  }
}

TEST_P(BothModes, SilenceOfTheServerFadesTheHandsWrenchToZeroWithinTwentyTicksAndReportsIt) {
  Rig rig(pressing(GetParam()));
  rig.run(4);
  rig.wall.silent = true;
  rig.tick();  // uses the reply written before the silence
  double last = 1e9;
  const Vec3 p = rig.status.X_WT.p;
  for (int age = 1; age <= 40; ++age) {
    rig.tick();
    const double force = rig.status.F_coupling_W.force.norm();
    if (age > 5) {
      EXPECT_LE(force, last + 1e-9) << age;
    }
    last = force;
    if (age >= 20) {
      EXPECT_TRUE(rig.status.faults & bit(Fault::wrench_stale)) << age;
    }
  }
  rig.run(0.1);
  EXPECT_EQ(rig.status.F_coupling_W.force.norm(), 0);
  EXPECT_EQ(rig.status.V_WT.linear.norm(), 0);
  EXPECT_LT((rig.status.X_WT.p - p).norm(), 0.5e-3 + 1e-9);  // half a voxel, whatever the hand did
  EXPECT_GT(rig.status.stats.wrench_stale, 100u);
}

TEST_P(BothModes, ReturnsFromCalmByItselfAndWithoutABump) {
  Rig rig(pressing(GetParam()));
  rig.run(4);
  rig.wall.silent = true;
  rig.run(0.5);
  rig.wall.silent = false;
  rig.wall.epoch = 2;
  double last = 0;
  std::uint32_t faults = 0;
  for (int i = 0; i < 3000; ++i) {
    rig.tick();
    faults |= rig.status.faults;
    const double force = rig.status.F_coupling_W.force.norm();
    EXPECT_LT(std::abs(force - last), 0.5) << i;
    last = force;
  }
  EXPECT_TRUE(faults & bit(Fault::peer_restarted));
  EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 1e-2);
  EXPECT_TRUE(rig.status.engaged);
  EXPECT_LT(rig.status.stats.penetration_max_m, 2e-3);
}

TEST_P(BothModes, AStepAllocatesNothingInContactAndOut) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocations are not counted in sanitizer builds";
  Rig rig(pressing(GetParam()));
  const std::uint64_t before = rt::rt_allocations();
  rig.run(3);
  rig.wall.silent = true;
  rig.run(0.2);
  EXPECT_EQ(rt::rt_allocations(), before);
}

TEST_P(BothModes, NonsenseFromTheServerIsNamedAndChangesNothing) {
  Rig rig(pressing(GetParam()));
  rig.run(4);
  ContactReply bad = rig.wall.answer(rig.wall.sample);
  bad.F_W.force.x() = std::nan("");
  for (int i = 0; i < 3; ++i) {
    rig.mail->reply.write(bad);
    rig.tick();
    EXPECT_TRUE(rig.status.faults & bit(Fault::not_finite));
    EXPECT_TRUE(rig.status.X_WT.finite());
    EXPECT_NEAR(rig.status.F_coupling_W.force.z(), -10, 0.1);
  }
}

TEST_P(BothModes, AnInsaneStiffnessFromTheServerIsNamedAndHoldsTheToolNoLonger) {
  Rig rig(pressing(GetParam())), spared(pressing(GetParam()));
  rig.run(4), spared.run(4);
  ContactReply bad = rig.wall.answer(rig.wall.sample);
  bad.K = 1e308 * Mat6::Identity();
  for (int i = 0; i < 3; ++i) {
    bad.pose_seq = rig.wall.sample.seq;
    rig.mail->reply.write(bad);
    rig.tick(), spared.tick();
    EXPECT_TRUE(rig.status.faults & bit(Fault::not_finite));
  }
  const double rest_m = rig.status.X_WT.p.z();
  rig.wall.k *= 2, spared.wall.k *= 2;  // out it goes: as the other, when nothing holds it
  rig.run(0.05), spared.run(0.05);
  EXPECT_FALSE(rig.status.faults & bit(Fault::not_finite));
  EXPECT_GT(std::fabs(spared.status.X_WT.p.z() - rest_m), 1e-4);
  EXPECT_NEAR(rig.status.X_WT.p.z(), spared.status.X_WT.p.z(), 1e-6);
}

TEST_P(BothModes, SwitchingSaturationAndStiffnessWhileRunningMakesNoBump) {
  Rig rig(pressing(GetParam(), 0.005));  // presses with less than F_max
  rig.run(4);
  LoopParameters parameters;
  std::uint64_t version = 0;
  double last = rig.status.F_coupling_W.force.norm();
  for (const double k : {4000.0, 500.0, 2000.0}) {
    parameters.version = ++version;
    parameters.stiffness_n_per_m = k;
    parameters.saturation = version % 2 == 0;
    rig.mail->parameters.write(parameters);
    for (int i = 0; i < 1000; ++i) {
      rig.tick();
      EXPECT_LT(std::abs(rig.status.F_coupling_W.force.norm() - last), 0.3);
      last = rig.status.F_coupling_W.force.norm();
    }
    EXPECT_EQ(rig.status.parameters_version, version);
  }
}

TEST_P(BothModes, TheMouseHoldsTheHandAndLetsGo) {
  Rig::Options options;
  options.mode = GetParam();
  Rig rig(options);
  rig.run(1);
  rig.mail->hand.write({Pose{{0.05, 0, 0.05}, Quat::Identity()}, true});
  rig.run(2);
  EXPECT_LT((rig.status.X_WM.p - Vec3(0.05, 0, 0.05)).norm(), 1e-4);
  EXPECT_LT(rig.status.script_time_s, 0);
  rig.mail->hand.write({Pose{{0.5, 0, 0.05}, Quat::Identity()}, false});
  rig.run(1);
  EXPECT_LT((rig.status.X_WM.p - Vec3(0.05, 0, 0.05)).norm(), 1e-3);
}

TEST_P(BothModes, ADeviceWithoutPowerLeavesTheToolAlone) {
  Rig rig(pressing(GetParam()));
  rig.run(2);
  rig.device.power_off();
  rig.run(0.1);
  EXPECT_FALSE(rig.status.engaged);
  EXPECT_EQ(rig.status.V_WT.linear.norm(), 0);
  EXPECT_EQ(rig.status.F_coupling_W.force.norm(), 0);
}

TEST_P(BothModes, RestingEndsWithoutForce) {
  Rig rig(pressing(GetParam()));
  rig.run(4);
  rig.loop.rest();
  rig.run(0.05);
  EXPECT_EQ(rig.status.F_coupling_W.force.norm(), 0);
  if (GetParam() == DeviceMode::pseudo_admittance) {
    EXPECT_LT(displacement(rig.device.last_set_point().X_W, rig.status.X_WH).norm(), 2e-3);
  }
}

TEST(CouplingLoop, CountsWhatHappened) {
  Rig rig(pressing(DeviceMode::pseudo_admittance));
  rig.run(2);
  rig.tick(3);
  const LoopStats& stats = rig.status.stats;
  EXPECT_EQ(stats.ticks, 2001u);
  EXPECT_EQ(stats.missed_ticks, 3u);
  EXPECT_TRUE(rig.status.faults & bit(Fault::deadline_missed));
  EXPECT_EQ(stats.wrench_fresh, 2000u);  // all but the first
  EXPECT_EQ(stats.wrench_stale, 0u);     // waiting for the first reply is no fault
  EXPECT_EQ(stats.faults_ever & ~bit(Fault::deadline_missed), 0u);
  EXPECT_EQ(stats.round_trip.n, 2000u);
  EXPECT_EQ(stats.contact_compute.max_ns, 20'000);
  EXPECT_EQ(stats.contacts_max, 4u);
  EXPECT_NEAR(stats.net_stiffness_max_n_per_m, rig.options.k, 1e-6);
  EXPECT_GT(stats.force_step_max_n, 0);
  EXPECT_GE(stats.force_step_max_n, stats.force_step_rms_n);
  EXPECT_EQ(rig.loop.progress().load(), 2001u);
}

TEST(CouplingLoop, FastMotionIsCutToTheReportedClearance) {
  Rig::Options options;
  options.start = {0, 0, 0.3};
  options.motion = straight(options.start, {0, 0, -0.3}, 0.3);
  options.mode = DeviceMode::impedance;
  Rig rig(options);
  double deepest_step = 0, last = 0.3;
  for (int i = 0; i < 3000; ++i) {
    rig.tick();
    const double z = rig.wall.sample.X_WT.p.z();
    if (last <= 0.5e-3) deepest_step = std::max(deepest_step, last - z);
    last = z;
  }
  EXPECT_LE(deepest_step, 0.5e-3 + 1e-9);
  EXPECT_LT(rig.status.stats.penetration_max_m, 5e-3);
}

}  // namespace
}  // namespace tact::coupling
