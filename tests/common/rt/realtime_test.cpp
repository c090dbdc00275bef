#include "rt/realtime.hpp"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

namespace tact::rt {
namespace {

TEST(PageFaults, TouchingAFreshPageIsCountedOnThisThread) {
  const auto size = static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) * 4;
  void* memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  madvise(memory, size, MADV_NOHUGEPAGE);
  const std::uint64_t before = thread_page_faults();
  *static_cast<volatile char*>(memory) = 1;
  EXPECT_GE(thread_page_faults(), before + 1);
  munmap(memory, size);
}

TEST(CpuDmaLatency, IsHeldOrSaysWhatToDo) {
  const CpuDmaLatency hold;
  if (!hold.missing().empty()) {
    EXPECT_NE(hold.missing().find("udev"), std::string::npos);
  }
}

}  // namespace
}  // namespace tact::rt
