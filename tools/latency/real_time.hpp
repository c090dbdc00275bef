#pragma once
#include <functional>
#include <string>

#include "latency/latency.hpp"
#include "rt/realtime.hpp"
#include "rt/thread.hpp"

namespace tact::latency {

/// As the services have them: device loop, link.
inline constexpr int kLoopPriority = 80, kLinkPriority = 70;

/// What the services ask of the system, while it lives; whatever is refused is measured without.
class RealTime {
 public:
  RealTime() : locked_(rt::lock_memory().empty()) {}

  /// Runs `body` on a real-time thread to its end; says under what.
  Conditions run(const std::string& name, int priority, int cpu, std::function<void()> body) const {
    rt::Thread thread({.name = name, .priority = priority, .cpu = cpu}, std::move(body));
    bool fifo = true;
    for (const std::string& missing : thread.missing()) fifo = fifo && missing.find("SCHED_FIFO") == std::string::npos;
    thread.join();
    return {.fifo = fifo, .locked = locked_, .awake = awake_.missing().empty(), .priority = fifo ? priority : 0};
  }

 private:
  rt::CpuDmaLatency awake_;
  bool locked_;
};

}  // namespace tact::latency
