#pragma once
#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "contact/pipeline/contact_pipeline.hpp"
#include "contact/server/contact_snapshot.hpp"
#include "link/haptic_connector.hpp"
#include "link/haptic_thread.hpp"
#include "rt/latest_value.hpp"

namespace tact::contact {

/// The contact server's end of the haptic connection: answers the newest pose, nothing else.
///
///   coupling --ToolPose--> serve thread: pipeline.step --ContactWrench--> coupling
///                              |  60 times a second
///                              +--> snapshot mailbox --> SessionLink
///
/// The serve thread is real-time: once connected it neither allocates nor locks (Cyclone frees one sample a take). A
/// supervisor, which is not, connects it to each coupling incarnation and replaces it when it hangs. It
/// keeps phase and detail of Health from start() on: kConnecting, kActive.
class PoseServer {
 public:
  struct Params {
    int priority = 60;  ///< SCHED_FIFO; below coupling's threads; 0: normal
    int cpu = -1;
    std::size_t capacity = 0;  ///< of the pipeline's contact buffer
    std::uint64_t field_hash = 0, shell_hash = 0;
  };

  /// Makes the haptic participant; all references must outlive it. Throws SetupError: no RouDi, no loopback.
  PoseServer(const Session& session, const Participant& low, HealthReporter& health, ContactPipeline& pipeline,
             const Params& params);
  ~PoseServer() { stop(); }
  PoseServer(const PoseServer&) = delete;
  PoseServer& operator=(const PoseServer&) = delete;

  void start();
  void stop();

  /// Why this server can never work with the coupling it met.
  std::optional<std::string> refused() const;

  rt::LatestValue<ContactSnapshot>& snapshots() { return *snapshots_; }
  /// Status bits of all replies since the last call.
  std::uint32_t take_status() noexcept { return status_.exchange(0, std::memory_order_relaxed); }

 private:
  void supervise();
  void serve(const std::shared_ptr<ContactEnds>& ends, std::uint64_t coupling_epoch,
             HapticThread::Control& control) noexcept;
  void lose(const std::string& why);
  void say(wire::Phase phase, const std::string& text);

  const std::string transport_;
  const std::uint64_t session_id_, epoch_;
  const Params params_;
  HealthReporter& health_;
  ContactPipeline& pipeline_;
  Participant haptic_;
  HealthMonitor monitor_;
  HapticConnector<ContactEnds> connector_;

  // The serve thread's.
  SnapshotTaker taker_;
  std::unique_ptr<ContactSnapshot> snapshot_;
  std::unique_ptr<rt::LatestValue<ContactSnapshot>> snapshots_;
  std::atomic<std::uint32_t> status_{0};
  std::atomic<std::int64_t> pose_ns_{0};  // when the last pose came

  std::unique_ptr<HapticThread> thread_;  // supervisor only
  std::string said_;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::optional<std::string> refused_;
  std::thread supervisor_;
};

}  // namespace tact::contact
