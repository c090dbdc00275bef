// tact-coupling as a process on the device `virtuose`: the driver loads the stand-in library as it would the vendor's,
// the arm behind it is a process of its own, asked what it felt; a contact server in closed form is a third.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "fault/fault.hpp"
#include "link/roudi.hpp"
#include "session/session.hpp"
#include "support/observer.hpp"
#include "virtuose/arm.hpp"

namespace tact::test {
namespace {

using std::chrono::seconds;

constexpr double kLimit_n = 15, kSlope_n_per_s = 1000;  // of the gate: one newton a tick
/// As the arm feels it. A tick of ours and a period of the arm's are no pair: two or three ticks may fall into one
/// period; and to what the gate lets through, the handle's own motion against the arm's spring and damper adds as much.
constexpr double kStep_n = 6 * kSlope_n_per_s / 1000;

class VirtuoseProgram : public ::testing::TestWithParam<std::string> {
 protected:
  static void SetUpTestSuite() { lease_ = std::make_unique<RoudiLease>(share_dir() / "roudi.toml"); }
  static void TearDownTestSuite() { lease_.reset(); }

  VirtuoseProgram() {
    Session session;
    session.name = std::to_string(::getpid()) + "-arm" + std::to_string(sessions_++);
    session.id = 7;
    session.run_dir = dir_.path();
    session.machine.device = "virtuose";
    session.machine.mode = GetParam();
    session.machine.virtuose.library = stand_in_library();
    session.machine.virtuose.address = arm_->address();
    session.machine.virtuose.timeout_s = 0.05;
    session.machine.force_limit_n = kLimit_n;
    session.machine.force_slope_n_per_s = kSlope_n_per_s;
    session.scene.name = session.scene.title = "half-space";
    session.scene.obstacle.shape = session.scene.tool.shape = "box";
    session.scene.start_X_WM.p = {0, 0, 0.005};
    save_session(session, file_);
    observer_ = std::make_unique<Observer>(session.name);
    server_ = start({TACT_SERVER, file_});
    coupling_ = start_coupling();
  }
  std::unique_ptr<Process> start(std::vector<std::string> command) {
    return std::make_unique<Process>(std::move(command), dir_.path() / ("log" + std::to_string(logs_++)));
  }
  std::unique_ptr<Process> start_coupling() { return start({TACT_COUPLING, "--session", file_}); }

  bool active() {
    return eventually([&] { return observer_->active() && observer_->device().tick > 0; });
  }
  bool engaged() { return observer_->device().engaged; }
  /// Lets go and grips until it is engaged: the arm has power a little before the loop has the arm.
  bool grip() {
    for (int attempt = 0; attempt < 20; ++attempt) {
      arm_->grip(false);
      if (!eventually([&] { return arm_->get("powered") == 1; }) || !ticks(50)) return false;
      arm_->grip(true);
      if (eventually([&] { return engaged(); }, seconds{2})) return true;
    }
    return false;
  }
  /// Puts the handle where the tool is, and holds it.
  bool engage() {
    arm_->grip(false);
    if (!active()) return false;
    const auto& X = observer_->device().X_WT;
    std::ostringstream place;
    place << "place " << X.position.x << ' ' << X.position.y << ' ' << X.position.z << " 0 0 0 1";
    arm_->say(place.str());
    return grip();
  }
  /// The hand goes ten millimetres below the surface, as far as that lets it.
  bool press() {
    arm_->say("aim 0 0 -0.01");
    return eventually([&] { return observer_->in_steady_contact() && arm_->get("force_z") > 3; });
  }
  bool ticks(std::uint64_t n) {
    const auto tick = observer_->device().tick;
    return eventually([&] { return observer_->device().tick >= tick + n; });
  }
  bool fault(Fault f) {
    return eventually([&] { return (observer_->device().faults & bit(f)) != 0; });
  }
  bool let_go() {
    return eventually([&] { return !engaged(); });
  }
  void expect_within_the_gate() {
    const auto felt = arm_->get();
    EXPECT_LE(felt.at("force_max"), kLimit_n + 0.01);
    EXPECT_LE(felt.at("force_step_max"), kStep_n);
  }
  void end_in_order() {
    coupling_->signal(SIGTERM);
    EXPECT_EQ(coupling_->wait(seconds{20}), 0) << coupling_->output();
    EXPECT_EQ(arm_->get("powered"), 0);
    EXPECT_EQ(arm_->get("open"), 0);
  }
  bool said(const std::string& text) const { return coupling_->output().find(text) != std::string::npos; }

  static inline std::unique_ptr<RoudiLease> lease_;
  static inline int sessions_ = 0;
  const ScratchDir dir_;
  const std::filesystem::path file_ = dir_.path() / "session.toml";
  std::unique_ptr<Arm> arm_ = std::make_unique<Arm>();
  int logs_ = 0;
  std::unique_ptr<Observer> observer_;
  std::unique_ptr<Process> server_, coupling_;
};

INSTANTIATE_TEST_SUITE_P(Modes, VirtuoseProgram, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST_P(VirtuoseProgram, PressesLetsGoAndGripsAgainWithoutABump) {
  ASSERT_TRUE(engage()) << coupling_->output();
  arm_->say("reset");
  ASSERT_TRUE(press()) << coupling_->output();
  expect_within_the_gate();

  arm_->grip(false);
  EXPECT_TRUE(let_go());
  EXPECT_EQ(arm_->get("force_z"), 0);
  ASSERT_TRUE(ticks(300));
  arm_->say("reset");
  arm_->grip(true);
  EXPECT_TRUE(eventually([&] { return engaged(); })) << coupling_->output();
  ASSERT_TRUE(ticks(500));
  EXPECT_LE(arm_->get("force_step_max"), 1.0) << "it comes in by the ramp";
  EXPECT_LE(arm_->get("force_max"), kLimit_n + 0.01);

  arm_->say("shift 1");
  EXPECT_TRUE(let_go()) << "indexing";
  EXPECT_EQ(arm_->get("force_z"), 0);
  arm_->say("shift 0");
  EXPECT_TRUE(eventually([&] { return engaged(); }));
  end_in_order();
  EXPECT_EQ(arm_->get("bites"), 0);
  EXPECT_FALSE(said("lost")) << coupling_->output();
}

TEST_P(VirtuoseProgram, AfterTheEmergencyStopForceNeedsANewGrip) {
  ASSERT_TRUE(engage() && press()) << coupling_->output();
  arm_->say("chain 0");
  EXPECT_TRUE(fault(Fault::device_alarm));
  EXPECT_TRUE(let_go());
  arm_->say("chain 1");
  EXPECT_TRUE(eventually([&] { return arm_->get("powered") == 1; }));
  ASSERT_TRUE(ticks(200));
  arm_->say("reset");
  ASSERT_TRUE(ticks(500));
  EXPECT_FALSE(engaged());
  if (GetParam() == "impedance") {
    EXPECT_EQ(arm_->get("force_max"), 0) << "still in the hand: nothing is felt";
  } else {
    EXPECT_LT(arm_->get("force_max"), 0.5) << "no more than the damper on a hand that trembles";
  }
  EXPECT_TRUE(said("the emergency stop is pressed")) << coupling_->output();
  EXPECT_TRUE(engage() && press()) << coupling_->output();
  end_in_order();
}

TEST_P(VirtuoseProgram, WhenCouplingIsKilledTheArmCutsItsPowerAndTheNextOneWaitsForANewGrip) {
  ASSERT_TRUE(engage() && press()) << coupling_->output();
  coupling_->signal(SIGKILL);
  coupling_->wait(seconds{5});
  coupling_ = start_coupling();  // at once, as the supervisor does: the arm still belongs to the dead one
  EXPECT_TRUE(eventually([&] { return arm_->get("bites") == 1; })) << "after two seconds, as the vendor says";
  EXPECT_EQ(arm_->get("force_z"), 0);
  ASSERT_TRUE(eventually([&] { return arm_->get("powered") == 1; })) << coupling_->output();
  ASSERT_TRUE(active() && ticks(200));
  arm_->say("reset");
  ASSERT_TRUE(ticks(500));
  EXPECT_FALSE(engaged()) << "still in the hand";
  EXPECT_LT(arm_->get("force_max"), 0.5);
  EXPECT_TRUE(engage() && press()) << coupling_->output();
  end_in_order();
}

TEST_P(VirtuoseProgram, AnArmThatStopsOrDiesIsLostAndFoundAgain) {
  ASSERT_TRUE(engage() && press()) << coupling_->output();
  arm_->process().signal(SIGSTOP);
  EXPECT_TRUE(fault(Fault::device_lost));
  EXPECT_TRUE(let_go());
  EXPECT_TRUE(ticks(1000)) << "the loop goes on";
  arm_->process().signal(SIGCONT);
  EXPECT_TRUE(engage() && press()) << coupling_->output();

  const int port = arm_->port();
  arm_->process().signal(SIGKILL);
  EXPECT_TRUE(fault(Fault::device_lost));
  arm_.reset();
  arm_ = std::make_unique<Arm>(port);
  EXPECT_TRUE(engage() && press()) << coupling_->output();
  EXPECT_TRUE(said("failed: error")) << coupling_->output();
  end_in_order();
}

TEST_P(VirtuoseProgram, ALyingArmIsCalmedAtTheGatesSlope) {
  ASSERT_TRUE(engage()) << coupling_->output();
  for (const char* lie : {"nan", "quaternion", "jump"}) {
    SCOPED_TRACE(lie);
    ASSERT_TRUE(press()) << coupling_->output();
    arm_->say("reset");
    arm_->say(std::string("lie ") + lie);
    EXPECT_TRUE(fault(Fault::device_data));
    EXPECT_TRUE(eventually([&] { return arm_->get("powered") == 0; })) << "motors off in the end";
    expect_within_the_gate();
    arm_->say("lie none");
    ASSERT_TRUE(engage()) << coupling_->output();
  }
  EXPECT_TRUE(said("refused what the arm says")) << coupling_->output();
  end_in_order();
}

}  // namespace
}  // namespace tact::test
