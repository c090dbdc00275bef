#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "link/endpoint.hpp"
#include "link/health.hpp"
#include "link/participant.hpp"
#include "report/session_report.hpp"
#include "session/session.hpp"

namespace tact::supervise {

/// Listens to a session: health, device state, statistics, what was loaded; gathers what its report and plot need.
class SessionMonitor {
 public:
  /// Throws SetupError when DDS cannot be used.
  explicit SessionMonitor(const Session& session);

  /// Takes all that has arrived, sleeping up to `timeout_ns` for the first. Call at least ten times a second.
  void poll(std::int64_t timeout_ns);

  std::optional<wire::Health> alive(const std::string& service) const { return health_.alive(service); }
  std::optional<wire::Health> latest(const std::string& service) const { return health_.latest(service); }
  const std::optional<wire::DeviceState>& device() const { return device_; }
  /// Of the newest contact server; nothing when none has said it.
  const wire::SceneInfo* scene() const { return scene_known_ ? &scene_ : nullptr; }
  bool script_done() const { return script_done_; }
  /// Both ends have proven shared memory, at any time so far.
  bool shared_memory_proven() const { return proven_; }

  /// The session's clock begins now: times of faults and samples count from here, earlier ones are 0.
  void begin();
  bool begun() const { return begun_ns_ != 0; }
  /// ... and stops: later faults and samples belong to the stopping, statistics still are taken.
  void end();
  double elapsed_s() const;

  report::FaultLog& faults() { return faults_; }
  /// All gathered so far; the services' use and the duration are the caller's.
  report::SessionReport report() const;
  const std::vector<report::Sample>& samples() const { return samples_; }

 private:
  void see(const wire::DeviceState& state);

  const Session session_;
  Participant participant_;
  HealthMonitor health_;
  Subscriber<wire::DeviceState> device_subscriber_;
  Subscriber<wire::SessionStats> stats_subscriber_;
  Subscriber<wire::SceneInfo> scene_subscriber_;

  std::optional<wire::DeviceState> device_;
  wire::Message<wire::SceneInfo> scene_, scene_incoming_;  // taking overwrites, also when there is nothing
  bool scene_known_ = false, script_done_ = false, proven_ = false;
  std::int64_t begun_ns_ = 0, ended_ns_ = 0;
  report::StatsByEpoch stats_;
  report::GoalWatch goal_;
  report::FaultLog faults_;
  std::vector<report::Sample> samples_;
};

}  // namespace tact::supervise
