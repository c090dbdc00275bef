#include "supervise/policy.hpp"

#include <gtest/gtest.h>

namespace tact::supervise {
namespace {
using namespace std::chrono_literals;

Time at(Duration since_start) { return Time{} + 1h + since_start; }

TEST(RestartPolicy, RestartsAtOnceThenEverLaterThenGivesUp) {
  RestartPolicy policy(4);
  EXPECT_EQ(policy.after_death(at(0s)), Duration{0s});
  EXPECT_EQ(policy.after_death(at(1s)), Duration{250ms});
  EXPECT_EQ(policy.after_death(at(2s)), Duration{500ms});
  EXPECT_EQ(policy.after_death(at(3s)), Duration{1s});
  EXPECT_FALSE(policy.after_death(at(5s)));
}

TEST(RestartPolicy, ForgetsDeathsOfMoreThanAMinuteAgo) {
  RestartPolicy policy(2);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(policy.after_death(at(i * 61s)), Duration{0s});
}

TEST(FreshWatch, IsQuietWhenNothingWasRestarted) {
  FreshWatch watch;
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(watch.stuck(at(i * 100ms), true, false));
}

TEST(FreshWatch, IsStuckTwoSecondsAfterBothAreUpWithoutAFreshWrench) {
  FreshWatch watch;
  watch.restarted();
  EXPECT_FALSE(watch.stuck(at(0s), false, false));
  EXPECT_FALSE(watch.stuck(at(30s), true, false));  // loading took that long
  EXPECT_FALSE(watch.stuck(at(31900ms), true, false));
  EXPECT_TRUE(watch.stuck(at(32s), true, false));
  EXPECT_FALSE(watch.stuck(at(40s), true, false)) << "once only";
}

TEST(FreshWatch, AFreshWrenchEndsTheWatch) {
  FreshWatch watch;
  watch.restarted();
  EXPECT_FALSE(watch.stuck(at(0s), true, false));
  EXPECT_FALSE(watch.stuck(at(1s), true, true));
  EXPECT_FALSE(watch.stuck(at(9s), true, false)) << "a later stall is not the restart's";
}

TEST(RoudiWatch, WaitsUntilOutOfContact) {
  RoudiWatch watch;
  EXPECT_FALSE(watch.restart_now(at(0s), true, true));
  EXPECT_FALSE(watch.restart_now(at(1s), false, true));
  EXPECT_TRUE(watch.lost());
  EXPECT_FALSE(watch.restart_now(at(3s), false, false));
  EXPECT_FALSE(watch.restart_now(at(3100ms), false, true)) << "touched again";
  EXPECT_FALSE(watch.restart_now(at(4s), false, false));
  EXPECT_TRUE(watch.restart_now(at(4300ms), false, false));
  EXPECT_FALSE(watch.lost());
}

TEST(RoudiWatch, WaitsTenSecondsAtMost) {
  RoudiWatch watch;
  EXPECT_FALSE(watch.restart_now(at(0s), false, true));
  EXPECT_FALSE(watch.restart_now(at(9900ms), false, true));
  EXPECT_TRUE(watch.restart_now(at(10s), false, true));
}

}  // namespace
}  // namespace tact::supervise
