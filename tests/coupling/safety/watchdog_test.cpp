#include "coupling/safety/watchdog.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tact::coupling {
namespace {

TEST(StallDetector, WaitsForTheLoopToBegin) {
  StallDetector detector(3);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(detector.stalled(0));
}

TEST(StallDetector, CallsAStallAfterAsManyWakeUpsWithoutProgressAndForgetsAtEachStep) {
  StallDetector detector(3);
  for (std::uint64_t progress = 1; progress < 50; ++progress) {
    EXPECT_FALSE(detector.stalled(progress));
    EXPECT_FALSE(detector.stalled(progress));
    EXPECT_FALSE(detector.stalled(progress));
  }
  EXPECT_TRUE(detector.stalled(49));
}

TEST(Watchdog, ActsOnceWhenTheCounterStops) {
  std::atomic<std::uint64_t> progress{1};
  std::atomic<int> calls{0};
  {
    const Watchdog watchdog({.name = "watchdog"}, progress, [&] { ++calls; });
    while (calls == 0) sched_yield();
  }
  EXPECT_EQ(calls, 1);
}

TEST(Watchdog, AStoppedAndContinuedProcessHasNotStalled) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // A loop that ticks every millisecond for half a second of its own wake-ups, watched.
    std::atomic<std::uint64_t> progress{0};
    const Watchdog watchdog({.name = "watchdog"}, progress, [] { leave_process("test", "stalled"); });
    for (int i = 0; i < 500; ++i) {
      ::usleep(1000);
      progress.fetch_add(1);
    }
    ::_exit(0);
  }
  ::usleep(100'000);
  ::kill(child, SIGSTOP);
  ::usleep(400'000);  // four times its patience
  ::kill(child, SIGCONT);
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(Watchdog, ALoopThatHangsEndsTheProcess) {
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    std::atomic<std::uint64_t> progress{1};
    const Watchdog watchdog({.name = "watchdog"}, progress, [] { leave_process("test", "watchdog: stalled"); });
    ::pause();  // hangs inside a tick
    ::_exit(0);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), kWatchdogExitStatus);
}

TEST(Watchdog, AStalledLoopEndsTheProcessWithANamedReason) {
  EXPECT_EXIT(leave_process("tact-coupling", "watchdog: the device loop stalled"),
              ::testing::ExitedWithCode(kWatchdogExitStatus), "tact-coupling: watchdog: the device loop stalled");
}

}  // namespace
}  // namespace tact::coupling
