#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// What this machine can do for the device loop: each figure measured by itself, in a process of its own, with the
/// threads, priorities and waits that the services use.
namespace tact::latency {

/// Percentiles of single measurements, microseconds, exact.
struct Spread {
  std::uint64_t n = 0;
  double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;
};
Spread spread_of(std::vector<std::int64_t> ns);

/// Under what a figure was measured.
struct Conditions {
  bool fifo = false, locked = false, awake = false;  ///< SCHED_FIFO, mlockall, /dev/cpu_dma_latency held at 0
  int priority = 0;
  std::string text() const;  ///< "FIFO 80, locked, CPUs awake"
};

struct Figure {
  Spread spread;
  Conditions conditions;
  std::uint64_t missed = 0;  ///< periods skipped, or replies that never came
  std::string error;         ///< not measured, and why
};

struct Effort {
  double rate_hz = 1000;
  double seconds = 5;  ///< for each figure
  int cpu = -1;
};

/// Wake-up after the grid point of an absolute periodic timer (rt::Ticker), the device loop's priority.
Figure wakeup(const Effort& effort);
/// There and back between two processes, futexes in shared memory: the limit of anything that sleeps.
Figure process_pair(const Effort& effort);
/// ToolPose there, ContactWrench back, once a period, through the services' own endpoints. "shm" or "udp"; shm needs a
/// RouDi (held by the caller).
Figure round_trip(const Effort& effort, const std::string& transport);

/// Runs `measure` in a forked process: DDS and locked memory of one figure do not touch the next. @pre this process has
/// one thread.
Figure measure_apart(const std::function<Figure()>& measure);

/// cyclictest of the package rt-tests, same period, time, priority; nothing when it is not installed.
std::optional<Figure> cyclictest(const Effort& effort);

struct Advice {
  double rate_hz = 0;  ///< 0: none can be advised
  std::string reason;
};
/// The fastest of 4000, 2000, 1000, 500 Hz whose period holds the 99.9th percentile of wake-up and round trip and
/// `compute_us`, with a fifth to spare.
Advice advise(const Figure& wakeup, const Figure& round_trip, double compute_us);

}  // namespace tact::latency
