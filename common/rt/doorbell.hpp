#pragma once
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <ctime>

namespace tact::rt {

/// Wakes one waiting thread of this process. ring() is one atomic and at most one futex call: bounded, real-time safe.
class Doorbell {
 public:
  void ring() noexcept {
    count_.fetch_add(1, std::memory_order_release);
    if (waiting_.load(std::memory_order_seq_cst) != 0) futex(FUTEX_WAKE_PRIVATE, 1, nullptr);
  }

  /// Returns true when the bell rang since the last successful wait, false after timeout_ns without.
  bool wait(std::int64_t timeout_ns) noexcept {
    std::uint32_t now = count_.load(std::memory_order_acquire);
    if (now == seen_) {
      waiting_.store(1, std::memory_order_seq_cst);
      const timespec timeout{timeout_ns / 1'000'000'000, timeout_ns % 1'000'000'000};
      futex(FUTEX_WAIT_PRIVATE, seen_, &timeout);  // returns at once when the count has moved on
      waiting_.store(0, std::memory_order_relaxed);
      now = count_.load(std::memory_order_acquire);
    }
    const bool rang = now != seen_;
    seen_ = now;
    return rang;
  }

 private:
  long futex(int operation, std::uint32_t value, const timespec* timeout) noexcept {
    return syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&count_), operation, value, timeout, nullptr, 0);
  }

  std::atomic<std::uint32_t> count_{0};
  std::atomic<std::uint32_t> waiting_{0};
  std::uint32_t seen_ = 0;  // waiter only
};

}  // namespace tact::rt
