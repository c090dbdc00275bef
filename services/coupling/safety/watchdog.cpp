#include "coupling/safety/watchdog.hpp"

#include <unistd.h>

#include <cstring>
#include <ctime>

namespace tact::coupling {

Watchdog::Watchdog(const rt::ThreadOptions& options, const std::atomic<std::uint64_t>& progress,
                   std::function<void()> on_stall)
    : thread_(options, [this, &progress, on_stall = std::move(on_stall)] {
        StallDetector detector(kPatience);
        while (!stop_.load(std::memory_order_relaxed)) {
          // Relative: after a stop of the process an absolute grid would wake many times at once.
          const timespec period{0, kPeriodNs};
          clock_nanosleep(CLOCK_MONOTONIC, 0, &period, nullptr);
          if (detector.stalled(progress.load(std::memory_order_relaxed))) {
            on_stall();
            return;
          }
        }
      }) {}

Watchdog::~Watchdog() {
  stop_.store(true, std::memory_order_relaxed);
  thread_.join();
}

void leave_process(const char* program, const char* reason) noexcept {
  for (const char* part : {program, ": ", reason, "\n"}) {
    if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;  // nothing more can be done
  }
  ::_exit(kWatchdogExitStatus);
}

}  // namespace tact::coupling
