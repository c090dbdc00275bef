#include "rt/time_grid.hpp"

#include <gtest/gtest.h>

#include "rt/tick.hpp"

namespace tact::rt {
namespace {

TEST(TimeGrid, StepsByOnePeriodWhenOnTime) {
  TimeGrid grid(1000, 100);
  EXPECT_EQ(grid.advance(1030), 0u);
  EXPECT_EQ(grid.due_ns(), 1100);
  EXPECT_EQ(grid.advance(1199), 0u);
  EXPECT_EQ(grid.due_ns(), 1200);
}

TEST(TimeGrid, ATickThatEndsLateByLessThanAPeriodSkipsNothing) {
  TimeGrid grid(1000, 100);
  EXPECT_EQ(grid.advance(1199), 0u);
  EXPECT_EQ(grid.due_ns(), 1100);
}

TEST(TimeGrid, AnOverrunSkipsWholePeriodsCountsThemAndKeepsThePhase) {
  TimeGrid grid(1000, 100);
  EXPECT_EQ(grid.advance(1450), 3u);  // 1100, 1200, 1300 went by
  EXPECT_EQ(grid.due_ns(), 1400);
  EXPECT_EQ(grid.advance(1500), 0u);
  EXPECT_EQ(grid.due_ns(), 1500);
}

TEST(TimeGrid, ExecutedAndSkippedTicksTogetherFillTheGridForAnyDelays) {
  TimeGrid grid(0, 7);
  std::int64_t now = 0;
  std::int64_t points = 0;
  std::uint32_t random = 1;
  for (int i = 0; i < 10000; ++i) {
    random = random * 1664525u + 1013904223u;
    now = std::max(now, grid.due_ns()) + static_cast<std::int64_t>((random >> 16) % 40);
    points += 1 + static_cast<std::int64_t>(grid.advance(now));
    ASSERT_EQ(grid.due_ns(), points * 7);
    ASSERT_LT(now - grid.due_ns(), 7);
  }
}

TEST(Ticker, TicksAreNeverEarlyAndLieOnTheGrid) {
  Ticker ticker(500'000);
  const Tick first = ticker.wait();
  for (int i = 1; i <= 20; ++i) {
    const Tick tick = ticker.wait();
    EXPECT_EQ(tick.index, static_cast<std::uint64_t>(i));
    EXPECT_GE(tick.woke_ns, tick.due_ns);
    EXPECT_EQ((tick.due_ns - first.due_ns) % 500'000, 0);
  }
}

}  // namespace
}  // namespace tact::rt
