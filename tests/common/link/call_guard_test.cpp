#include "link/call_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace tact {
namespace {

using namespace std::chrono_literals;

TEST(CallGuard, AThreadThatReturnsInTimeGoesOn) {
  CallGuard guard;
  guard.enter_write();
  EXPECT_FALSE(guard.abandon_if_stuck(1h));
  EXPECT_TRUE(guard.leave());
}

TEST(CallGuard, AThreadOutsideAWriteIsNeverGivenUp) {
  CallGuard guard;
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
  guard.enter_write();
  EXPECT_TRUE(guard.leave());
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
}

TEST(CallGuard, AThreadGivenUpLearnsItWhenItComesBack) {
  CallGuard guard;
  guard.enter_write();
  EXPECT_TRUE(guard.abandon_if_stuck(0ns));
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
  EXPECT_FALSE(guard.leave());
}

TEST(CallGuard, AReaderMaySleepAsLongAsItLikesUntilItIsAskedToStop) {
  CallGuard guard;
  guard.enter_read();
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
  EXPECT_TRUE(guard.leave());
  EXPECT_FALSE(guard.abandon());
  guard.enter_read();
  EXPECT_TRUE(guard.abandon());
  EXPECT_FALSE(guard.leave());
}

// Whatever the interleaving: once given up, the writer does not touch what its successor owns.
TEST(CallGuard, WriterAndSuccessorNeverShare) {
  for (int round = 0; round < 200; ++round) {
    CallGuard guard;
    int owned = 0;  // by the writer until it is given up; TSan watches it
    std::atomic<bool> stop{false};
    std::thread writer([&] {
      while (!stop) {
        ++owned;
        round % 2 == 0 ? guard.enter_write() : guard.enter_read();
        if (!guard.leave()) return;
      }
    });
    bool given_up = false;
    for (int i = 0; i < 1000 && !given_up; ++i) given_up = guard.abandon();
    if (given_up) ++owned;
    stop = true;
    writer.join();
  }
}

}  // namespace
}  // namespace tact
