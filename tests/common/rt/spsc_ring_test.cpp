#include "rt/spsc_ring.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace tact::rt {
namespace {

TEST(SpscRing, RecordsComeOutInOrderAndUntornWhileTheWriterRuns) {
  struct Record {
    std::uint64_t a = 0, b = 0, c = 0, d = 0;
  };
  SpscRing<Record> ring(64);
  constexpr std::uint64_t kCount = 200000;
  std::uint64_t pushed = 0;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount;) {
      if (ring.push({i, 2 * i, 3 * i, 4 * i})) {
        ++pushed;
        ++i;
      } else {
        std::this_thread::yield();
      }
    }
  });
  std::uint64_t expected = 1;
  Record record;
  while (expected <= kCount) {
    if (!ring.pop(record)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_EQ(record.a, expected);
    ASSERT_EQ(record.b, 2 * expected);
    ASSERT_EQ(record.c, 3 * expected);
    ASSERT_EQ(record.d, 4 * expected);
    ++expected;
  }
  writer.join();
  EXPECT_EQ(pushed, kCount);
}

TEST(SpscRing, AFullRingDropsTheNewestAndCountsIt) {
  SpscRing<int> ring(4);
  for (int i = 0; i < 7; ++i) ring.push(i);
  EXPECT_EQ(ring.dropped(), 3u);
  int value = -1;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(ring.pop(value));
    EXPECT_EQ(value, i);
  }
  EXPECT_FALSE(ring.pop(value));
}

}  // namespace
}  // namespace tact::rt
