#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>

namespace tact {

/// Lets a supervisor replace a thread that hangs inside dds_write for ever (its reader was killed inside an iceoryx
/// lock). The writing thread:  enter(); write; if (!leave()) return at once, touching nothing shared.
///
///   idle --enter--> writing --leave--> idle
///                      \--abandon_if_stuck--> abandoned      leave() is false from here on
///
/// One writing thread, one supervisor. Real-time safe.
class WriteGuard {
 public:
  void enter() noexcept {
    since_ns_.store(now_ns(), std::memory_order_relaxed);
    state_.store(kWriting, std::memory_order_release);
  }

  /// False when the supervisor has given this thread up meanwhile.
  [[nodiscard]] bool leave() noexcept {
    int expected = kWriting;
    return state_.compare_exchange_strong(expected, kIdle, std::memory_order_acq_rel);
  }

  /// True when the thread has been writing for longer than `limit`: it will never touch anything shared again.
  bool abandon_if_stuck(std::chrono::nanoseconds limit) noexcept {
    if (state_.load(std::memory_order_acquire) != kWriting) return false;
    if (now_ns() - since_ns_.load(std::memory_order_relaxed) < limit.count()) return false;
    int expected = kWriting;
    return state_.compare_exchange_strong(expected, kAbandoned, std::memory_order_acq_rel);
  }

 private:
  static std::int64_t now_ns() noexcept {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1};
  }
  static constexpr int kIdle = 0, kWriting = 1, kAbandoned = 2;
  std::atomic<int> state_{kIdle};
  std::atomic<std::int64_t> since_ns_{0};
};

}  // namespace tact
