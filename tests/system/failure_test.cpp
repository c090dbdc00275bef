// What happens to a person's hand when something dies, stops or is missing: real processes, real signals.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <thread>

#include "fault/fault.hpp"
#include "support/flight_file.hpp"
#include "support/other_network.hpp"
#include "support/pressing.hpp"
#include "support/watcher.hpp"
#include "tick_laws.hpp"

namespace tact::test {
namespace {
using std::chrono::seconds;

bool is_stale(const FlightTick& tick) { return (tick.faults & bit(Fault::wrench_stale)) != 0; }

/// The flight record in which the wrench went stale; the session may have written others before.
std::vector<FlightTick> flight_of_stale_wrench(const TactRun& run) {
  std::vector<FlightTick> found;
  EXPECT_TRUE(eventually(
      [&] {
        for (const auto& entry : std::filesystem::directory_iterator(run.run_dir())) {
          if (entry.path().extension() != ".tick") continue;
          auto ticks = read_flight(entry.path());
          if (std::any_of(ticks.begin(), ticks.end(), is_stale)) found = std::move(ticks);
        }
        return !found.empty();
      },
      seconds{20}))
      << run.output();
  return found;
}

/// The RouDi this run started, -1 when it shares that of another session on this machine: then it is not ours to kill.
pid_t own_roudi(TactRun& run) {
  for (const pid_t roudi : pids_of("iox-roudi")) {
    std::ifstream status("/proc/" + std::to_string(roudi) + "/status");
    for (std::string key; status >> key;) {
      pid_t parent = 0;
      if (key == "PPid:" && status >> parent && parent == run.process().pid()) return roudi;
    }
  }
  return -1;
}

/// From the last fresh wrench on: within 20 executed ticks the fault is set, from then on the wrench never grows, and
/// no step of what is sent exceeds the gate.
void expect_calm_after_last_fresh(const std::vector<FlightTick>& ticks, double force_step_n) {
  const auto stale = std::find_if(ticks.begin(), ticks.end(), is_stale);
  ASSERT_NE(stale, ticks.end());
  EXPECT_LE(stale->wrench_age_ticks, 20u);
  EXPECT_GT(std::prev(stale)->contact_count, 0u) << "it was in mid-contact";
  // Extrapolated for five ticks, then faded, then nothing: from the sixth on it never grows.
  const auto fading = std::find_if(std::make_reverse_iterator(stale), ticks.rend(), [](const auto& t) {
                        return t.wrench_age_ticks <= 5;
                      }).base();
  EXPECT_LT(fading, stale);
  for (auto t = std::next(fading); t != ticks.end() && t->wrench_age_ticks > 0; ++t) {
    EXPECT_LE(t->F_contact_W.force.norm(), std::prev(t)->F_contact_W.force.norm() + 1e-9) << "tick " << t->tick;
    EXPECT_LE(t->F_contact_W.torque.norm(), std::prev(t)->F_contact_W.torque.norm() + 1e-9) << "tick " << t->tick;
  }
  for (auto t = std::next(ticks.begin()); t != ticks.end(); ++t) {
    EXPECT_LE((t->F_sent_W.force - std::prev(t)->F_sent_W.force).norm(), force_step_n) << "tick " << t->tick;
  }
}

class ContactServerKilled : public ::testing::TestWithParam<std::string> {};

TEST_P(ContactServerKilled, CalmsTheArmWithinTwentyTicksAndComesBackByItself) {
  Pressing session({"--mode", GetParam()});
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t victim = session.pid("contact");
  ASSERT_GT(victim, 0);
  kill(victim, SIGKILL);
  // The machine file's gate: 5000 N/s at 1 kHz.
  expect_calm_after_last_fresh(flight_of_stale_wrench(session.run), 5.0 + 1e-6);
  EXPECT_TRUE(eventually([&] { return session.pid("contact") != victim && session.pid("contact") > 0; }, seconds{30}))
      << session.run.output();
  EXPECT_TRUE(
      eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60}))
      << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
  EXPECT_TRUE(session.run.reported("wrench_stale")) << session.run.report().dump(2);
}

INSTANTIATE_TEST_SUITE_P(Modes, ContactServerKilled, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST(ContactServerRestarted, WithAnotherMeshIsRefusedByNameAndTheArmStaysCalm) {
  const ScratchDir dir;
  const auto write_mesh = [&](const char* name, int size_mm) {
    const auto size = std::to_string(size_mm);
    const auto path = dir.path() / name;
    std::ofstream(path) << "v 0 0 0\nv " << size << " 0 0\nv 0 " << size << " 0\nv 0 0 " << size
                        << "\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
    return path.string();
  };
  const auto obstacle = write_mesh("obstacle.obj", 50), tool = write_mesh("tool.obj", 20);
  TactRun run({"--obstacle", obstacle, "--tool", tool, "--unit", "mm", "--view", "off", "--for", "300s"});
  Observer observer(run.session());
  ASSERT_TRUE(eventually([&] { return observer.active(); }, seconds{120})) << run.output();
  const auto coupling = observer.health("coupling")->pid;
  write_mesh("tool.obj", 25);
  kill(static_cast<pid_t>(observer.health("contact")->pid), SIGKILL);
  const auto refused = [&] {
    const auto health = observer.health("coupling");
    return health && (health->faults & bit(Fault::scene_changed)) != 0;
  };
  ASSERT_TRUE(eventually(refused, seconds{60})) << run.output();
  // Long after the supervisor would have given a stuck connection up.
  const auto tick = observer.device().tick;
  ASSERT_TRUE(eventually([&] { return observer.device().tick > tick + 4000; })) << run.output();
  EXPECT_TRUE(refused());
  EXPECT_EQ(observer.health("coupling")->pid, coupling) << "the same process under the same hand";
  EXPECT_FALSE(observer.active());
  const auto& state = observer.device();
  EXPECT_NE(state.faults & bit(Fault::wrench_stale), 0u);
  const auto& F = state.F_coupling_W.force;
  EXPECT_EQ(std::abs(F.x) + std::abs(F.y) + std::abs(F.z), 0);

  // No restart takes the other scene over: neither coupling's alone ...
  bool went_live = false;
  const auto refused_by_another_than = [&](std::uint32_t pid) {
    went_live |= observer.active();
    return refused() && observer.health("coupling")->pid != pid;
  };
  kill(static_cast<pid_t>(coupling), SIGKILL);
  ASSERT_TRUE(eventually([&] { return refused_by_another_than(coupling); }, seconds{60})) << run.output();
  // ... nor the one of all shared-memory processes.
  const auto second = observer.health("coupling")->pid;
  const pid_t roudi = own_roudi(run);
  ASSERT_GT(roudi, 0) << "another session is running";
  kill(roudi, SIGKILL);
  ASSERT_TRUE(eventually([&] { return refused_by_another_than(second); }, seconds{60})) << run.output();
  const auto third = observer.health("coupling")->pid;
  const auto since = std::chrono::steady_clock::now();
  ASSERT_TRUE(eventually([&] {
    went_live |= observer.active();
    return std::chrono::steady_clock::now() - since > seconds{4};  // twice the supervisor's patience
  }));
  EXPECT_FALSE(went_live) << run.output();
  EXPECT_TRUE(refused());
  EXPECT_EQ(observer.health("coupling")->pid, third) << run.output();

  // The right one may come back.
  write_mesh("tool.obj", 20);
  kill(static_cast<pid_t>(observer.health("contact")->pid), SIGKILL);
  EXPECT_TRUE(eventually([&] { return observer.active(); }, seconds{60})) << run.output();
  EXPECT_FALSE(refused());
  EXPECT_EQ(run.stop(), 0) << run.output();
  EXPECT_TRUE(run.reported("scene_changed")) << run.report().dump(2);
  EXPECT_NE(run.output().find("restart the session"), std::string::npos) << run.output();
}

TEST(ContactServerStopped, ForThreeSecondsCalmsTheArmAndTheGridDoesNotSlip) {
  Pressing session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t victim = session.pid("contact");
  const auto before = session.observer.device().tick;
  kill(victim, SIGSTOP);
  EXPECT_TRUE(eventually([&] { return session.observer.device().tick > before + 3000; }, seconds{20}))
      << "the device loop goes on ticking";
  kill(victim, SIGCONT);
  EXPECT_TRUE(
      eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60}))
      << session.run.output();
  EXPECT_EQ(session.run.stop(), 0);
  const auto report = session.run.report();
  EXPECT_TRUE(session.run.reported("wrench_stale")) << report.dump(2);
  // Grid points are lost to a busy machine, not to a stopped server: it was stopped for more than 3000 ticks.
  EXPECT_LT(report["missed_ticks"].get<double>(), 0.05 * report["ticks"].get<double>()) << report.dump(2);
}

/// Stopped and continued without end: replies come in bursts, most of them late.
class ContactServerSlow : public ::testing::TestWithParam<std::string> {};

TEST_P(ContactServerSlow, IsBridgedOrFadedNeverBeyondTheGateAndTheArmComesBackByItself) {
  const ScratchDir dir;
  const auto record = dir.path() / "slow.tick";
  Pressing session({"--mode", GetParam(), "--record", record});
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t victim = session.pid("contact");
  for (int i = 0; i < 40; ++i) {
    kill(victim, SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds{3 + 2 * (i % 10)});
    kill(victim, SIGCONT);
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  }
  EXPECT_TRUE(
      eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60}))
      << session.run.output();
  EXPECT_EQ(session.pid("contact"), victim) << "slow is not dead: " << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
  EXPECT_TRUE(session.run.reported("wrench_late")) << session.run.report().dump(2);
  expect_gate_and_staleness(read_flight(record), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Modes, ContactServerSlow, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST(SupervisorAndRouDiStopped, DoNotDisturbTheHandAndTheSessionGoesOnWithThem) {
  Pressing session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t contact = session.pid("contact"), coupling = session.pid("coupling"), roudi = own_roudi(session.run);
  ASSERT_GT(roudi, 0) << "another session is running";
  for (const pid_t victim : {roudi, session.run.process().pid()}) {
    const auto stale = session.observer.stats().wrench_stale;
    const auto tick = session.observer.device().tick;
    kill(victim, SIGSTOP);
    EXPECT_TRUE(eventually([&] { return session.observer.device().tick > tick + 3000; }));
    kill(victim, SIGCONT);
    EXPECT_TRUE(eventually([&] { return session.observer.device().tick > tick + 4000; }));
    EXPECT_LT(session.observer.stats().wrench_stale, stale + 100);
    EXPECT_TRUE(eventually([&] { return session.observer.active(); })) << session.run.output();
  }
  EXPECT_EQ(session.pid("contact"), contact) << session.run.output();
  EXPECT_EQ(session.pid("coupling"), coupling) << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
}

TEST(CouplingKilled, IsStartedAgainAndTheSessionGoesOn) {
  Pressing session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t victim = session.pid("coupling");
  kill(victim, SIGKILL);
  EXPECT_TRUE(eventually([&] { return session.pid("coupling") > 0 && session.pid("coupling") != victim; }, seconds{30}))
      << session.run.output();
  EXPECT_TRUE(
      eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60}))
      << session.run.output();
  EXPECT_EQ(session.run.stop(), 0);
}

TEST(ViewKilled, DoesNotDisturbTheHand) {
  Pressing session({"--view", "on", "--port", "0"});
  ASSERT_TRUE(session.settled()) << session.run.output();
  ASSERT_TRUE(eventually([&] { return session.pid("view") > 0; }));
  const auto stale = session.observer.stats().wrench_stale;
  const pid_t victim = session.pid("view");
  kill(victim, SIGSTOP);
  const auto tick = session.observer.device().tick;
  EXPECT_TRUE(eventually([&] { return session.observer.device().tick > tick + 1000; }));
  kill(victim, SIGKILL);
  EXPECT_TRUE(eventually([&] { return session.pid("view") > 0 && session.pid("view") != victim; }, seconds{30}))
      << session.run.output();
  // A machine with two busy cores may lose some ticks by itself; a hand that waited for the view would lose hundreds.
  EXPECT_LT(session.observer.stats().wrench_stale, stale + 100);
  EXPECT_EQ(session.run.stop(), 0);
}

TEST(RemoteWatcherCutOff, LeavesTheHandUndisturbed) {
  OtherNetwork network;
  if (!network.ready()) GTEST_SKIP() << "needs root and iproute2 to make a network namespace";
  Pressing session({"--view", "on", "--port", "0", "--set", "view.bind=0.0.0.0", "--set", "view.token=secret-token"});
  ASSERT_TRUE(session.settled()) << session.run.output();
  const auto port = session.view_port();
  ASSERT_GT(port, 0) << session.run.output();
  auto remote = network.inside([&] { return std::make_unique<Watcher>("10.213.77.1", port, "secret-token"); }).get();
  remote->frame('p');
  const auto stale = session.observer.stats().wrench_stale;
  const auto tick = session.observer.device().tick;
  network.cut();
  EXPECT_TRUE(eventually([&] { return session.observer.device().tick > tick + 2000; }));
  EXPECT_LT(session.observer.stats().wrench_stale, stale + 100);
  EXPECT_EQ(session.run.stop(), 0);
}

TEST(RouDiKilled, IsReportedAndReplacedWithoutEndingTheSession) {
  Pressing session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t roudi = own_roudi(session.run);
  ASSERT_GT(roudi, 0) << "another session is running";
  kill(roudi, SIGKILL);
  // In contact the pair goes on for up to ten seconds; then all shared-memory processes start anew.
  EXPECT_TRUE(eventually(
      [&] {
        const pid_t now = own_roudi(session.run);
        return now > 0 && now != roudi;
      },
      seconds{40}))
      << session.run.output();
  EXPECT_TRUE(
      eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60}))
      << session.run.output();
  EXPECT_EQ(session.run.stop(), 0);
  EXPECT_TRUE(session.run.reported("transport_degraded")) << session.run.report().dump(2);
}

TEST(TwoSessions, DoNotHearEachOtherAndOneEndingLeavesTheOtherAlone) {
  Pressing first;
  ASSERT_TRUE(first.settled()) << first.run.output();
  {
    Pressing second;
    ASSERT_TRUE(second.settled()) << second.run.output();
    EXPECT_EQ(pids_of("iox-roudi").size(), 1u);
    EXPECT_EQ(second.run.stop(), 0) << second.run.output();
  }
  const auto stale = first.observer.stats().wrench_stale;
  const auto tick = first.observer.device().tick;
  EXPECT_TRUE(eventually([&] { return first.observer.device().tick > tick + 1000; }));
  EXPECT_LT(first.observer.stats().wrench_stale, stale + 100);
  EXPECT_EQ(pids_of("iox-roudi").size(), 1u);
  EXPECT_EQ(first.run.stop(), 0);
  EXPECT_TRUE(pids_of("iox-roudi").empty());
}

TEST(TwoSessions, TheOneThatStartedRouDiIsKilledAndTheOtherGoesOnWithItAndStopsIt) {
  auto first = std::make_unique<Pressing>();
  ASSERT_TRUE(first->settled()) << first->run.output();
  const pid_t roudi = own_roudi(first->run);
  ASSERT_GT(roudi, 0) << "another session is running";
  Pressing second;
  ASSERT_TRUE(second.settled()) << second.run.output();
  const pid_t contact = second.pid("contact"), coupling = second.pid("coupling");
  kill(first->run.process().pid(), SIGKILL);
  EXPECT_TRUE(eventually([] { return pids_of("tact-contact").size() == 1 && pids_of("tact-coupling").size() == 1; }));
  const auto stale = second.observer.stats().wrench_stale;
  const auto tick = second.observer.device().tick;
  EXPECT_TRUE(eventually([&] { return second.observer.device().tick > tick + 2000; }));
  EXPECT_LT(second.observer.stats().wrench_stale, stale + 100);
  EXPECT_EQ(second.pid("contact"), contact);
  EXPECT_EQ(second.pid("coupling"), coupling);
  EXPECT_EQ(pids_of("iox-roudi"), std::vector<pid_t>{roudi});
  EXPECT_EQ(second.run.stop(), 0) << second.run.output();
  EXPECT_TRUE(pids_of("iox-roudi").empty());
  EXPECT_TRUE(shared_memory_files().empty()) << ::testing::PrintToString(shared_memory_files());
}

TEST(StartAndStop, TwentyTimesLeavesNoProcessAndNoSharedMemory) {
  for (int i = 0; i < 20; ++i) {
    TactRun run({"peg", "--view", "off", "--for", "300ms"});
    ASSERT_EQ(run.wait(seconds{90}), 0) << "cycle " << i << '\n' << run.output();
  }
  for (const char* name : {"iox-roudi", "tact-contact", "tact-coupling", "tact-view", "tact-bake"}) {
    EXPECT_TRUE(pids_of(name).empty()) << name;
  }
  EXPECT_TRUE(shared_memory_files().empty()) << ::testing::PrintToString(shared_memory_files());
}

/// Killed, it can do nothing any more: the kernel tells its services, and the last of them takes RouDi with it.
class SupervisorKilled : public ::testing::TestWithParam<std::string> {};

TEST_P(SupervisorKilled, ItsServicesEndCalmlyAndNothingIsLeftRunningOrInSharedMemory) {
  const ScratchDir dir;
  const auto record = dir.path() / "killed.tick";
  Pressing session({"--mode", GetParam(), "--record", record, "--view", "on", "--port", "0"});
  ASSERT_TRUE(session.settled()) << session.run.output();
  ASSERT_GT(own_roudi(session.run), 0) << "another session is running";
  const auto& state = session.observer.device().F_coupling_W.force;
  ASSERT_TRUE(eventually([&] {
    session.observer.device();
    return std::hypot(state.x, state.y, state.z) > 2;
  })) << session.run.output();
  kill(session.run.process().pid(), SIGKILL);
  EXPECT_TRUE(eventually([] {
    return pids_of("tact-contact").empty() && pids_of("tact-coupling").empty() && pids_of("tact-view").empty();
  }));
  EXPECT_TRUE(eventually([] { return pids_of("iox-roudi").empty(); }));
  EXPECT_TRUE(shared_memory_files().empty()) << ::testing::PrintToString(shared_memory_files());

  // It pressed until it was told; then to nothing through the gate, and some ticks at rest before the motors went off.
  const auto ticks = read_flight(record);
  expect_gate_and_staleness(ticks, GetParam());
  const auto pressing =
      std::find_if(ticks.rbegin(), ticks.rend(), [](const FlightTick& t) { return t.F_sent_W.force.norm() > 1; });
  ASSERT_NE(pressing, ticks.rend());
  EXPECT_GT(pressing - ticks.rbegin(), 20);
  EXPECT_EQ(ticks.back().F_sent_W.force.norm(), 0);

  TactRun next({"peg", "--view", "off", "--for", "300ms"});
  EXPECT_EQ(next.wait(seconds{90}), 0) << next.output();
}

INSTANTIATE_TEST_SUITE_P(Modes, SupervisorKilled, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

/// Killed with everything it had started but RouDi, nobody is left to clean up: the next session does.
TEST(EverythingKilled, TheNextSessionCleansUp) {
  {
    Pressing session;
    ASSERT_TRUE(session.settled()) << session.run.output();
    const pid_t contact = session.pid("contact"), coupling = session.pid("coupling");
    for (const pid_t pid : {session.run.process().pid(), contact, coupling}) kill(pid, SIGSTOP);
    for (const pid_t pid : {session.run.process().pid(), contact, coupling}) kill(pid, SIGKILL);
    EXPECT_TRUE(eventually([&] { return pids_of("tact-contact").empty() && pids_of("tact-coupling").empty(); }));
  }
  TactRun next({"peg", "--view", "off", "--for", "300ms"});
  EXPECT_EQ(next.wait(seconds{90}), 0) << next.output();
  EXPECT_TRUE(pids_of("iox-roudi").empty());
  EXPECT_TRUE(shared_memory_files().empty()) << ::testing::PrintToString(shared_memory_files());
}

}  // namespace
}  // namespace tact::test
