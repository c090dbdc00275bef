#include "service/stop_signal.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <string>

#include "fault/fault.hpp"

namespace tact {
namespace {

constexpr std::array kSignals{SIGINT, SIGTERM, SIGHUP};

// A handler sees globals only. The event counter is never read back to zero: once set it stays readable.
std::atomic<int> event_file{-1};
std::array<struct sigaction, kSignals.size()> previous;

extern "C" void tact_on_stop_signal(int) {
  const int saved = errno;
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = ::write(event_file.load(std::memory_order_relaxed), &one, sizeof one);
  errno = saved;
}

}  // namespace

StopSignal::StopSignal() {
  TACT_CHECK(event_file.load() < 0);
  const int file = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (file < 0) throw SetupError(std::string("eventfd: ") + std::strerror(errno));
  event_file.store(file);
  struct sigaction action {};
  action.sa_handler = tact_on_stop_signal;
  action.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &action, &previous[i]);
    const bool nohup = kSignals[i] == SIGHUP && previous[i].sa_handler == SIG_IGN;
    if (nohup) sigaction(SIGHUP, &previous[i], nullptr);
  }
}

StopSignal::~StopSignal() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous[i], nullptr);
  ::close(event_file.exchange(-1));
}

bool StopSignal::wait_for(std::chrono::milliseconds limit) const {
  pollfd wanted{event_file.load(), POLLIN, 0};
  const auto until = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - std::chrono::steady_clock::now());
    const int n = ::poll(&wanted, 1, left.count() > 0 ? static_cast<int>(left.count()) : 0);
    if (n > 0) return true;
    if (n == 0 || left.count() <= 0) return false;  // otherwise a signal interrupted: look again
  }
}

void StopSignal::request() { tact_on_stop_signal(SIGTERM); }

}  // namespace tact
