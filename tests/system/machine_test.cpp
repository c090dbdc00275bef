// What the machine does to a session in mid-contact: its CPUs are taken, its clock is set. Real processes; every tick
// of the session is recorded and judged afterwards. In ticks: how long anything takes is not asked.
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>

#include "fault/fault.hpp"
#include "support/pressing.hpp"
#include "tick_laws.hpp"

namespace tact::test {
namespace {
using std::chrono::seconds;

std::filesystem::path tests_dir() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

bool ticks_more(Pressing& session, std::uint64_t n) {
  const auto tick = session.observer.device().tick;
  return eventually([&] { return session.observer.device().tick > tick + n; }, seconds{120});
}

/// A session whose every tick is kept.
struct Recorded {
  explicit Recorded(const std::string& mode)
      : session({"--mode", mode, "--record", (dir.path() / "all.tick").string()}) {}
  std::vector<FlightTick> ticks() const { return read_flight(dir.path() / "all.tick"); }
  bool pressing_again() {
    return eventually([&] { return session.observer.active() && session.observer.in_steady_contact(); }, seconds{60});
  }

  const ScratchDir dir;
  Pressing session;
};

class MachineFault : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Modes, MachineFault, ::testing::Values("impedance", "pseudo-admittance"),
                         [](const auto& param) { return param.index == 0 ? "impedance" : "pseudo_admittance"; });

TEST_P(MachineFault, HogsOnEveryCpuAboveAllPrioritiesCostTicksThatAreCountedAndNothingElse) {
  Recorded run(GetParam());
  Pressing& session = run.session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t coupling = session.pid("coupling"), contact = session.pid("contact");
  const auto missed = session.observer.stats().missed_ticks;
  {
    const Process hog({(tests_dir() / "cpu_hog").string(), "fifo", "2"}, run.dir.path() / "hog.txt");
    ASSERT_TRUE(eventually([&] { return !hog.output().empty(); }));
    EXPECT_TRUE(ticks_more(session, 1000)) << session.run.output();
  }
  EXPECT_TRUE(run.pressing_again()) << session.run.output();
  EXPECT_TRUE(eventually([&] { return session.observer.stats().missed_ticks > missed; })) << "grid points were lost";
  EXPECT_EQ(session.pid("coupling"), coupling) << "nobody died: " << session.run.output();
  EXPECT_EQ(session.pid("contact"), contact) << "nobody died: " << session.run.output();
  EXPECT_TRUE(ticks_more(session, 500));
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
  EXPECT_TRUE(session.run.reported("deadline_missed")) << session.run.report().dump(2);
  const auto ticks = run.ticks();
  expect_gate_and_staleness(ticks, GetParam());
  // What a tick says it skipped is what the books say.
  std::uint64_t skipped = 0;
  for (const FlightTick& t : ticks) skipped += t.skipped;
  EXPECT_GT(skipped, missed);
}

TEST(NormalHogs, ADozenOfThemACpuDoNotDisturbTheHand) {
  Recorded run("pseudo-admittance");
  Pressing& session = run.session;
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t coupling = session.pid("coupling"), contact = session.pid("contact");
  {
    const Process hog({(tests_dir() / "cpu_hog").string(), "normal", "12"}, run.dir.path() / "hog.txt");
    ASSERT_TRUE(eventually([&] { return !hog.output().empty(); }));
    EXPECT_TRUE(ticks_more(session, 4000)) << session.run.output();
  }
  EXPECT_TRUE(run.pressing_again()) << session.run.output();
  EXPECT_EQ(session.pid("coupling"), coupling) << session.run.output();
  EXPECT_EQ(session.pid("contact"), contact) << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
  expect_gate_and_staleness(run.ticks(), "pseudo-admittance");
}

/// The wall clock of every process of a session, as far beside the true one as we say.
class WallClock {
 public:
  WallClock() {
    set(seconds{0});
    setenv("TACT_TEST_CLOCK", file().c_str(), 1);
    setenv("LD_PRELOAD", (tests_dir() / "clock_jump.so").c_str(), 1);
  }
  ~WallClock() { started(); }
  /// What is started from now on has the true clock.
  void started() {
    unsetenv("LD_PRELOAD");
    unsetenv("TACT_TEST_CLOCK");
  }
  void set(std::chrono::nanoseconds beside) {
    std::fstream out(file(), std::ios::in | std::ios::out | std::ios::binary);
    if (!out) out.open(file(), std::ios::out | std::ios::binary);
    const std::int64_t ns = beside.count();
    out.write(reinterpret_cast<const char*>(&ns), sizeof ns);  // one write: eight bytes at once
  }

 private:
  std::string file() const { return dir_.path() / "offset"; }
  const ScratchDir dir_;
};

/// What a process started now takes the time to be.
std::int64_t wall_clock_of_a_child(const std::filesystem::path& scratch) {
  Process date({"date", "+%s"}, scratch / "date.txt");
  EXPECT_EQ(date.wait(seconds{10}), 0);
  return std::stoll(date.output());
}

/// Tact itself never asks for the time of day. DDS does: its timers wait until one, so they stand still for an hour
/// when the clock is set back by one, and nothing in a running session needs them. Set forward again after more than a
/// lease (10 s) it takes its peers for dead: then the pair meets anew, calm meanwhile.
TEST_P(MachineFault, AClockThatJumpsByAnHourToAndFroCostsAtMostAConnectionThatComesBackByItself) {
#ifdef TACT_SANITIZED
  GTEST_SKIP() << "a sanitizer wants to be the first library";
#endif
  WallClock clock;
  Recorded run(GetParam());
  Pressing& session = run.session;
  {
    const std::int64_t before = wall_clock_of_a_child(run.dir.path());
    clock.set(std::chrono::hours{1});
    EXPECT_GE(wall_clock_of_a_child(run.dir.path()), before + 3600) << "the test jumps nothing";
    clock.set(seconds{0});
  }
  clock.started();
  ASSERT_TRUE(session.settled()) << session.run.output();
  const pid_t coupling = session.pid("coupling"), contact = session.pid("contact");
  for (const int hours : {1, -1}) {
    const auto ticks = session.observer.device().tick;
    const auto stale = session.observer.stats().wrench_stale;
    clock.set(std::chrono::hours{hours});
    EXPECT_TRUE(eventually([&] { return session.observer.device().tick > ticks + 11000; }, seconds{60}))
        << hours << " h: " << session.run.output();
    EXPECT_LT(session.observer.stats().wrench_stale, stale + 100) << hours << " h";
    EXPECT_TRUE(session.observer.active()) << hours << " h";
  }
  clock.set(std::chrono::hours{1});
  EXPECT_TRUE(ticks_more(session, 3000)) << session.run.output();
  EXPECT_TRUE(run.pressing_again()) << session.run.output();
  EXPECT_EQ(session.pid("coupling"), coupling) << session.run.output();
  EXPECT_EQ(session.pid("contact"), contact) << session.run.output();

  // A server that comes back an hour before its predecessor is its successor all the same.
  clock.set(std::chrono::hours{-1});
  kill(contact, SIGKILL);
  EXPECT_TRUE(eventually([&] { return session.pid("contact") > 0 && session.pid("contact") != contact; }, seconds{30}))
      << session.run.output();
  EXPECT_TRUE(run.pressing_again()) << session.run.output();
  EXPECT_EQ(session.run.stop(), 0) << session.run.output();
  expect_gate_and_staleness(run.ticks(), GetParam());
}

}  // namespace
}  // namespace tact::test
