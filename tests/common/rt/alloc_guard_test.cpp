#include "rt/alloc_guard.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

namespace tact::rt {
namespace {

class AllocGuard : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!alloc_hooks_active()) GTEST_SKIP() << "allocations are not counted in sanitizer builds";
  }
};

TEST_F(AllocGuard, CountsNewAndDeleteOnlyInsideASection) {
  const std::uint64_t before = rt_allocations();
  auto outside = std::make_unique<std::vector<int>>(100);
  EXPECT_EQ(rt_allocations(), before);
  {
    const RtSection section;
    outside->push_back(1);  // grows: one new, one delete
  }
  EXPECT_EQ(rt_allocations(), before + 2);
  outside.reset();
  EXPECT_EQ(rt_allocations(), before + 2);
}

TEST_F(AllocGuard, SeesCallsMadeInsideLibraries) {
  const std::uint64_t before = rt_allocations();
  char* volatile text = nullptr;  // or a compiler may leave both calls out
  {
    const RtSection section;
    text = ::strdup("allocated by libc");
  }
  EXPECT_EQ(rt_allocations(), before + 1);
  std::free(text);
}

TEST_F(AllocGuard, SectionsNest) {
  const std::uint64_t before = rt_allocations();
  const RtSection outer;
  { const RtSection inner; }
  void* volatile p = std::malloc(1);
  std::free(p);
  EXPECT_EQ(rt_allocations(), before + 2);
}

}  // namespace
}  // namespace tact::rt
