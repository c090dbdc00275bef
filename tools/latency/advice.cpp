#include <cstdio>

#include "latency/latency.hpp"

namespace tact::latency {

Advice advise(const Figure& wakeup, const Figure& round_trip, double compute_us) {
  if (!wakeup.error.empty() || !round_trip.error.empty()) {
    return {0, "wake-up or round trip could not be measured: " + wakeup.error + round_trip.error};
  }
  const double needed = wakeup.spread.p999_us + round_trip.spread.p999_us + compute_us;
  char sum[200];
  std::snprintf(
      sum, sizeof sum,
      "wake-up %.0f us + round trip %.0f us (99.9th percentiles) + %.0f us for contact and coupling = %.0f us",
      wakeup.spread.p999_us, round_trip.spread.p999_us, compute_us, needed);
  for (const double rate : {4000.0, 2000.0, 1000.0, 500.0}) {
    const double period = 1e6 / rate;
    if (needed > 0.8 * period) continue;
    std::string reason = std::string(sum) + ": fits a period of " + std::to_string(static_cast<int>(period)) +
                         " us with a fifth to spare";
    if (wakeup.spread.max_us > period) {
      char late[120];
      std::snprintf(late, sizeof late, "; the worst wake-up, %.0f us, misses ticks even so: tact doctor says why",
                    wakeup.spread.max_us);
      reason += late;
    }
    return {rate, reason};
  }
  return {0, std::string(sum) +
                 ": more than four fifths of 2000 us, the period at 500 Hz. tact doctor says what is "
                 "missing; wrenches would be extrapolated in many ticks"};
}

}  // namespace tact::latency
