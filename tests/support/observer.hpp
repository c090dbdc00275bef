#pragma once
#include <optional>

#include "link/endpoint.hpp"
#include "link/health.hpp"
#include "session/session.hpp"
#include "support/process.hpp"

namespace tact::test {

/// Listens to a running session on its low-rate topics, as the view does.
class Observer {
 public:
  explicit Observer(const std::string& session) : participant_(wire::Channel::session, named(session)) {}

  /// The last Health of a service that is alive.
  std::optional<wire::Health> health(const std::string& service) {
    monitor_.poll();
    return monitor_.alive(service);
  }
  const wire::DeviceState& device() {
    device_state_.take_newest(state_);
    return state_;
  }
  const wire::SessionStats& stats() {
    session_stats_.take_newest(stats_);
    return stats_;
  }

  bool active() {
    const auto coupling = health("coupling");
    return coupling && coupling->phase == wire::kActive;
  }
  /// Pressing on the obstacle, at rest.
  bool in_steady_contact() {
    const auto& s = device();
    const double v = std::abs(s.V_WT.linear.x) + std::abs(s.V_WT.linear.y) + std::abs(s.V_WT.linear.z);
    return s.contact_count > 0 && s.force_max_n > 1 && v < 0.005;
  }

 private:
  static Session named(const std::string& name) {
    Session session;
    session.name = name;
    return session;
  }

  Participant participant_;
  HealthMonitor monitor_{participant_};
  Subscriber<wire::DeviceState> device_state_{participant_};
  Subscriber<wire::SessionStats> session_stats_{participant_};
  wire::DeviceState state_{};
  wire::SessionStats stats_{};
};

}  // namespace tact::test
