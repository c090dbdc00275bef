// Every fault of the simulated device, in mid-contact, in both modes: calm while it lasts, back without a bump.
#include <gtest/gtest.h>

#include "fault/fault.hpp"
#include "loop/rig.hpp"

namespace tact::coupling {
namespace {

struct Case {
  DeviceEvent event;
  std::uint32_t faults;  // named while it lasts
  double duration_s;
};
constexpr double kBegin_s = 2.0;
constexpr std::uint32_t kData = bit(Fault::device_data);

class DeviceFault : public ::testing::TestWithParam<std::tuple<DeviceMode, Case>> {};

TEST_P(DeviceFault, EndsInACalmDeviceAndComesBackWithoutABump) {
  const auto& [mode, fault] = GetParam();
  Rig::Options options;
  options.mode = mode;
  options.motion = straight({0, 0, 0.01}, {0, 0, -0.05}, 0.5);
  options.device = [&fault](SimulatedDevice::Params& p) { p.events = {{kBegin_s, fault.duration_s, fault.event}}; };
  TickQueue records(1000, 20);
  options.records = &records;
  Rig rig(options);
  rig.run(8);
  const GateLimits gate = Rig::config_of(options).gate;
  const double spring = rig.device.capabilities().spring_n_per_m;

  std::uint32_t during = 0, after = 0;
  std::uint64_t first_live = 0, ticks = 0;
  int calm_after = -1;
  double sent_in_contact = 0, largest_step = 0, largest_pull = 0;
  TickRecord last, now;
  ASSERT_TRUE(records.ticks.pop(last));
  for (; records.ticks.pop(now); last = now) {
    ++ticks;
    if (now.live && first_live == 0) first_live = now.tick.index;
    const double since_s =
        first_live == 0 ? -1 : 1e-3 * static_cast<double>(now.tick.index - first_live) - kBegin_s;  // of its events
    // The face of the gate that this mode has, always. A device whose motors are off has no force to step from.
    if (mode == DeviceMode::impedance) {
      const double step = (now.F_sent_W.force - last.F_sent_W.force).norm();
      if (now.reading.engaged) largest_step = std::max(largest_step, step);
      EXPECT_LE(now.F_sent_W.force.norm(), gate.force_n + 1e-9);
    } else {
      largest_pull = std::max(largest_pull, spring * (now.sent.X_W.p - now.X_WH.p).norm());
    }
    if (since_s > -0.01 && since_s < 0) sent_in_contact = std::max(sent_in_contact, now.F_coupling_W.force.norm());
    if (since_s >= 0.003 && since_s < fault.duration_s) {
      during |= now.faults;
      if (now.F_coupling_W.force.norm() == 0 && calm_after < 0) {
        calm_after = static_cast<int>(std::lround(1e3 * since_s));
      }
    }
    if (since_s > fault.duration_s + 1.5) after |= now.faults;
    EXPECT_TRUE(now.tool.X_W.finite());
    EXPECT_LT(-now.tool.X_W.p.z(), 5e-3) << "never through the wall";
  }
  EXPECT_GT(ticks, 7000u);
  EXPECT_NEAR(sent_in_contact, 10, 0.1) << "it pressed when the fault came";
  EXPECT_GE(calm_after, 0);
  EXPECT_LE(calm_after, 20);
  EXPECT_EQ(during & fault.faults, fault.faults) << fault_names(during);
  EXPECT_EQ(after & (fault.faults | bit(Fault::wrench_stale)), 0u) << fault_names(after);
  EXPECT_LE(largest_step, gate.force_slope_n_per_s * 1e-3 + 1e-9);
  EXPECT_LE(largest_pull, gate.force_n + 1e-6);
  EXPECT_NEAR(rig.status.F_contact_W.force.z(), 10, 0.05) << "it presses again";
  EXPECT_LT(rig.status.V_WT.linear.norm(), 1e-3);
}

constexpr Case kCases[] = {{DeviceEvent::dead_man, 0, 1},
                           {DeviceEvent::e_stop, 0, 1},
                           {DeviceEvent::power, 0, 1},
                           {DeviceEvent::indexing, 0, 1},
                           {DeviceEvent::alarm, bit(Fault::device_alarm), 1},
                           {DeviceEvent::lost, bit(Fault::device_lost), 1},
                           {DeviceEvent::nan, kData | bit(Fault::not_finite), 1},
                           {DeviceEvent::jump, kData, 0.02},
                           {DeviceEvent::quaternion, kData, 1}};

INSTANTIATE_TEST_SUITE_P(All, DeviceFault,
                         ::testing::Combine(::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                                            ::testing::ValuesIn(kCases)),
                         [](const auto& i) {
                           std::string name = std::get<0>(i.param) == DeviceMode::impedance ? "Impedance_" : "Pseudo_";
                           for (const char c : std::string(coupling::name(std::get<1>(i.param).event))) {
                             name += c == '-' ? '_' : c;
                           }
                           return name;
                         });

class EachMode : public ::testing::TestWithParam<DeviceMode> {};
INSTANTIATE_TEST_SUITE_P(All, EachMode, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                         [](const auto& i) {
                           return i.param == DeviceMode::impedance ? "Impedance" : "PseudoAdmittance";
                         });

/// Motors too hot do not make the arm calm: they pull with four fifths of what they bear for ever, and it is named.
TEST_P(EachMode, OverheatLimitsTheForceWithoutAStepIsNamedAndTheHandIsPressedAgainOnceItIsOver) {
  constexpr double kContinuous_n = 11, kHot_n = 0.8 * kContinuous_n, kDuration_s = 2;
  Rig::Options options;
  options.mode = GetParam();
  options.motion = straight({0, 0, 0.01}, {0, 0, -0.05}, 0.5);
  options.device = [&](SimulatedDevice::Params& p) {
    p.arm.force_continuous_n = kContinuous_n;
    p.arm.thermal_s = 0.5;
    p.events = {{kBegin_s, kDuration_s, DeviceEvent::overheat}};
  };
  Rig rig(options);
  const GateLimits gate = Rig::config_of(options).gate;
  const double spring = rig.device.capabilities().spring_n_per_m;
  while (!rig.status.engaged) rig.tick();
  rig.run(kBegin_s - 0.1);
  EXPECT_NEAR(rig.device.true_hand_wrench_W().force.norm(), 10, 0.1) << "it pressed when the fault came";
  EXPECT_EQ(rig.status.faults & bit(Fault::device_alarm), 0u);

  std::uint32_t faults_hot = 0;
  double felt_hot = 0, step_max = 0;
  Vec3 felt = rig.device.true_hand_wrench_W().force;
  const auto watch = [&](double seconds, const auto& each) {
    for (int i = 0; i < static_cast<int>(1e3 * seconds); ++i) {
      const Vec3 handle = rig.device.true_X_WH().p;  // as the gate sees it
      rig.tick();
      const Vec3 now = rig.device.true_hand_wrench_W().force;
      step_max = std::max(step_max, (now - felt).norm());
      felt = now;
      EXPECT_LE(rig.status.F_coupling_W.force.norm(), gate.force_n);
      if (GetParam() == DeviceMode::pseudo_admittance) {
        EXPECT_LE(spring * (rig.device.last_set_point().X_W.p - handle).norm(), gate.force_n + 1e-6);
      }
      EXPECT_LT(-rig.status.X_WT.p.z(), 5e-3) << "never through the wall";
      each(i);
    }
  };
  watch(0.1 + kDuration_s, [&](int i) {
    if (i < 1100) return;  // the limit takes half a second, the hand as long
    faults_hot |= rig.status.faults;
    felt_hot = std::max(felt_hot, felt.norm());
  });
  EXPECT_NE(faults_hot & bit(Fault::device_alarm), 0u) << fault_names(faults_hot);
  EXPECT_EQ(faults_hot & bit(Fault::wrench_stale), 0u) << "not calm";
  EXPECT_LT(felt_hot, kHot_n + 0.2);
  EXPECT_GT(felt_hot, kHot_n - 0.2);
  watch(4, [](int) {});
  EXPECT_EQ(rig.status.faults & bit(Fault::device_alarm), 0u);
  EXPECT_NEAR(felt.norm(), 10, 0.1) << "it presses again";
  EXPECT_LT(step_max, 0.1 * gate.force_slope_n_per_s * 1e-3) << "no bump, there or back";
}

}  // namespace
}  // namespace tact::coupling
