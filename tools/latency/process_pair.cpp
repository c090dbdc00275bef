#include <linux/futex.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>

#include "fault/fault.hpp"
#include "latency/latency.hpp"
#include "latency/real_time.hpp"
#include "rt/tick.hpp"

namespace tact::latency {
namespace {

/// Counts up; whoever waits for a value sleeps on it.
struct alignas(64) Bell {
  std::atomic<std::uint32_t> count;

  void ring() noexcept {
    count.fetch_add(1, std::memory_order_release);
    syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&count), FUTEX_WAKE, 1, nullptr, nullptr, 0);
  }
  /// False after a second without.
  bool wait_past(std::uint32_t seen) noexcept {
    const timespec second{1, 0};
    while (count.load(std::memory_order_acquire) == seen) {
      if (syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&count), FUTEX_WAIT, seen, &second, nullptr, 0) != 0 &&
          errno == ETIMEDOUT) {
        return false;
      }
    }
    return true;
  }
};
struct Shared {
  Bell there, back;
};

[[noreturn]] void answer(Shared& shared, const Effort& effort) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const RealTime real_time;
  real_time.run("answer", kLinkPriority, effort.cpu, [&] {
    for (std::uint32_t seen = 0; shared.there.wait_past(seen); ++seen) shared.back.ring();
  });
  ::_exit(0);
}

}  // namespace

Figure process_pair(const Effort& effort) {
  void* memory = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw SetupError("mmap: no shared memory for two processes");
  auto& shared = *new (memory) Shared{};
  const pid_t child = ::fork();
  if (child < 0) throw SetupError("fork: no second process");
  if (child == 0) answer(shared, effort);

  const RealTime real_time;
  Figure figure;
  std::vector<std::int64_t> trips;
  const auto count = static_cast<std::size_t>(effort.seconds * effort.rate_hz);
  trips.reserve(count);
  figure.conditions = real_time.run("ask", kLinkPriority, effort.cpu, [&] {
    rt::Ticker ticker(static_cast<std::int64_t>(std::llround(1e9 / effort.rate_hz)));
    for (std::uint32_t i = 0; i < count; ++i) {
      figure.missed += ticker.wait().skipped;
      const std::int64_t start = rt::monotonic_ns();
      shared.there.ring();
      if (!shared.back.wait_past(i)) return;
      trips.push_back(rt::monotonic_ns() - start);
    }
  });
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::munmap(memory, sizeof(Shared));
  if (trips.size() < count) figure.error = "the second process does not answer";
  figure.spread = spread_of(std::move(trips));
  return figure;
}

}  // namespace tact::latency
