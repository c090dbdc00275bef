// tact-coupling as a process, against a contact server in closed form in another, over the real transports.
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include "fault/fault.hpp"
#include "link/convert.hpp"
#include "program/program_session.hpp"

namespace tact {
namespace {

using namespace std::chrono_literals;

class CouplingProgram : public ::testing::TestWithParam<std::tuple<const char*, const char*>> {
 protected:
  static void SetUpTestSuite() { lease_ = std::make_unique<RoudiLease>(share_dir() / "roudi.toml"); }
  static void TearDownTestSuite() { lease_.reset(); }

  CouplingProgram() {
    session_.machine.transport = std::get<0>(GetParam());
    session_.machine.mode = std::get<1>(GetParam());
    program_.save();
  }
  test::Process start(const char* program) { return program_.start(program, "log" + std::to_string(logs_++)); }
  test::Process start_server() { return program_.start_server(TACT_SERVER, "log" + std::to_string(logs_++)); }

  /// The newest state, waiting for one that satisfies the condition.
  template <class Condition>
  bool state_shows(Condition condition) {
    return test::eventually([&] { return states_->take_newest(state_) && condition(state_); });
  }
  static bool pressed(const wire::DeviceState& s) {
    return s.script_done && std::abs(s.F_contact_W.force.z - 10) < 0.5 && (s.faults & bit(Fault::wrench_stale)) == 0;
  }

  static inline std::unique_ptr<RoudiLease> lease_;
  test::ProgramSession program_;
  Session& session_ = program_.session;
  int logs_ = 0;
  std::unique_ptr<Participant> low_;
  std::unique_ptr<Subscriber<wire::DeviceState>> states_;
  std::unique_ptr<Subscriber<wire::SessionStats>> stats_;
  wire::DeviceState state_{};

  void SetUp() override {
    low_ = std::make_unique<Participant>(wire::Channel::session, session_);
    states_ = std::make_unique<Subscriber<wire::DeviceState>>(*low_);
    stats_ = std::make_unique<Subscriber<wire::SessionStats>>(*low_);
  }
};

TEST_P(CouplingProgram, PressesOnAWallSurvivesTheServersDeathAndEndsInOrder) {
  auto coupling = start(TACT_COUPLING);
  auto server = std::make_unique<test::Process>(std::vector<std::string>{TACT_SERVER, program_.file()},
                                                program_.dir() / "server1");
  ASSERT_TRUE(state_shows(pressed)) << coupling.output() << server->output();
  EXPECT_LT(std::abs(state_.X_WM.position.z + 10.0 / 20000), 1e-4);

  server->signal(SIGKILL);
  ASSERT_TRUE(state_shows([](const auto& s) { return (s.faults & bit(Fault::wrench_stale)) != 0; }));
  ASSERT_TRUE(state_shows([](const auto& s) { return s.F_coupling_W.force.z == 0; }));
  EXPECT_LT(std::abs(state_.X_WM.position.z), 2e-3);  // calm: it stands where it was

  server = std::make_unique<test::Process>(std::vector<std::string>{TACT_SERVER, program_.file()},
                                           program_.dir() / "server2");
  ASSERT_TRUE(state_shows(pressed)) << coupling.output();
  coupling.signal(SIGTERM);
  ASSERT_EQ(coupling.wait(20s), 0) << coupling.output();
  wire::SessionStats stats{};
  ASSERT_TRUE(stats_->take_newest(stats));
  EXPECT_GT(stats.ticks, 1000u);
  EXPECT_GT(stats.wrench_fresh, 500u);
  EXPECT_LT(stats.penetration_max_m, 5e-3);
  EXPECT_LE(stats.page_faults, 2u);
  EXPECT_EQ(stats.port_energy_j < 0.01, true) << stats.port_energy_j;
  const rt::Histogram tick = from_wire(stats.tick), trip = from_wire(stats.round_trip),
                      jitter = from_wire(stats.loop_jitter);
  std::printf("tick p50 %.1f p99 %.1f us, round trip p50 %.1f p99 %.1f us, jitter p50 %.1f p99 %.1f us\n",
              tick.percentile_ns(0.5) / 1e3, tick.percentile_ns(0.99) / 1e3, trip.percentile_ns(0.5) / 1e3,
              trip.percentile_ns(0.99) / 1e3, jitter.percentile_ns(0.5) / 1e3, jitter.percentile_ns(0.99) / 1e3);
  std::printf("%s", coupling.output().c_str());
  EXPECT_TRUE(std::filesystem::exists(program_.dir() / "flight-1.tick"));
}

TEST_P(CouplingProgram, StopsAtOnceWhileItWaitsForAScene) {
  auto coupling = start(TACT_COUPLING);
  Subscriber<wire::Health> healths(*low_);
  wire::Health health{};
  ASSERT_TRUE(test::eventually([&] { return healths.take_newest(health) && health.phase == wire::kConnecting; }));
  coupling.signal(SIGINT);
  EXPECT_EQ(coupling.wait(10s), 0) << coupling.output();
}

TEST_P(CouplingProgram, AStoppedAndContinuedLoopGoesOn) {
  auto server = start_server();
  auto coupling = start(TACT_COUPLING);
  ASSERT_TRUE(state_shows(pressed)) << coupling.output();
  coupling.signal(SIGSTOP);
  ::usleep(700'000);
  coupling.signal(SIGCONT);
  const std::uint64_t tick = state_.tick;
  ASSERT_TRUE(state_shows([&](const auto& s) { return s.tick > tick + 500 && pressed(s); })) << coupling.output();
  coupling.signal(SIGTERM);
  EXPECT_EQ(coupling.wait(20s), 0) << coupling.output();
}

INSTANTIATE_TEST_SUITE_P(All, CouplingProgram,
                         ::testing::Values(std::tuple("shm", "pseudo-admittance"), std::tuple("udp", "impedance")),
                         [](const auto& i) { return std::string(std::get<0>(i.param)); });

}  // namespace
}  // namespace tact
