#pragma once
#include <cstdint>

#include "rt/time_grid.hpp"

namespace tact::rt {

/// CLOCK_MONOTONIC now, ns. Real-time: no system call on x86-64.
std::int64_t monotonic_ns() noexcept;

/// One executed tick of a periodic loop. Times are CLOCK_MONOTONIC.
struct Tick {
  std::uint64_t index = 0;   ///< executed ticks, from 0: skipped grid points do not count
  std::int64_t due_ns = 0;   ///< its grid point
  std::int64_t woke_ns = 0;  ///< when it really began
  std::int64_t period_ns = 0;
  std::uint64_t skipped = 0;  ///< grid points skipped just before this one
};

/// Waits on an absolute grid of CLOCK_MONOTONIC. One thread.
class Ticker {
 public:
  /// The grid begins one period after the first wait(). @pre period_ns > 0
  explicit Ticker(std::int64_t period_ns) noexcept : grid_(0, period_ns) {}

  /// Sleeps until the next grid point and returns it; returns at once when it is already past.
  Tick wait() noexcept;

 private:
  TimeGrid grid_;
  std::uint64_t index_ = 0;
};

}  // namespace tact::rt
