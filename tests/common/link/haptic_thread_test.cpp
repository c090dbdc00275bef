#include "link/haptic_thread.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace tact {
namespace {

using namespace std::chrono_literals;
using Control = HapticThread::Control;

/// A call that does not return until told.
struct Hang {
  std::atomic<bool> inside{false}, release{false}, left{false};
  void operator()() {
    inside = true;
    while (!release) std::this_thread::sleep_for(1ms);
  }
};

TEST(HapticThread, AHealthyOneIsJoined) {
  std::atomic<int> writes{0};
  HapticThread thread({.name = "t"}, [&](Control& control) {
    while (!control.stop) {
      control.guard.enter();
      ++writes;
      if (!control.guard.leave()) return;
    }
  });
  while (writes < 100) std::this_thread::yield();
  EXPECT_TRUE(thread.finish());
}

TEST(HapticThread, OneThatHangsInAWriteIsLeftBehindAndTouchesNothingMore) {
  const auto hang = std::make_shared<Hang>();
  auto touched = std::make_shared<std::atomic<bool>>(false);
  {
    HapticThread thread({.name = "t"}, [hang, touched](Control& control) {
      control.guard.enter();
      (*hang)();
      if (!control.guard.leave()) {
        hang->left = true;
        return;
      }
      *touched = true;
    });
    while (!hang->inside) std::this_thread::yield();
    EXPECT_FALSE(thread.finish());
    EXPECT_TRUE(thread.hung());
  }
  hang->release = true;  // the write returns after all, long after the thread was replaced
  while (!hang->left) std::this_thread::yield();
  EXPECT_FALSE(*touched);
}

TEST(HapticThread, OneThatWaitsForSamplesIsNotTakenForHung) {
  HapticThread thread({.name = "t"}, [](Control& control) {
    while (!control.stop) std::this_thread::sleep_for(20ms);
  });
  std::this_thread::sleep_for(150ms);
  EXPECT_FALSE(thread.hung());
  EXPECT_TRUE(thread.finish());
}

}  // namespace
}  // namespace tact
