#include "link/write_guard.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace tact {
namespace {

using namespace std::chrono_literals;

TEST(WriteGuard, AThreadThatReturnsInTimeGoesOn) {
  WriteGuard guard;
  guard.enter();
  EXPECT_FALSE(guard.abandon_if_stuck(1h));
  EXPECT_TRUE(guard.leave());
}

TEST(WriteGuard, AThreadOutsideAWriteIsNeverGivenUp) {
  WriteGuard guard;
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
  guard.enter();
  EXPECT_TRUE(guard.leave());
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
}

TEST(WriteGuard, AThreadGivenUpLearnsItWhenItComesBack) {
  WriteGuard guard;
  guard.enter();
  EXPECT_TRUE(guard.abandon_if_stuck(0ns));
  EXPECT_FALSE(guard.abandon_if_stuck(0ns));
  EXPECT_FALSE(guard.leave());
}

// Whatever the interleaving: once given up, the writer does not touch what its successor owns.
TEST(WriteGuard, WriterAndSuccessorNeverShare) {
  for (int round = 0; round < 200; ++round) {
    WriteGuard guard;
    int owned = 0;  // by the writer until it is given up; TSan watches it
    std::atomic<bool> stop{false};
    std::thread writer([&] {
      while (!stop) {
        ++owned;
        guard.enter();
        if (!guard.leave()) return;
      }
    });
    bool given_up = false;
    for (int i = 0; i < 1000 && !given_up; ++i) given_up = guard.abandon_if_stuck(0ns);
    if (given_up) ++owned;
    stop = true;
    writer.join();
  }
}

}  // namespace
}  // namespace tact
