#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "link/endpoint.hpp"

namespace tact {

/// For a person: "starting", "active".
const char* phase_name(wire::Phase phase);

/// Says how a service is: publishes its Health at 10 Hz from a thread of its own, and at each change. The last message,
/// sent by the destructor, is kStopping.
class HealthReporter {
 public:
  /// Phase kStarting, epoch = process_epoch(). `session` must outlive it.
  HealthReporter(const Participant& session, const std::string& service, const std::string& transport);
  ~HealthReporter();
  HealthReporter(const HealthReporter&) = delete;
  HealthReporter& operator=(const HealthReporter&) = delete;

  /// Changes fields and publishes at once. Any thread that is not real-time; `change` must not call the reporter.
  void update(const std::function<void(wire::Health&)>& change);
  void phase(wire::Phase phase, const std::string& detail = {}, double progress = -1);
  /// Replaces the fault bits of `mask`: each source owns its bits. Any thread; published with the next message.
  void set_faults(std::uint32_t mask, std::uint32_t bits) noexcept;
  wire::Health now() const;

 private:
  void publish();  // with mutex_ held

  mutable std::mutex mutex_;
  std::condition_variable wake_;
  Publisher<wire::Health> publisher_;
  wire::Health health_{};
  std::atomic<std::uint32_t> faults_{0};
  bool stop_ = false;
  std::thread thread_;
};

/// What the services of a session last said. Of each service only its newest incarnation counts.
class HealthMonitor {
 public:
  explicit HealthMonitor(const Participant& session) : subscriber_(session) {}

  /// Takes what has arrived; sleeps up to timeout_ns when nothing has. Call at least every 100 ms: ages start here.
  void poll(std::int64_t timeout_ns = 0);

  /// Empty when never heard.
  std::optional<wire::Health> latest(const std::string& service) const;
  /// Heard less than a second ago and not stopping: ten messages lost are a dead service.
  std::optional<wire::Health> alive(const std::string& service) const;
  /// Since its last message; very long when never heard.
  std::chrono::nanoseconds silence(const std::string& service) const;

 private:
  struct Entry {
    wire::Health health;
    std::int64_t heard_ns;
  };
  Subscriber<wire::Health> subscriber_;
  std::map<std::string, Entry> entries_;
};

}  // namespace tact
