#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "rt/thread.hpp"

namespace tact::coupling {

/// Counts wake-ups without progress. Time is not read: a process that was stopped and continued, or a machine that
/// slept, has not stalled; its loop gets as many wake-ups of the watchdog as always to show that it lives.
class StallDetector {
 public:
  explicit StallDetector(std::uint32_t patience) : patience_(patience) {}

  /// One wake-up; `progress` is any counter of the loop. True when it has not changed for `patience` wake-ups.
  /// Zero means that the loop has not begun.
  bool stalled(std::uint64_t progress) noexcept {
    if (progress == 0 || progress != last_) {
      last_ = progress;
      idle_ = 0;
      return false;
    }
    return ++idle_ >= patience_;
  }

 private:
  std::uint32_t patience_, idle_ = 0;
  std::uint64_t last_ = 0;
};

/// A thread of its own, above the device loop and the link in priority and independent of both, that can do one thing:
/// act when the loop stalls (power off and leave the process). A hung loop may hold any lock, so `on_stall` must only
/// do what is safe in a signal handler.
class Watchdog {
 public:
  static constexpr std::int64_t kPeriodNs = 10'000'000;
  static constexpr std::uint32_t kPatience = 10;  ///< wake-ups: 100 ms

  /// `progress` must outlive the watchdog. `on_stall` is called at most once.
  Watchdog(const rt::ThreadOptions& options, const std::atomic<std::uint64_t>& progress,
           std::function<void()> on_stall);
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;
  ~Watchdog();

  const std::vector<std::string>& missing() const { return thread_.missing(); }

 private:
  std::atomic<bool> stop_{false};
  rt::Thread thread_;
};

/// Leaves the process at once, without destructors or locks: writes "<program>: <reason>" to standard error.
/// Exit status kWatchdogExitStatus.
[[noreturn]] void leave_process(const char* program, const char* reason) noexcept;
inline constexpr int kWatchdogExitStatus = 70;

}  // namespace tact::coupling
