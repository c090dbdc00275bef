#include "link/health.hpp"

#include <unistd.h>

namespace tact {
namespace {

std::int64_t now_ns() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds{1}; }

}  // namespace

const char* phase_name(wire::Phase phase) {
  switch (phase) {
    case wire::kStarting:
      return "starting";
    case wire::kLoading:
      return "loading";
    case wire::kConnecting:
      return "connecting";
    case wire::kReady:
      return "ready";
    case wire::kActive:
      return "active";
    case wire::kDegraded:
      return "degraded";
    case wire::kStopping:
      return "stopping";
  }
  return "unknown";
}

HealthReporter::HealthReporter(const Participant& session, const std::string& service, const std::string& transport)
    : publisher_(session) {
  health_.schema = wire::kSchema;
  wire::set_text(health_.service, service);
  health_.epoch = process_epoch();
  health_.pid = static_cast<std::uint32_t>(::getpid());
  health_.phase = wire::kStarting;
  health_.progress = -1;
  wire::set_text(health_.transport, transport);
  thread_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    while (!stop_) {
      publish();
      wake_.wait_for(lock, std::chrono::milliseconds{100}, [this] { return stop_; });
    }
  });
}

HealthReporter::~HealthReporter() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
    health_.phase = wire::kStopping;
    publish();
  }
  wake_.notify_all();
  thread_.join();
}

void HealthReporter::update(const std::function<void(wire::Health&)>& change) {
  const std::scoped_lock lock(mutex_);
  change(health_);
  publish();
}

void HealthReporter::phase(wire::Phase phase, const std::string& detail, double progress) {
  update([&](wire::Health& h) {
    h.phase = phase;
    h.progress = progress;
    wire::set_text(h.detail, detail);
  });
}

void HealthReporter::set_faults(std::uint32_t mask, std::uint32_t bits) noexcept {
  std::uint32_t old = faults_.load(std::memory_order_relaxed);
  while (!faults_.compare_exchange_weak(old, (old & ~mask) | (bits & mask), std::memory_order_relaxed)) {
  }
}

wire::Health HealthReporter::now() const {
  const std::scoped_lock lock(mutex_);
  wire::Health health = health_;
  health.faults = faults_.load(std::memory_order_relaxed);
  return health;
}

void HealthReporter::publish() {
  health_.t_mono_ns = now_ns();
  health_.faults = faults_.load(std::memory_order_relaxed);
  publisher_.write(health_);
}

void HealthMonitor::poll(std::int64_t timeout_ns) {
  if (timeout_ns > 0) subscriber_.wait(timeout_ns);
  for (wire::Health health; subscriber_.take(health);) {
    auto& entry = entries_[health.service];
    if (health.schema == wire::kSchema && health.epoch >= entry.health.epoch) entry = {health, now_ns()};
  }
}

std::optional<wire::Health> HealthMonitor::latest(const std::string& service) const {
  const auto found = entries_.find(service);
  if (found == entries_.end()) return std::nullopt;
  return found->second.health;
}

std::optional<wire::Health> HealthMonitor::alive(const std::string& service) const {
  const auto found = entries_.find(service);
  if (found == entries_.end() || found->second.health.phase == wire::kStopping) return std::nullopt;
  if (now_ns() - found->second.heard_ns > 1'000'000'000) return std::nullopt;
  return found->second.health;
}

std::chrono::nanoseconds HealthMonitor::silence(const std::string& service) const {
  const auto found = entries_.find(service);
  return std::chrono::nanoseconds{found == entries_.end() ? INT64_MAX : now_ns() - found->second.heard_ns};
}

}  // namespace tact
