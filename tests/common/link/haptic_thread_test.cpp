#include "link/haptic_thread.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "rt/latest_value.hpp"

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
      control.guard.enter_write();
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
      control.guard.enter_write();
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

// The receive thread of a server that was killed while it held the lock of our queue.
TEST(HapticThread, OneThatHangsInAReadIsLeftBehindAndNeverTouchesItsSuccessorsMailbox) {
  const auto hang = std::make_shared<Hang>();
  const auto receive = [](rt::LatestValue<int>& mailbox, int value, Hang* read, Control& control) {
    while (!control.stop) {
      control.guard.enter_read();
      if (read != nullptr) (*read)();
      if (!control.guard.leave()) return;
      mailbox.write(value);
    }
  };
  auto mailbox = std::make_unique<rt::LatestValue<int>>();
  int value = 0;
  {
    HapticThread thread({.name = "t"}, [&receive, &mailbox = *mailbox, hang](Control& control) {
      receive(mailbox, 1, hang.get(), control);
      hang->left = true;
    });
    while (!hang->inside) std::this_thread::yield();
    EXPECT_FALSE(thread.hung()) << "a read may sleep";
    EXPECT_FALSE(thread.finish());
    EXPECT_TRUE(thread.hung());
    EXPECT_FALSE(thread.finish()) << "and again, at once";
  }
  {
    HapticThread successor({.name = "t"}, [&](Control& control) { receive(*mailbox, 2, nullptr, control); });
    while (!mailbox->read(value)) std::this_thread::yield();
    EXPECT_EQ(value, 2);
    hang->release = true;  // the read returns after all: TSan would see two writers
    while (!hang->left) std::this_thread::yield();
    EXPECT_TRUE(successor.finish());
  }
  while (mailbox->read(value)) {
    EXPECT_EQ(value, 2);
  }
}

TEST(HapticThread, OneThatOutlivesEverythingItDoesNotOwnTouchesNoneOfIt) {
  const auto hang = std::make_shared<Hang>();
  {
    auto mailbox = std::make_unique<rt::LatestValue<int>>();  // gone before the read returns: ASan would see it
    HapticThread thread({.name = "t"}, [&mailbox = *mailbox, hang](Control& control) {
      control.guard.enter_read();
      (*hang)();
      if (control.guard.leave()) mailbox.write(1);
      hang->left = true;
    });
    while (!hang->inside) std::this_thread::yield();
    EXPECT_FALSE(thread.finish());
  }
  hang->release = true;
  while (!hang->left) std::this_thread::yield();
}

TEST(HapticThread, OneThatIsAtWorkOfItsOwnIsWaitedForHoweverLongItTakes) {
  const auto hang = std::make_shared<Hang>();
  std::atomic<bool> done{false};
  HapticThread thread({.name = "t"}, [&done, hang](Control&) {
    (*hang)();  // outside DDS: it still owns what it works on
    done = true;
  });
  while (!hang->inside) std::this_thread::yield();
  std::thread later([hang] {
    std::this_thread::sleep_for(1500ms);  // longer than finish() is patient with DDS
    hang->release = true;
  });
  EXPECT_TRUE(thread.finish());
  EXPECT_TRUE(done);
  later.join();
}

TEST(HapticThread, OneThatWaitsForSamplesIsNotTakenForHung) {
  HapticThread thread({.name = "t"}, [](Control& control) {
    while (!control.stop) {
      control.guard.enter_read();
      std::this_thread::sleep_for(20ms);
      if (!control.guard.leave()) return;
    }
  });
  std::this_thread::sleep_for(150ms);
  EXPECT_FALSE(thread.hung());
  EXPECT_TRUE(thread.finish());
}

}  // namespace
}  // namespace tact
