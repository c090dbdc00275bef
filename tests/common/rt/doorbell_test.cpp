#include "rt/doorbell.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "rt/latest_value.hpp"

namespace tact::rt {
namespace {

constexpr std::int64_t kLong = 10'000'000'000;

TEST(Doorbell, TimesOutWhenNobodyRings) {
  Doorbell bell;
  EXPECT_FALSE(bell.wait(1'000'000));
}

TEST(Doorbell, ARingBeforeTheWaitIsNotLost) {
  Doorbell bell;
  bell.ring();
  bell.ring();
  EXPECT_TRUE(bell.wait(kLong));
  EXPECT_FALSE(bell.wait(0));
}

TEST(Doorbell, WakesTheWaiterForTheLastValueOfAStream) {
  Doorbell bell;
  LatestValue<int> box;
  std::thread writer([&] {
    for (int i = 1; i <= 2000; ++i) {
      box.write(i);
      bell.ring();
      if (i % 100 == 0) std::this_thread::yield();
    }
  });
  int value = 0;
  while (value < 2000) {
    ASSERT_TRUE(bell.wait(kLong));
    box.read(value);
  }
  writer.join();
}

}  // namespace
}  // namespace tact::rt
