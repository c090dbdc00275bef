#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <future>
#include <map>
#include <random>
#include <thread>

#include "fault/fault.hpp"
#include "loop/rig.hpp"
#include "rt/alloc_guard.hpp"

namespace tact::coupling {
namespace {

const Vec3 kStart(0, 0, 0.01);

#ifdef TACT_SANITIZED
const std::vector<double> kRates{500};
#else
const std::vector<double> kRates{500, 1000, 2000, 4000};
#endif

struct Combination {
  DeviceMode mode;
  CouplingKind kind;
  Integrator integrator;
};
std::string name_of(const Combination& c) {
  return std::string(c.mode == DeviceMode::impedance ? "Impedance" : "PseudoAdmittance") +
         (c.kind == CouplingKind::direct         ? "Direct"
          : c.kind == CouplingKind::quasi_static ? "Static"
                                                 : "Dynamic") +
         (c.integrator == Integrator::implicit ? "Implicit" : "SemiImplicit");
}

constexpr auto kImpedance = DeviceMode::impedance, kAdmittance = DeviceMode::pseudo_admittance;
constexpr auto kDirect = CouplingKind::direct, kStatic = CouplingKind::quasi_static, kDynamic = CouplingKind::dynamic;
constexpr auto kImplicit = Integrator::implicit, kSemiImplicit = Integrator::semi_implicit;

/// Everything that runs.
const std::vector<Combination> kAll{{kImpedance, kDirect, kImplicit},   {kImpedance, kStatic, kImplicit},
                                    {kImpedance, kDynamic, kImplicit},  {kImpedance, kDynamic, kSemiImplicit},
                                    {kAdmittance, kDirect, kImplicit},  {kAdmittance, kDirect, kSemiImplicit},
                                    {kAdmittance, kStatic, kImplicit},  {kAdmittance, kStatic, kSemiImplicit},
                                    {kAdmittance, kDynamic, kImplicit}, {kAdmittance, kDynamic, kSemiImplicit}};

Rig::Options with(const Combination& c) {
  Rig::Options options;
  options.mode = c.mode;
  options.parameters.kind = c.kind;
  options.parameters.integrator = c.integrator;
  return options;
}

Rig::Options pressing(const Combination& c, double depth) {
  Rig::Options options = with(c);
  options.motion = straight(kStart, {0, 0, -depth}, 0.5);
  options.k = 5000;
  options.b = 0.4 * std::sqrt(options.k * 0.2);
  return options;
}

class EachCombination : public ::testing::TestWithParam<Combination> {};
INSTANTIATE_TEST_SUITE_P(All, EachCombination, ::testing::ValuesIn(kAll),
                         [](const auto& i) { return name_of(i.param); });

TEST_P(EachCombination, TheToolFollowsTheHandThroughFreeSpace) {
  Rig::Options options = with(GetParam());
  options.motion = {{0, 1}, {Pose{kStart, Quat::Identity()}, Pose{{0.05, 0.02, 0.1}, exp_so3({0.2, -0.5, 0.3})}}};
  Rig rig(options);
  rig.run(4);
  EXPECT_LT(displacement(options.motion.X_WM.back(), rig.status.X_WT).norm(), 1e-3);
  EXPECT_LT(rig.status.F_coupling_W.force.norm(), 1e-2);
  EXPECT_EQ(rig.status.stats.static_unsolved_ticks, 0u);
}

/// Where it rests, pressed lightly (a chain of springs) and hard (the cap, or for direct coupling the hand's strength):
/// the same at every rate, and in closed form.
TEST_P(EachCombination, RestsAtTheSamePoseAndWrenchAtEveryRate) {
  const Combination c = GetParam();
  for (const double depth : {0.004, 0.08}) {
    for (const double rate : kRates) {
      Rig::Options options = pressing(c, depth);
      options.rate_hz = rate;
      Rig rig(options);
      rig.run(c.integrator == kSemiImplicit ? 8 : 5);
      double compliance = 1 / 800.0 + 1 / options.k;
      if (c.kind != kDirect) compliance += 1 / 2000.0;
      if (c.mode == kAdmittance) compliance += 1 / rig.device.capabilities().spring_n_per_m;
      const double force = std::min(depth / compliance, c.kind == kDirect ? 20.0 : 10.0);
      const std::string where = name_of(c) + ", " + std::to_string(rate) + " Hz, " + std::to_string(depth) + " m";
      EXPECT_NEAR(rig.status.F_contact_W.force.z(), force, 2e-3 * force) << where;
      EXPECT_NEAR(rig.status.F_coupling_W.force.z(), -force, 2e-3 * force) << where;
      EXPECT_NEAR(rig.status.X_WT.p.z(), -force / options.k, 2e-3 * force / options.k) << where;
      EXPECT_LT(rig.status.X_WT.p.head<2>().norm() + log_so3(rig.status.X_WT.q).norm(), 1e-6) << where;
      EXPECT_LT(rig.status.V_WT.linear.norm(), 1e-3) << where;
    }
  }
}

TEST_P(EachCombination, MovesNoFartherThanHalfAVoxelOrTheClearanceOfTheLastReply) {
  Rig::Options options = with(GetParam());
  options.start = {0, 0, 0.1};
  options.motion = straight(options.start, {0, 0, -0.1}, 0.1);  // 2 m/s into the wall
  Rig rig(options);
  Pose answered = Pose{options.start, Quat::Identity()};
  double clearance = 0;
  std::size_t sent = 0;
  const MotionLimit limit{0.03};
  for (int i = 0; i < 2000; ++i) {
    rig.tick();
    const Pose& X = rig.wall.sample.X_WT;  // the pose just asked for
    if (sent++ > 0) {
      ASSERT_LE(limit.motion_m(answered, X), std::max(0.5e-3, clearance) * (1 + 1e-9) + 1e-12) << i;
    }
    answered = X;
    clearance = rig.wall.answer(rig.wall.sample).clearance_m;
  }
  EXPECT_NE(rig.status.stats.faults_ever & bit(Fault::motion_capped), 0u) << "the test is fast enough";
}

TEST_P(EachCombination, LockedTheToolKeepsItsOrientationAndTheHandGetsNoTorque) {
  Rig::Options options = pressing(GetParam(), 0.02);
  options.rotation_locked = true;
  options.motion.X_WM.back().q = exp_so3({0.3, 0.2, 0.1});
  Rig rig(options);
  for (int i = 0; i < 3000; ++i) {
    rig.tick();
    ASSERT_LT(log_so3(rig.status.X_WT.q).norm(), 1e-12);
    ASSERT_EQ(rig.status.F_coupling_W.torque.norm(), 0);
  }
  EXPECT_GT(rig.status.F_contact_W.force.z(), 5);
}

TEST_P(EachCombination, AStepAllocatesNothing) {
  if (!rt::alloc_hooks_active()) GTEST_SKIP() << "allocations are not counted in sanitizer builds";
  Rig::Options options = pressing(GetParam(), 0.05);
  options.parameters.passivity_controller = true;
  Rig rig(options);
  const std::uint64_t before = rt::rt_allocations();
  rig.run(2);
  EXPECT_EQ(rt::rt_allocations(), before);
}

class BothDeviceModes : public ::testing::TestWithParam<DeviceMode> {};
INSTANTIATE_TEST_SUITE_P(All, BothDeviceModes, ::testing::Values(kImpedance, kAdmittance));

TEST_P(BothDeviceModes, SwitchingBetweenAllCouplingsIntegratorsAndSaturationInContactMakesNoStep) {
  Rig rig(
      pressing({GetParam(), kDynamic, kImplicit}, 0.006));  // less than the cap, so that all rest at nearly the same
  rig.run(4);
  std::mt19937 random(1);
  LoopParameters parameters;
  Wrench last = rig.device.true_hand_wrench_W();
  Pose X_sent = rig.device.last_set_point().X_W;
  std::uint32_t faults = 0;
  for (int change = 0; change < 60; ++change) {
    std::vector<Combination> choices;
    for (const Combination& c : kAll) {
      if (c.mode == GetParam()) choices.push_back(c);
    }
    const Combination& c = choices[random() % choices.size()];
    parameters.kind = c.kind;
    parameters.integrator = c.integrator;
    parameters.saturation = random() % 2 == 0;
    ++parameters.version;
    rig.mail->parameters.write(parameters);
    for (auto n = 50 + random() % 600; n > 0; --n) {
      rig.tick();
      faults |= rig.status.faults;
      ASSERT_LT((rig.device.true_hand_wrench_W().force - last.force).norm(), 0.4) << change << " " << name_of(c);
      ASSERT_LT((rig.device.last_set_point().X_W.p - X_sent.p).norm(), 2e-4) << change << " " << name_of(c);
      last = rig.device.true_hand_wrench_W();
      X_sent = rig.device.last_set_point().X_W;
    }
    ASSERT_EQ(rig.status.parameters_version, parameters.version);
  }
  EXPECT_EQ(faults & (bit(Fault::gate_limited) | bit(Fault::not_finite)), 0u) << fault_names(faults);
}

/// Only direct coupling in impedance waits, and gets the wrench of the tick's own pose.
TEST(DirectCoupling, TheHandGetsTheWrenchOfItsOwnPoseInTheSameTickAndNobodyWaitsForASilentServer) {
  Rig::Options options = pressing({kImpedance, kDirect, kImplicit}, 0.02);
  LoopConfig config = Rig::config_of(options);
  config.rate_hz = options.rate_hz = 100;  // 4 ms of waiting, for a server thread on a busy machine
  config.reply_wait_share = 0.4;
  SimulatedDevice device(Rig::device_of(options), options.motion, Pose{options.start, Quat::Identity()});
  const auto mail = std::make_unique<Mailboxes>();
  CouplingLoop loop(config, device, *mail, nullptr);
  HalfSpace wall;
  wall.k = options.k / 4;
  LoopStatus status;
  std::uint64_t index = 0;
  const auto tick = [&] {
    const std::int64_t now = rt::monotonic_ns();
    loop.step({index++, now, now, 10'000'000, 0});
    mail->status.read(status);
  };
  {
    std::atomic<bool> stop{false};
    std::atomic<std::uint64_t> answered{0};
    std::thread server([&] {
      ToolSample pose;
      while (!stop) {
        if (!mail->tool_ready.wait(1'000'000) || !mail->tool.read(pose)) continue;
        mail->reply.write(wall.answer(pose));
        mail->reply_ready.ring();
        answered = pose.seq;
      }
    });
    int same_tick = 0, in_contact = 0;
    for (int i = 0; i < 300; ++i) {
      tick();
      while (answered < index) std::this_thread::yield();  // nobody keeps the grid: calm, the loop would race ahead
      const double own = std::max(0.0, -options.k * status.X_WT.p.z());
      if (own == 0) continue;
      ++in_contact;
      same_tick += std::abs(status.F_contact_W.force.z() - own) < 1e-9 ? 1 : 0;
    }
    stop = true;
    server.join();
    EXPECT_GT(in_contact, 100);
    EXPECT_GT(same_tick, in_contact / 2);  // a busy machine may be late; without waiting it is never the same tick
  }
  const std::uint64_t before = status.stats.ticks;
  for (int i = 0; i < 30; ++i) tick();
  EXPECT_EQ(status.stats.ticks, before + 30);
  EXPECT_NE(status.faults & bit(Fault::wrench_stale), 0u);
}

/// A period of hours: a single wait of forty percent of it would outlast the test.
TEST(DirectCoupling, WhileCalmItWaitsForNobody) {
  const Rig::Options options = pressing({kImpedance, kDirect, kImplicit}, 0.02);
  LoopConfig config = Rig::config_of(options);
  config.rate_hz = 1e-4;
  config.reply_wait_share = 0.4;
  SimulatedDevice device(Rig::device_of(options), options.motion, Pose{options.start, Quat::Identity()});
  const auto mail = std::make_unique<Mailboxes>();
  auto loop = std::make_unique<CouplingLoop>(config, device, *mail, nullptr);
  auto ticks = std::async(std::launch::async, [&] {
    LoopStatus status;
    for (std::uint64_t i = 0; i < 10; ++i) {
      const std::int64_t now = rt::monotonic_ns();
      loop->step({i, now, now, 10'000'000'000'000, 0});
    }
    mail->status.read(status);
    return status.stats.ticks;
  });
  if (ticks.wait_for(std::chrono::minutes{1}) != std::future_status::ready) {
    std::fprintf(stderr, "DirectCoupling.WhileCalmItWaitsForNobody: it waits\n");
    std::_Exit(1);  // a future waits for its thread
  }
  EXPECT_EQ(ticks.get(), 10u);
}

/// Force of the hand over acceleration of the handle, moved to and fro slowly in free space: least squares for
/// F = m a + b v, the hand's own mass left out.
double felt_mass_kg(const Combination& c) {
  Rig::Options options = with(c);
  HandMotion motion;
  for (int i = 0; i <= 400; ++i) {
    motion.time_s.push_back(0.01 * i);
    motion.X_WM.push_back({{0.03 * (1 - std::cos(2 * M_PI * 1.0 * 0.01 * i)), 0, 0.05}, Quat::Identity()});
  }
  options.start = {0, 0, 0.05};
  options.motion = motion;
  Rig rig(options);
  rig.run(1.5);
  Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
  Eigen::Vector2d r = Eigen::Vector2d::Zero();
  double v_last = rig.device.read().V_WH.linear.x(), F_last = rig.device.true_hand_wrench_W().force.x();
  for (int i = 0; i < 2000; ++i) {
    rig.tick();
    const double v = rig.device.read().V_WH.linear.x(), F = rig.device.true_hand_wrench_W().force.x();
    const Eigen::Vector2d x((v - v_last) * options.rate_hz, 0.5 * (v + v_last));
    A += x * x.transpose();
    r += x * 0.5 * (F + F_last);
    v_last = v;
    F_last = F;
  }
  return A.inverse().row(0).dot(r) - SimulatedHand::Params{}.mass_kg;
}

TEST_P(EachCombination, TheMassFeltInFreeMotionIsThatOfTheArmAndTheBodiesBehindIt) {
  const Combination c = GetParam();
  const double arm = SimulatedArm::Params{}.mass_kg, body = 0.2;
  double expected = arm;
  if (c.kind == kDynamic) expected += body;     // the tool
  if (c.mode == kAdmittance) expected += body;  // the handle body
  const double felt = felt_mass_kg(c);
  EXPECT_NEAR(felt, expected, 0.05 * expected);
  std::printf("felt mass, %s: %.3f kg\n", name_of(c).c_str(), felt);
}

}  // namespace
}  // namespace tact::coupling
