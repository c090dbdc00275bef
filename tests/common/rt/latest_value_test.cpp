#include "rt/latest_value.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace tact::rt {
namespace {

struct Four {
  std::uint64_t a = 0, b = 0, c = 0, d = 0;
};

TEST(LatestValue, IsEmptyAtFirstAndAfterEachRead) {
  LatestValue<int> box;
  int value = -1;
  EXPECT_FALSE(box.read(value));
  box.write(1);
  EXPECT_TRUE(box.read(value));
  EXPECT_EQ(value, 1);
  EXPECT_FALSE(box.read(value));
}

TEST(LatestValue, AnUnreadValueIsOverwritten) {
  LatestValue<int> box;
  for (int i = 0; i < 10; ++i) box.write(i);
  int value = -1;
  EXPECT_TRUE(box.read(value));
  EXPECT_EQ(value, 9);
}

TEST(LatestValue, ReaderNeverSeesATornOrOlderValue) {
  LatestValue<Four> box;
  constexpr std::uint64_t kCount = 200000;
  std::thread writer([&] {
    for (std::uint64_t i = 1; i <= kCount; ++i) box.write({i, i, i, i});
  });
  Four seen;
  std::uint64_t last = 0;
  while (last < kCount) {
    if (!box.read(seen)) {
      std::this_thread::yield();
      continue;
    }
    ASSERT_GT(seen.a, last);
    ASSERT_TRUE(seen.b == seen.a && seen.c == seen.a && seen.d == seen.a);
    last = seen.a;
  }
  writer.join();
}

}  // namespace
}  // namespace tact::rt
