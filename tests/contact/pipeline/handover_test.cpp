#include "contact/pipeline/handover.hpp"

#include <gtest/gtest.h>

#include <thread>

namespace tact::contact {
namespace {

struct Counted {
  static inline std::atomic<int> alive{0};
  explicit Counted(int v) : value(v) { ++alive; }
  ~Counted() { --alive; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  int value;
};

TEST(Handover, TheReaderAdoptsTheNewestAndNothingIsLostOrFreedTwice) {
  {
    Handover<Counted> handover(std::make_unique<Counted>(0));
    EXPECT_EQ(handover.current().value, 0);
    handover.submit(std::make_unique<Counted>(1));
    handover.submit(std::make_unique<Counted>(2));
    EXPECT_EQ(handover.current().value, 2);
    EXPECT_EQ(Counted::alive, 2);  // the old one waits to be freed
    handover.submit(std::make_unique<Counted>(3));
    EXPECT_EQ(Counted::alive, 2);
    EXPECT_EQ(handover.current().value, 3);
  }
  EXPECT_EQ(Counted::alive, 0);
}

TEST(Handover, TwoThreadsSeeValuesInOrder) {
  {
    Handover<Counted> handover(std::make_unique<Counted>(0));
    std::atomic<bool> done{false};
    std::thread writer([&] {
      for (int i = 1; i <= 5000; ++i) handover.submit(std::make_unique<Counted>(i));
      done = true;
    });
    int last = 0;
    while (!done) {
      const int now = handover.current().value;
      ASSERT_GE(now, last);
      last = now;
    }
    writer.join();
    handover.submit(std::make_unique<Counted>(5001));  // frees what the reader left
    EXPECT_EQ(handover.current().value, 5001);
  }
  EXPECT_EQ(Counted::alive, 0);
}

}  // namespace
}  // namespace tact::contact
