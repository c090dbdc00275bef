// The whole stack on the device `virtuose`: the driver loads the stand-in library as it would the vendor's, and the arm
// behind it is a process of its own, asked what it felt.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>

#include "fault/fault.hpp"
#include "support/observer.hpp"
#include "support/tact_run.hpp"
#include "virtuose/arm.hpp"

namespace tact::test {
namespace {

using std::chrono::seconds;

constexpr double kSlope_n_per_s = 1000;  // of the gate: one newton a tick
/// As the arm feels it. A tick of ours and a period of the arm's are no pair: two or three ticks may fall into one
/// period; and to what the gate lets through, the handle's own motion against the arm's spring and damper adds as much.
constexpr double kStep_n = 6 * kSlope_n_per_s / 1000;

/// A session on the stand-in arm in scene peg. The machine file says it, as on a machine with an arm.
class ArmSession {
 public:
  explicit ArmSession(const std::string& mode)
      : machine_(write_machine(mode)),
        run({"peg", "--machine", machine_, "--for", "300s"}),
        observer(std::make_unique<Observer>(run.session())) {}

  bool active() {
    return eventually([&] { return observer->active() && observer->device().tick > 0; }, seconds{120});
  }
  /// Puts the handle where the tool is, and holds it.
  bool engage() {
    arm->grip(false);
    if (!active() || !eventually([&] { return arm->get("powered") == 1; })) return false;
    const auto& X = observer->device().X_WT;
    std::ostringstream place;
    place << "place " << X.position.x << ' ' << X.position.y << ' ' << X.position.z << ' ' << X.orientation.x << ' '
          << X.orientation.y << ' ' << X.orientation.z << ' ' << X.orientation.w;
    arm->say(place.str());
    return grip();
  }
  /// Lets go and grips until it is engaged: the arm has power a little before the loop has the arm.
  bool grip() {
    for (int attempt = 0; attempt < 20; ++attempt) {
      arm->grip(false);
      if (!eventually([&] { return arm->get("powered") == 1; }) || !ticks(50)) return false;
      arm->grip(true);
      if (eventually([&] { return observer->device().engaged; }, seconds{2})) return true;
    }
    return false;
  }
  /// The hand pushes ten millimetres beyond the hole's wall, half a millimetre away.
  bool press() {
    const auto a = arm->get();
    std::ostringstream aim;
    aim << "aim " << a.at("x") + 0.01 << ' ' << a.at("y") << ' ' << a.at("z");
    arm->say(aim.str());
    return pressing();
  }
  bool pressing() {
    return eventually([&] { return observer->in_steady_contact() && arm->get("force_x") < -3; });
  }
  bool ticks(std::uint64_t n) {
    const auto tick = observer->device().tick;
    return eventually([&] { return observer->device().tick >= tick + n; });
  }
  bool fault(Fault f) {
    return eventually([&] { return (observer->device().faults & bit(f)) != 0; });
  }
  pid_t coupling() {
    const auto health = observer->health("coupling");
    return health ? static_cast<pid_t>(health->pid) : -1;
  }
  bool reported(Fault f) {
    const auto report = run.report();
    return std::any_of(report["faults"].begin(), report["faults"].end(),
                       [&](const auto& one) { return one["name"].template get<std::string>() == fault_names(bit(f)); });
  }
  bool said(const std::string& text) { return run.output().find(text) != std::string::npos || log(text); }

  const ScratchDir dir;
  std::unique_ptr<Arm> arm = std::make_unique<Arm>();

 private:
  std::string write_machine(const std::string& mode) {
    const auto path = dir.path() / "arm.toml";
    std::ofstream(path) << "[device]\ndriver = \"virtuose\"\nmode = \"" << mode << "\"\nlibrary = \""
                        << stand_in_library().string() << "\"\naddress = \"" << arm->address()
                        << "\"\ntimeout_s = 0.05\n[gate]\nforce_limit_n = 15\nforce_slope_n_per_s = " << kSlope_n_per_s
                        << "\n[view]\nenabled = false\n";
    return path.string();
  }
  bool log(const std::string& text) {
    for (const auto& entry : std::filesystem::directory_iterator(run.run_dir())) {
      std::ifstream in(entry.path());
      const std::string all((std::istreambuf_iterator<char>(in)), {});
      if (all.find(text) != std::string::npos) return true;
    }
    return false;
  }
  std::string machine_;

 public:
  TactRun run;
  std::unique_ptr<Observer> observer;
};

class VirtuoseSession : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Modes, VirtuoseSession, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST_P(VirtuoseSession, PressesLetsGoAndGripsAgainWithoutABump) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage()) << s.run.output();
  s.arm->say("reset");
  ASSERT_TRUE(s.press()) << s.run.output();
  auto felt = s.arm->get();
  EXPECT_LE(felt.at("force_max"), 15.01) << "the gate's limit";
  EXPECT_LE(felt.at("force_step_max"), kStep_n);

  s.arm->grip(false);
  EXPECT_TRUE(eventually([&] { return !s.observer->device().engaged; }));
  EXPECT_EQ(s.arm->get("force_x"), 0);
  ASSERT_TRUE(s.ticks(300));
  s.arm->say("reset");
  s.arm->grip(true);
  EXPECT_TRUE(eventually([&] { return s.observer->device().engaged; })) << s.run.output();
  ASSERT_TRUE(s.ticks(500));
  felt = s.arm->get();
  EXPECT_LE(felt.at("force_step_max"), 1.0) << "it comes in by the ramp";
  EXPECT_LE(felt.at("force_max"), 15.01);

  s.arm->say("shift 1");
  EXPECT_TRUE(eventually([&] { return !s.observer->device().engaged; })) << "indexing";
  EXPECT_EQ(s.arm->get("force_x"), 0);
  s.arm->say("shift 0");
  EXPECT_TRUE(eventually([&] { return s.observer->device().engaged; }));
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
  felt = s.arm->get();
  EXPECT_EQ(felt.at("powered"), 0);
  EXPECT_EQ(felt.at("open"), 0) << "closed in order";
  EXPECT_EQ(felt.at("bites"), 0);
  EXPECT_FALSE(s.reported(Fault::device_lost)) << s.run.report()["faults"].dump(2);
}

TEST_P(VirtuoseSession, AfterTheEmergencyStopForceNeedsANewGrip) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage() && s.press()) << s.run.output();
  s.arm->say("chain 0");
  EXPECT_TRUE(s.fault(Fault::device_alarm));
  EXPECT_TRUE(eventually([&] { return !s.observer->device().engaged; }));
  s.arm->say("chain 1");
  EXPECT_TRUE(eventually([&] { return s.arm->get("powered") == 1; }));
  s.arm->say("reset");
  ASSERT_TRUE(s.ticks(1000));
  EXPECT_FALSE(s.observer->device().engaged);
  EXPECT_LT(s.arm->get("force_max"), 0.05) << "still in the hand: nothing is felt";
  EXPECT_TRUE(s.said("the emergency stop is pressed"));
  EXPECT_TRUE(s.grip() && s.press()) << s.run.output();
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
  EXPECT_TRUE(s.reported(Fault::device_alarm));
}

TEST_P(VirtuoseSession, WhenCouplingIsKilledTheArmCutsItsPowerAndTheNextOneWaitsForANewGrip) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage() && s.press()) << s.run.output();
  const pid_t victim = s.coupling();
  ASSERT_GT(victim, 0);
  kill(victim, SIGKILL);
  EXPECT_TRUE(eventually([&] { return s.arm->get("bites") == 1; })) << "two seconds, as the vendor says";
  EXPECT_EQ(s.arm->get("force_x"), 0);
  ASSERT_TRUE(
      eventually([&] { return s.coupling() > 0 && s.coupling() != victim && s.observer->active(); }, seconds{60}))
      << s.run.output();
  ASSERT_TRUE(eventually([&] { return s.arm->get("powered") == 1; })) << s.run.output();
  s.arm->say("reset");
  ASSERT_TRUE(s.ticks(1000));
  EXPECT_FALSE(s.observer->device().engaged) << "still in the hand";
  EXPECT_LT(s.arm->get("force_max"), 0.05);
  EXPECT_TRUE(s.engage() && s.press()) << s.run.output();
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
}

TEST_P(VirtuoseSession, AnArmThatStopsOrDiesIsLostAndFoundAgain) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage() && s.press()) << s.run.output();
  const pid_t coupling = s.coupling();
  s.arm->process().signal(SIGSTOP);
  EXPECT_TRUE(s.fault(Fault::device_lost));
  EXPECT_TRUE(eventually([&] { return !s.observer->device().engaged; }));
  EXPECT_TRUE(s.ticks(1000)) << "the loop goes on";
  s.arm->process().signal(SIGCONT);
  EXPECT_TRUE(s.engage() && s.press()) << s.run.output();

  const int port = s.arm->port();
  s.arm->process().signal(SIGKILL);
  EXPECT_TRUE(s.fault(Fault::device_lost));
  s.arm.reset();
  s.arm = std::make_unique<Arm>(port);
  EXPECT_TRUE(s.engage() && s.press()) << s.run.output();
  EXPECT_EQ(s.coupling(), coupling) << "the same process all the time";
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
  EXPECT_TRUE(s.reported(Fault::device_lost)) << s.run.report()["faults"].dump(2);
}

TEST_P(VirtuoseSession, AnArmThatIsHeardLateAgainAndAgainStaysWithinTheGateAndComesBack) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage() && s.press()) << s.run.output();
  const pid_t coupling = s.coupling();
  s.arm->say("reset");
  for (int i = 0; i < 15; ++i) {
    s.arm->say("drop 1");
    EXPECT_TRUE(s.ticks(60)) << "the loop goes on";
    s.arm->say("drop 0");
    EXPECT_TRUE(s.ticks(20));
  }
  EXPECT_LE(s.arm->get("force_max"), 15.01);
  EXPECT_TRUE(s.engage() && s.press()) << s.run.output();
  EXPECT_LE(s.arm->get("force_max"), 15.01);
  EXPECT_EQ(s.coupling(), coupling) << "the same process all the time";
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
}

TEST_P(VirtuoseSession, ALyingArmIsCalmedAtTheGatesSlope) {
  ArmSession s(GetParam());
  ASSERT_TRUE(s.engage()) << s.run.output();
  for (const char* lie : {"nan", "quaternion", "jump"}) {
    SCOPED_TRACE(lie);
    ASSERT_TRUE(s.press()) << s.run.output();
    s.arm->say("reset");
    s.arm->say(std::string("lie ") + lie);
    EXPECT_TRUE(s.fault(Fault::device_data));
    EXPECT_TRUE(eventually([&] { return s.arm->get("powered") == 0; })) << "motors off in the end";
    const auto felt = s.arm->get();
    EXPECT_LE(felt.at("force_max"), 15.01);
    EXPECT_LE(felt.at("force_step_max"), kStep_n);
    s.arm->say("lie none");
    ASSERT_TRUE(s.engage()) << s.run.output();
  }
  EXPECT_TRUE(s.said("refused what the arm says"));
  EXPECT_EQ(s.run.stop(), 0) << s.run.output();
  EXPECT_TRUE(s.reported(Fault::device_data)) << s.run.report()["faults"].dump(2);
}

TEST(VirtuoseStart, WithoutTheLibraryEndsWithOneErrorThatSaysWhatToDo) {
  TactRun run({"peg", "--view", "off", "--device", "virtuose"});
  EXPECT_NE(run.wait(), 0);
  for (const char* part : {"device.library", "libVirtuoseAPI.so", "Haption delivers it with the arm"}) {
    EXPECT_NE(run.output().find(part), std::string::npos) << run.output();
  }
}

TEST(VirtuoseDoctor, SaysWhetherTheLibraryOfTheMachineFileLoads) {
  const ScratchDir dir;
  const auto doctor = [&](const std::string& library) {
    const auto file = dir.path() / "arm.toml";
    std::ofstream(file) << "[device]\ndriver = \"virtuose\"\nlibrary = \"" << library << "\"\n";
    Process process({TactRun::program(), "doctor", "--machine", file}, dir.path() / "said.txt");
    EXPECT_TRUE(process.wait(seconds{60}).has_value());
    return process.output();
  };
  EXPECT_NE(doctor(stand_in_library()).find("loads and has all calls"), std::string::npos);
  const std::string incomplete = doctor(stand_in_library(true));
  EXPECT_NE(incomplete.find("lacks virtDetachVO"), std::string::npos) << incomplete;
  const std::string missing = doctor("/nowhere/libVirtuoseAPI.so");
  EXPECT_NE(missing.find("cannot load /nowhere/libVirtuoseAPI.so"), std::string::npos) << missing;
}

}  // namespace
}  // namespace tact::test
