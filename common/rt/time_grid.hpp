#pragma once
#include <cstdint>

namespace tact::rt {

/// An absolute grid of due times: start, start + period, ... It never drifts and never loses its phase.
///
///   due       |----|----|----|----|        a tick that ends late runs the next one at once;
///   executed  x----xxxxxxxxxxx-x--x        whole periods that went by unserved are skipped and counted, not caught up
class TimeGrid {
 public:
  /// @pre period_ns > 0
  TimeGrid(std::int64_t start_ns, std::int64_t period_ns) noexcept : due_ns_(start_ns), period_ns_(period_ns) {}

  std::int64_t due_ns() const noexcept { return due_ns_; }
  std::int64_t period_ns() const noexcept { return period_ns_; }

  /// Moves to the next grid point to serve, given the time now. Returns how many were skipped. Afterwards the due time
  /// is in the future or less than one period ago.
  std::uint64_t advance(std::int64_t now_ns) noexcept {
    due_ns_ += period_ns_;
    const std::int64_t late_ns = now_ns - due_ns_;
    if (late_ns < period_ns_) return 0;
    const std::int64_t skipped = late_ns / period_ns_;
    due_ns_ += skipped * period_ns_;
    return static_cast<std::uint64_t>(skipped);
  }

 private:
  std::int64_t due_ns_, period_ns_;
};

}  // namespace tact::rt
