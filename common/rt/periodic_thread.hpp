#pragma once
#include <atomic>
#include <functional>

#include "rt/thread.hpp"
#include "rt/tick.hpp"

namespace tact::rt {

enum class Next { again, stop };

/// A thread that waits for a tick, runs the body, and so on until the body or stop() ends it.
/// The body must be noexcept and must not allocate, lock, log or wait: the only waiting is in `wait`, which owns the
/// clock (a Ticker, or a device whose driver paces us).
class PeriodicThread {
 public:
  PeriodicThread(const ThreadOptions& options, std::function<Tick()> wait, std::function<Next(const Tick&)> body)
      : thread_(options, [this, wait = std::move(wait), body = std::move(body)] {
          while (!stop_.load(std::memory_order_relaxed) && body(wait()) == Next::again) {
          }
          running_.store(false, std::memory_order_release);
        }) {}
  PeriodicThread(const PeriodicThread&) = delete;
  PeriodicThread& operator=(const PeriodicThread&) = delete;
  ~PeriodicThread() { stop(); }

  /// Ends after the tick now running; returns when it has ended.
  void stop() {
    stop_.store(true, std::memory_order_relaxed);
    thread_.join();
  }
  bool running() const noexcept { return running_.load(std::memory_order_acquire); }
  const std::vector<std::string>& missing() const { return thread_.missing(); }

 private:
  std::atomic<bool> stop_{false}, running_{true};
  Thread thread_;  // last: the flags outlive it
};

}  // namespace tact::rt
