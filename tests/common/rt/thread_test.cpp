#include "rt/thread.hpp"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include "rt/periodic_thread.hpp"

namespace tact::rt {
namespace {

TEST(Thread, RunsItsBodyUnderItsNameAndEitherGetsItsPriorityOrSaysWhyNot) {
  char name[16] = {};
  int policy = -1;
  sched_param param{};
  Thread thread({.name = "tact-test", .priority = 10}, [&] {
    pthread_getname_np(pthread_self(), name, sizeof name);
    pthread_getschedparam(pthread_self(), &policy, &param);
  });
  thread.join();
  EXPECT_STREQ(name, "tact-test");
  if (thread.missing().empty()) {
    EXPECT_EQ(policy, SCHED_FIFO);
    EXPECT_EQ(param.sched_priority, 10);
  } else {
    EXPECT_EQ(policy, SCHED_OTHER);
    EXPECT_NE(thread.missing()[0].find("rtprio"), std::string::npos);
  }
}

TEST(Thread, AnImpossibleCpuIsReportedAndTheBodyStillRuns) {
  bool ran = false;
  Thread thread({.name = "tact-test", .cpu = 1000}, [&] { ran = true; });
  thread.join();
  EXPECT_TRUE(ran);
  ASSERT_EQ(thread.missing().size(), 1u);
  EXPECT_NE(thread.missing()[0].find("CPU 1000"), std::string::npos);
}

TEST(Thread, APrioritylessThreadDoesNotInheritItsCreatorsClass) {
  int policy = -1;
  Thread outer({.name = "outer", .priority = 5}, [&] {
    Thread inner({.name = "inner"}, [&] {
      sched_param param{};
      pthread_getschedparam(pthread_self(), &policy, &param);
    });
  });
  outer.join();
  EXPECT_EQ(policy, SCHED_OTHER);
}

TEST(PeriodicThread, EndsWhenTheBodySaysSo) {
  std::uint64_t last = 0;
  Ticker ticker(100'000);
  PeriodicThread thread(
      {.name = "periodic"}, [&] { return ticker.wait(); },
      [&](const Tick& tick) {
        last = tick.index;
        return tick.index == 9 ? Next::stop : Next::again;
      });
  while (thread.running()) sched_yield();
  thread.stop();
  EXPECT_EQ(last, 9u);
}

TEST(PeriodicThread, StopEndsAnEndlessBody) {
  Ticker ticker(100'000);
  PeriodicThread thread(
      {.name = "periodic"}, [&] { return ticker.wait(); }, [](const Tick&) { return Next::again; });
  thread.stop();
  EXPECT_FALSE(thread.running());
}

}  // namespace
}  // namespace tact::rt
