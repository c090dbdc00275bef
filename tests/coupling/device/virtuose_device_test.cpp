// The driver against the stand-in library and the arm behind it: a process of its own, in real time.
#include "coupling/device/virtuose/virtuose_device.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <functional>
#include <sstream>
#include <thread>

#include "coupling/device/open_device.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"
#include "rt/alloc_guard.hpp"
#include "virtuose/arm.hpp"

namespace tact::coupling::virtuose {
namespace {

using test::Arm;
using test::stand_in_library;

/// An arm, the driver on it, and a loop that answers each reading: impedance with `F`, pseudo-admittance with `lead`
/// ahead of the handle.
class Rig {
 public:
  explicit Rig(DeviceMode mode, const std::function<void(Arm&)>& before = {}) {
    if (before) before(arm);
    options.name = "virtuose";
    options.mode = name(mode);
    options.virtuose.library = stand_in_library();
    options.virtuose.address = arm.address();
    options.virtuose.timeout_s = 0.05;
    open();
  }

  void open() { device = open_device(options); }

  DeviceReading tick() {
    device->wait_tick();
    const DeviceReading r = device->read();
    if (device->capabilities().mode == DeviceMode::impedance) {
      device->write(r.engaged && r.trusted ? F : Wrench{});
    } else {
      device->write(SetPoint{{r.X_WH.p + (r.engaged && r.trusted ? lead : Vec3::Zero()), r.X_WH.q}, {}});
    }
    for (std::string& text : device->take_news()) news += text + '\n';
    faults |= r.faults;
    return last = r;
  }
  /// Ticks until it holds; a safety net of so many, not a measurement.
  bool until(const std::function<bool(const DeviceReading&)>& condition, int most = 8000) {
    for (int i = 0; i < most; ++i) {
      if (condition(tick())) return true;
    }
    return false;
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) tick();
  }
  bool ready() {
    return until([&](const auto&) { return arm.get("powered") == 1; });
  }
  /// Lets go and grips until it is engaged: the arm has power a little before the loop has the arm.
  bool engage() {
    for (int attempt = 0; attempt < 30; ++attempt) {
      arm.grip(false);
      if (!ready()) return false;
      run(50);
      arm.grip(true);
      if (until([](const auto& r) { return r.engaged; }, 200)) return true;
    }
    return false;
  }
  bool heard(const std::string& text) const { return news.find(text) != std::string::npos; }

  Arm arm;
  DeviceOptions options;
  std::unique_ptr<HapticDevice> device;
  Wrench F;
  Vec3 lead = Vec3::Zero();
  DeviceReading last;
  std::string news;
  std::uint32_t faults = 0;
};

std::string setup_error(const std::function<void()>& what) {
  try {
    what();
  } catch (const SetupError& e) {
    return e.what();
  }
  return "no error";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(VirtuoseLibrary, AMissingOneIsAnErrorThatSaysWhereItWasSoughtAndWhatToDo) {
  const std::string both = setup_error([] { load_library(""); });
  for (const char* part : {"libVirtuoseAPI.so", "virtuoseAPI.so", "device.library", "ldconfig"}) {
    EXPECT_TRUE(contains(both, part)) << both;
  }
  const std::string one = setup_error([] { load_library("/nowhere/libVirtuoseAPI.so"); });
  EXPECT_TRUE(contains(one, "cannot load /nowhere/libVirtuoseAPI.so")) << one;
  EXPECT_TRUE(contains(one, "No such file")) << one;
}

TEST(VirtuoseLibrary, AMissingCallIsNamed) {
  const std::string error = setup_error([] { load_library(stand_in_library(true)); });
  EXPECT_TRUE(contains(error, "lacks virtDetachVO;")) << error;
  EXPECT_EQ(error.find("virtOpen"), error.npos) << error;
}

TEST(VirtuoseLibrary, ItsNamesStayItsOwn) {
  load_library(stand_in_library());
  EXPECT_EQ(::dlsym(RTLD_DEFAULT, "virtOpen"), nullptr);
}

TEST(StandIn, EnforcesTheVendorsRules) {
  Arm arm;
  const Calls c = load_library(stand_in_library()).calls;
  EXPECT_EQ(c.virtOpen("localhost"), nullptr);
  EXPECT_EQ(c.virtGetErrorCode(nullptr), 5);
  EXPECT_NE(c.virtSetTimeStep(nullptr, 0.001F), 0);
  EXPECT_EQ(c.virtGetErrorCode(nullptr), 3);
  const Context v = c.virtOpen(arm.address().c_str());
  ASSERT_NE(v, nullptr);
  const auto error = [&](int result) { return result == 0 ? 0 : c.virtGetErrorCode(v); };
  EXPECT_EQ(c.virtOpen(arm.address().c_str()), nullptr) << "one connection at a time";
  EXPECT_EQ(c.virtGetErrorCode(nullptr), 2);
  EXPECT_EQ(error(c.virtSetPowerOn(v, 1)), 19);
  EXPECT_EQ(error(c.virtSetCommandType(v, 5)), 19);
  EXPECT_EQ(error(c.virtSetTimeStep(v, 0)), 9);
  EXPECT_EQ(error(c.virtSetTimeStep(v, 0.001F)), 0);
  EXPECT_EQ(error(c.virtSetCommandType(v, 4)), 9);
  EXPECT_EQ(error(c.virtSetCommandType(v, 5)), 0);
  EXPECT_EQ(error(c.virtSetForceFactor(v, 1)), 19);
  float wrench[6] = {}, gains[6] = {1, 1, 1, 1, 1, 1}, pose[7] = {0, 0, 0, 0, 0, 0, 1}, zero[7] = {};
  EXPECT_EQ(error(c.virtSetForce(v, wrench)), 17);
  EXPECT_EQ(error(c.virtAttachQSVO(v, gains, gains)), 19);
  EXPECT_EQ(error(c.virtSetPosition(v, zero)), 9);
  pose[0] = 0.1F;
  EXPECT_EQ(error(c.virtSetPosition(v, pose)), 12);
  pose[0] = 0.01F;
  EXPECT_EQ(error(c.virtSetPosition(v, pose)), 0);
  EXPECT_EQ(error(c.virtAttachQSVO(v, gains, gains)), 0);
  EXPECT_EQ(error(c.virtAttachQSVO(v, gains, gains)), 22);
  arm.say("watchdog 0.2");
  EXPECT_TRUE(test::eventually([&] { return arm.get("bites") == 1; }));
  EXPECT_TRUE(test::eventually([&] { return error(c.virtGetPosition(v, pose)) == 2; }));
  EXPECT_EQ(c.virtClose(v), 0);
}

class BothModes : public ::testing::TestWithParam<DeviceMode> {};
INSTANTIATE_TEST_SUITE_P(Virtuose, BothModes, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                         [](const auto& i) { return i.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST_P(BothModes, CallsComeInTheDocumentedOrderAndEndInOrder) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  const bool impedance = GetParam() == DeviceMode::impedance;
  const std::string begun = rig.arm.calls();
  EXPECT_EQ(
      begun,
      std::string(" virtOpen virtSetTimeoutValue virtSetIndexingMode virtSetForceFactor virtSetSpeedFactor "
                  "virtSetTimeStep virtSetBaseFrame virtSetObservationFrame virtSetCommandType "
                  "virtSaturateTorque virtEnableForceFeedback ") +
          (impedance ? "virtSetForce virtSetPowerOn " : "virtSetPosition virtSetSpeed virtSetPowerOn virtAttachQSVO "));
  EXPECT_EQ(rig.arm.get("type"), impedance ? 3 : 5);
  rig.device.reset();
  EXPECT_EQ(rig.arm.calls().substr(begun.size()),
            (impedance ? std::string() : "virtDetachVO ") + "virtSetPowerOn virtClose ");
  EXPECT_EQ(rig.arm.get("open"), 0);
  EXPECT_EQ(rig.arm.get("powered"), 0);
}

TEST_P(BothModes, PosesComeInMetresWithTheScalarPartLast) {
  const Quat q = exp_so3({0.3, -0.5, 0.7});
  Rig rig(GetParam(), [&](Arm& arm) {
    std::ostringstream place;
    place.precision(9);
    place << "place 0.4 -0.1 0.2 " << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w();
    arm.say(place.str());
  });
  ASSERT_TRUE(rig.engage()) << rig.news;
  EXPECT_LT(displacement(rig.last.X_WH, Pose{{0.4, -0.1, 0.2}, q}).norm(), 2e-3);
  EXPECT_LT(displacement(rig.device->last_set_point().X_W, Pose{{0.4, -0.1, 0.2}, q}).norm(), 2e-3);
}

TEST_P(BothModes, NothingMovesOnStartHoweverLongTheMotorsTake) {
  Rig rig(GetParam(), [](Arm& arm) {
    arm.say("hand 0");
    arm.say("place 0.4 -0.1 0.2 0 0 0 1");
    arm.say("dead_man 1");
    arm.say("power_delay 1.2");
    arm.say("reset");
  });
  int ticks = 0;
  EXPECT_TRUE(rig.until([&](const auto& r) {
    ++ticks;
    return !r.engaged && rig.heard("the motors are on");
  })) << rig.news;
  EXPECT_GT(ticks, 50) << "the loop went on ticking meanwhile, as far as a busy machine let it";
  rig.run(300);
  EXPECT_FALSE(rig.last.engaged) << "held since before: it must be let go first";
  EXPECT_TRUE(rig.heard("let go of the handle's dead-man sensor once")) << rig.news;
  EXPECT_LT(rig.arm.get("moved_max"), 1e-6);
  EXPECT_LT(rig.arm.get("force_max"), 1e-3);
  EXPECT_EQ(rig.arm.get("power_ons"), 1);
  rig.arm.grip(false);
  rig.run(20);
  rig.arm.grip(true);
  EXPECT_TRUE(rig.until([](const auto& r) { return r.engaged; }));
}

TEST(VirtuoseDevice, AnArmWithoutPowerUntilItIsHeldEngagesToo) {
  Rig rig(DeviceMode::pseudo_admittance, [](Arm& arm) { arm.say("power_needs_dead_man 1"); });
  rig.run(5500);  // the keeper's patience with the motors
  rig.arm.grip(true);
  EXPECT_TRUE(rig.until([](const auto& r) { return r.engaged; })) << rig.news;
  rig.arm.grip(false);
  EXPECT_TRUE(rig.until([](const auto& r) { return !r.engaged; }));
  rig.arm.grip(true);
  EXPECT_TRUE(rig.until([](const auto& r) { return r.engaged; })) << rig.news;
  EXPECT_EQ(rig.arm.get("power_ons"), 1);
}

TEST_P(BothModes, DeadManAndIndexingEndTheEngagementAndTheNextGripBeginsIt) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  for (const char* word : {"dead_man 0", "shift 1"}) {
    rig.arm.say(word);
    EXPECT_TRUE(rig.until([](const auto& r) { return !r.engaged; })) << word;
    rig.run(400);  // longer than a hand may stand still
    EXPECT_EQ(rig.last.faults, 0u);
    rig.arm.say(word[0] == 'd' ? "dead_man 1" : "shift 0");
    EXPECT_TRUE(rig.until([](const auto& r) { return r.engaged; }, 200)) << word;
    EXPECT_EQ(rig.faults, 0u) << rig.news;
  }
}

TEST_P(BothModes, AfterTheEmergencyStopTheHandMustLetGoOnce) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("chain 0");
  EXPECT_TRUE(rig.until([](const auto& r) { return !r.engaged; }));
  rig.run(100);
  EXPECT_NE(rig.last.faults & bit(Fault::device_alarm), 0u);
  EXPECT_TRUE(rig.heard("the emergency stop is pressed")) << rig.news;
  rig.arm.say("chain 1");
  EXPECT_TRUE(rig.ready());
  rig.run(200);
  EXPECT_EQ(rig.last.faults, 0u);
  EXPECT_FALSE(rig.last.engaged);
  EXPECT_TRUE(rig.engage()) << rig.news;
}

TEST(VirtuoseDevice, MotorsThatGoOffInAGripAreAskedForAgainAndComeBackOnlyByANewGrip) {
  Rig rig(DeviceMode::impedance);
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("power_off");
  EXPECT_TRUE(rig.until([](const auto& r) { return !r.engaged; }));
  EXPECT_TRUE(rig.ready()) << "asked for again after some seconds";
  EXPECT_TRUE(rig.heard("press the arm's power button")) << rig.news;
  rig.run(200);
  EXPECT_FALSE(rig.last.engaged);
  EXPECT_TRUE(rig.engage()) << rig.news;
}

TEST_P(BothModes, AlarmsAreFaultsWithAName) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("alarm 16384");
  EXPECT_TRUE(rig.until([](const auto& r) { return r.faults == bit(Fault::device_alarm); }));
  EXPECT_TRUE(rig.last.engaged) << "the arm reduces its force by itself";
  EXPECT_TRUE(rig.heard("a motor is too hot")) << rig.news;
  rig.arm.say("alarm 0");
  EXPECT_TRUE(rig.until([](const auto& r) { return r.faults == 0; }));
  EXPECT_TRUE(rig.until([&](const auto&) { return rig.heard("alarm over"); })) << rig.news;
  rig.arm.say("alarm 262144");
  EXPECT_TRUE(rig.until([](const auto& r) { return !r.engaged; })) << "a wrong position";
  EXPECT_TRUE(rig.heard("it reports an error of its position; calibrate it")) << rig.news;
}

struct Lie {
  const char *what, *said;
};
class Lying : public ::testing::TestWithParam<std::tuple<DeviceMode, Lie>> {};
INSTANTIATE_TEST_SUITE_P(Virtuose, Lying,
                         ::testing::Combine(::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                                            ::testing::Values(Lie{"nan", "not a number"}, Lie{"jump", "a jump of 200"},
                                                              Lie{"quaternion", "a quaternion of norm 1.1"})),
                         [](const auto& i) {
                           return std::string(name(std::get<0>(i.param))).substr(0, 6) + "_" +
                                  std::get<1>(i.param).what;
                         });

TEST_P(Lying, IsRefusedAtOnceNamedAndEndsTheEngagementWithinTwentyTicks) {
  const auto [mode, lie] = GetParam();
  Rig rig(mode);
  ASSERT_TRUE(rig.engage()) << rig.news;
  const Pose before = rig.last.X_WH;
  rig.arm.say(std::string("lie ") + lie.what);
  ASSERT_TRUE(rig.until([](const auto& r) { return !r.trusted; }));
  int refused = 0;
  EXPECT_TRUE(rig.until([&](const auto& r) {
    // Where a starved machine made the arm let go first, nobody is held and the arm may be anywhere.
    if (r.engaged) {
      EXPECT_LT(displacement(before, r.X_WH).norm(), 0.01) << "the last good pose stands";
    }
    EXPECT_EQ(r.faults & bit(Fault::device_data), r.faults);
    ++refused;
    return !r.engaged;
  }));
  EXPECT_LE(refused, VirtuoseDevice::kRefusedMax);
  EXPECT_TRUE(rig.heard(lie.said)) << rig.news;
  EXPECT_TRUE(rig.until([&](const auto&) { return rig.arm.get("powered") == 0; })) << "motors off";
  rig.arm.say("lie none");
  EXPECT_TRUE(rig.engage()) << rig.news;
  EXPECT_EQ(rig.last.faults, 0u);
}

TEST_P(BothModes, AFrozenArmInAHandIsLostAndComesBack) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("freeze 1");
  EXPECT_TRUE(rig.until([](const auto& r) { return (r.faults & bit(Fault::device_lost)) != 0; }, 1000));
  EXPECT_FALSE(rig.last.engaged);
  EXPECT_TRUE(rig.heard("yet nothing it says has changed")) << rig.news;
  rig.arm.say("freeze 0");
  EXPECT_TRUE(rig.engage()) << rig.news;
}

TEST_P(BothModes, ABrokenLinkIsLostByTheNameOfTheCallAndComesBackByItself) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("watchdog 0.5");
  rig.arm.say("drop 1");
  EXPECT_TRUE(rig.until([](const auto& r) { return (r.faults & bit(Fault::device_lost)) != 0; }, 1000));
  EXPECT_FALSE(rig.last.engaged);
  EXPECT_TRUE(rig.heard("virtGetPosition failed: error 6 (the arm did not answer in time)")) << rig.news;
  EXPECT_TRUE(rig.until([&](const auto&) { return rig.arm.get("bites") == 1; })) << "the arm cut its own power";
  EXPECT_EQ(rig.arm.get("powered"), 0);
  rig.arm.say("drop 0");
  EXPECT_TRUE(rig.engage()) << rig.news;
  EXPECT_EQ(rig.last.faults, 0u);
}

TEST(VirtuoseDevice, AnArmThatDiesIsFoundAgain) {
  Rig rig(DeviceMode::pseudo_admittance);
  ASSERT_TRUE(rig.engage()) << rig.news;
  const int port = rig.arm.port();
  rig.arm.process().signal(SIGKILL);
  EXPECT_TRUE(rig.until([](const auto& r) { return (r.faults & bit(Fault::device_lost)) != 0; }));
  rig.run(1000);
  EXPECT_TRUE(rig.heard("cannot be opened again yet: virtOpen failed")) << rig.news;
  Arm next(port);
  EXPECT_TRUE(rig.until([&](const auto& r) { return r.faults == 0 && next.get("powered") == 1; })) << rig.news;
  rig.run(20);
  next.grip(true);
  EXPECT_TRUE(rig.until([](const auto& r) { return r.engaged; }));
}

TEST(VirtuoseDevice, AWrenchReachesTheHandleWithItsSign) {
  Rig rig(DeviceMode::impedance);
  rig.F = {{1, -2, 3}, {0.1, 0, 0}};
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.run(20);
  EXPECT_NEAR(rig.arm.get("force_x"), 1, 1e-6);
  EXPECT_NEAR(rig.arm.get("force_y"), -2, 1e-6);
  EXPECT_NEAR(rig.arm.get("force_z"), 3, 1e-6);
  EXPECT_NEAR(rig.arm.get("torque_max"), 0.1, 1e-6);
}

TEST(VirtuoseDevice, TheSpringIsTheStatedOneAndItsGainsGoRotationFirst) {
  Rig rig(DeviceMode::pseudo_admittance);
  rig.device.reset();
  rig.options.virtuose.spring_n_per_m = 1500;
  rig.options.virtuose.spring_nm_per_rad = 3;
  rig.options.virtuose.damper_n_s_per_m = 20;
  rig.options.virtuose.damper_nm_s_per_rad = 0.1;
  rig.open();
  ASSERT_TRUE(rig.engage()) << rig.news;
  EXPECT_EQ(rig.device->capabilities().spring_n_per_m, 1500);
  EXPECT_EQ(rig.device->capabilities().spring_nm_per_rad, 3);
  const auto got = rig.arm.get();
  for (const char* key : {"gain0", "gain1", "gain2"}) EXPECT_EQ(got.at(key), 3) << key;
  for (const char* key : {"gain3", "gain4", "gain5"}) EXPECT_EQ(got.at(key), 1500) << key;
  for (const char* key : {"gain6", "gain7", "gain8"}) EXPECT_NEAR(got.at(key), 0.1, 1e-6) << key;
  for (const char* key : {"gain9", "gain10", "gain11"}) EXPECT_EQ(got.at(key), 20) << key;
}

TEST(VirtuoseDevice, TheHandsWrenchIsThatOfTheSpring) {
  Rig rig(DeviceMode::pseudo_admittance);
  rig.lead = Vec3(0.002, 0, 0);  // pulls the handle along +x; the hand resists along -x
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.run(1500);  // carries the hand along until that is at rest or at its limit
  const double pull = rig.device->capabilities().spring_n_per_m * 0.002;
  EXPECT_NEAR(rig.arm.get("force_x"), pull, 0.3 * pull);
  EXPECT_NEAR(rig.last.F_hand_W.force.x(), -pull, 0.3 * pull);
}

TEST_P(BothModes, PowerOffFromAnotherThreadCutsTheMotorsWhateverIsWritten) {
  Rig rig(GetParam());
  rig.F = {{2, 0, 0}, Vec3::Zero()};
  ASSERT_TRUE(rig.engage()) << rig.news;
  std::thread watchdog([&] { rig.device->power_off(); });
  EXPECT_TRUE(rig.until([&](const auto& r) { return !r.engaged && rig.arm.get("powered") == 0; }, 1000));
  watchdog.join();
  rig.run(500);
  EXPECT_EQ(rig.arm.get("powered"), 0);
  EXPECT_EQ(rig.arm.get("force_x"), 0);
}

TEST_P(BothModes, PowerOffCutsTheMotorsAlsoWhenTheLoopIsGone) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.device->power_off();
  EXPECT_EQ(rig.arm.get("powered"), 0);
}

TEST_P(BothModes, ALoopThatStopsWritingIsCutOffByTheArmsOwnWatchdog) {
  Rig rig(GetParam());
  rig.F = {{2, 0, 0}, Vec3::Zero()};
  ASSERT_TRUE(rig.engage()) << rig.news;
  rig.arm.say("watchdog 0.5");
  EXPECT_TRUE(test::eventually([&] { return rig.arm.get("bites") == 1; }));
  EXPECT_EQ(rig.arm.get("powered"), 0);
  EXPECT_EQ(rig.arm.get("force_x"), 0);
  EXPECT_TRUE(rig.until([](const auto& r) { return (r.faults & bit(Fault::device_lost)) != 0; })) << rig.news;
  EXPECT_TRUE(rig.heard("failed: error 2 (communication with the arm failed)")) << rig.news;
  EXPECT_TRUE(rig.engage()) << rig.news;
}

TEST_P(BothModes, AReadAndAWriteDoNotAllocate) {
  Rig rig(GetParam());
  ASSERT_TRUE(rig.engage()) << rig.news;
  const std::uint64_t before = rt::rt_allocations();
  for (int i = 0; i < 100; ++i) {
    rig.device->wait_tick();
    const rt::RtSection guard;
    const DeviceReading r = rig.device->read();
    if (GetParam() == DeviceMode::impedance) {
      rig.device->write(Wrench{});
    } else {
      rig.device->write(SetPoint{r.X_WH, {}});
    }
  }
  EXPECT_EQ(rt::rt_allocations(), before);
}

TEST(VirtuoseDevice, NobodyAtTheAddressIsAnErrorThatNamesItTheCallAndTheReason) {
  DeviceOptions options;
  options.name = "virtuose";
  options.virtuose.library = stand_in_library();
  options.virtuose.address = "127.0.0.1#9";
  const std::string error = setup_error([&] { open_device(options); });
  for (const char* part : {"device.address", "127.0.0.1#9", "virtOpen failed: error 6", "is the arm on"}) {
    EXPECT_TRUE(contains(error, part)) << error;
  }
}

TEST(VirtuoseDevice, CheckingOnlyAsksForNoPower) {
  Rig rig(DeviceMode::impedance);
  rig.device.reset();
  rig.arm.say("reset");
  rig.options.check_only = true;
  rig.open();
  rig.device.reset();
  EXPECT_EQ(rig.arm.get("power_ons"), 0);
  EXPECT_EQ(rig.arm.get("open"), 0);
}

}  // namespace
}  // namespace tact::coupling::virtuose
