#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>

namespace tact {

/// Lets a supervisor replace a thread that hangs inside DDS for ever (the process at the other end was killed inside an
/// iceoryx lock). The thread:  enter_write(); write; if (!leave()) return at once, touching nothing shared. Reads
/// likewise: they may sleep, so a supervisor gives up only a reader that does not come back when it is asked to stop.
///
///   idle --enter--> writing, reading --leave--> idle
///                         \--abandon--> abandoned      leave() is false from here on
///
/// One thread, one supervisor. Real-time safe.
class CallGuard {
 public:
  void enter_write() noexcept {
    since_ns_.store(now_ns(), std::memory_order_relaxed);
    state_.store(kWriting, std::memory_order_release);
  }
  void enter_read() noexcept { state_.store(kReading, std::memory_order_release); }

  /// False when the supervisor has given this thread up meanwhile.
  [[nodiscard]] bool leave() noexcept {
    int state = state_.load(std::memory_order_relaxed);
    return state != kAbandoned && state_.compare_exchange_strong(state, kIdle, std::memory_order_acq_rel);
  }

  /// True when the thread has been writing for longer than `limit`: it will never touch anything shared again.
  bool abandon_if_stuck(std::chrono::nanoseconds limit) noexcept {
    if (state_.load(std::memory_order_acquire) != kWriting) return false;
    if (now_ns() - since_ns_.load(std::memory_order_relaxed) < limit.count()) return false;
    int state = kWriting;
    return state_.compare_exchange_strong(state, kAbandoned, std::memory_order_acq_rel);
  }

  /// True when the thread is in a call now, for however short a time: it will never touch anything shared again.
  bool abandon() noexcept {
    int state = state_.load(std::memory_order_acquire);
    return (state == kWriting || state == kReading) &&
           state_.compare_exchange_strong(state, kAbandoned, std::memory_order_acq_rel);
  }

 private:
  static std::int64_t now_ns() noexcept {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1};
  }
  static constexpr int kIdle = 0, kWriting = 1, kReading = 2, kAbandoned = 3;
  std::atomic<int> state_{kIdle};
  std::atomic<std::int64_t> since_ns_{0};  // of the last write
};

}  // namespace tact
