#pragma once
#include <atomic>
#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "coupling/link/scene_model.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "link/health.hpp"

namespace tact::coupling {

/// The scene's coupling keys as the loop takes them, version 0.
LoopParameters loop_parameters(const CouplingSpec& spec);

/// Coupling's place on the session domain, on a thread that is not real-time: publishes DeviceState (60 Hz) and
/// SessionStats (2 Hz and at the end), takes HandTarget and the parameters of service "coupling".
/// A parameter is acknowledged once the loop reports it in force. Hands are refused while a real device is engaged, and
/// let go when their writer has been silent for a second.
class SessionLink {
 public:
  /// All references must outlive it.
  SessionLink(const Session& session, const Participant& low, HealthReporter& health, Mailboxes& mail);
  ~SessionLink() { stop(); }
  SessionLink(const SessionLink&) = delete;
  SessionLink& operator=(const SessionLink&) = delete;

  /// Before start(): the scene as the contact server loaded it, empty after `limit`. Call it in steps that look at the
  /// stop signal; the server may bake for minutes first (its Health tells). Empty also for another scene than this
  /// session began with (first_scene): Health says Fault::scene_changed then, and the device stays closed until a
  /// server with the right one comes. Throws SetupError when the scene makes no sense (scene_model).
  std::optional<SceneModel> wait_scene(std::chrono::milliseconds limit);

  /// After it the loop may run. `in_force` is what the loop was made with.
  void start(const LoopParameters& in_force);
  /// After the loop's last status was written: publishes the final statistics.
  void stop();

 private:
  struct Pending {  // a parameter the loop has not reported yet
    wire::ParameterAck ack;
    std::chrono::steady_clock::time_point since;
  };

  void run();
  void publish_state();
  void publish_stats();
  void take_hand();
  void take_parameters();
  void acknowledge();

  const Session& session_;
  HealthReporter& health_;
  Mailboxes& mail_;
  const bool real_device_;
  Publisher<wire::DeviceState> state_;
  Publisher<wire::SessionStats> stats_;
  Publisher<wire::ParameterAck> acks_;
  Subscriber<wire::HandTarget> hands_;
  Subscriber<wire::Parameter> requests_;
  Subscriber<wire::SceneInfo> scenes_;

  SceneSpec scene_;  // with the parameters in force
  LoopParameters parameters_;
  std::vector<Pending> pending_;
  LoopStatus status_;
  bool any_status_ = false, holding_ = false;
  std::chrono::steady_clock::time_point hand_heard_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace tact::coupling
