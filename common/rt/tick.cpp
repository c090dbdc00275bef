#include "rt/tick.hpp"

#include <cerrno>
#include <ctime>

namespace tact::rt {

std::int64_t monotonic_ns() noexcept {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

Tick Ticker::wait() noexcept {
  const std::int64_t now = monotonic_ns();
  std::uint64_t skipped = 0;
  if (index_ == 0) {
    grid_ = TimeGrid(now + grid_.period_ns(), grid_.period_ns());
  } else {
    skipped = grid_.advance(now);
  }
  const timespec due{grid_.due_ns() / 1'000'000'000, grid_.due_ns() % 1'000'000'000};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
  }
  return {index_++, grid_.due_ns(), monotonic_ns(), grid_.period_ns(), skipped};
}

}  // namespace tact::rt
