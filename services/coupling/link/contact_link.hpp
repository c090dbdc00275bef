#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "coupling/link/first_scene.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "fault/fault.hpp"
#include "link/haptic_connector.hpp"
#include "link/haptic_thread.hpp"
#include "link/transport_proof.hpp"

namespace tact::coupling {

/// Coupling's end of the haptic connection: the device loop's mailboxes on one side, DDS on the other.
///
///   device loop --tool, bell--> send thread --dds_write--> contact server
///   device loop <----reply----- receive thread <--DDS----- contact server     replies of other epochs are dropped
///                                     ^
///                  supervisor: connects, proves the transport, replaces what died or hangs
///
/// The send and receive threads are real-time, below the device loop; two, so that a hanging write delays no reply. The
/// supervisor is not. It keeps phase and detail of Health from start() on:
///   kConnecting  until the first connection       kActive    poses and replies flow, transport proven
///   kConnecting  again after the server was lost  kDegraded  with Fault::transport_degraded: RouDi and all
///                                                            shared-memory processes must be restarted together
///   kDegraded    with Fault::scene_changed: a restarted server answers for other bodies than Params names. None of its
///                replies reaches the loop, which stays calm, until a server with the right ones comes back. The new
///                scene is not taken over: poses, inertia and the saturation would jump under the hand
class ContactLink {
 public:
  struct Params {
    int priority = 70;  ///< SCHED_FIFO of the send and receive threads; 0: normal
    int cpu = -1;
    ToolSample probe;     ///< the pose the transport is proven with: where the tool starts
    SceneIdentity scene;  ///< the one the loop was made for
  };

  /// The fault bits of Health this class sets and clears.
  static constexpr std::uint32_t kFaults =
      bit(Fault::transport_degraded) | bit(Fault::peer_restarted) | bit(Fault::scene_changed);

  /// Makes the haptic participant. `low` is the session participant; all references must outlive it.
  /// Throws SetupError: no RouDi, no loopback.
  ContactLink(const Session& session, const Participant& low, HealthReporter& health, Mailboxes& mail,
              const Params& params);
  ~ContactLink() { stop(); }
  ContactLink(const ContactLink&) = delete;
  ContactLink& operator=(const ContactLink&) = delete;

  void start();
  /// After the device rests. Returns within about a second, also when a thread hangs: it is left behind then.
  void stop();

  /// True once poses and replies flow; false after `limit`. Throws SetupError when the transport was refused: the peer
  /// speaks another, or shared memory was asked for and is not used. Call it in steps that look at the stop signal.
  bool wait_active(std::chrono::milliseconds limit);

  struct Status {
    bool active = false;
    std::uint64_t server_epoch = 0;      ///< 0: not connected
    std::uint32_t connections = 0;       ///< made since start
    std::optional<std::string> refused;  ///< why this link can never work
    TransportProof proof;                ///< of the last connection
  };
  Status status() const;

 private:
  /// One connection, shared with threads that may be left behind.
  struct Connection {
    std::shared_ptr<CouplingEnds> ends;
    std::uint64_t server_epoch = 0;
    bool refused = false;             // supervisor: another scene
    std::atomic<bool> proven{false};  // proof is complete; `proof` may be read
    TransportProof proof;
    std::atomic<std::uint64_t> sent{0};     // poses since the last reply
    std::atomic<std::int64_t> reply_ns{0};  // when the last reply came
  };

  void supervise();
  void connect(std::shared_ptr<CouplingEnds> ends);
  bool check_proof();
  void lose(const std::string& why);
  void report_waiting();
  void check_transport();
  void refuse(const std::string& why);
  bool stopping();

  void send(const std::shared_ptr<Connection>& connection, HapticThread::Control& control) noexcept;
  void receive(const std::shared_ptr<Connection>& connection, HapticThread::Control& control) noexcept;

  const std::string transport_;
  const std::uint64_t session_id_, epoch_;
  const Params params_;
  HealthReporter& health_;
  Mailboxes& mail_;
  Participant haptic_;
  HealthMonitor monitor_;
  HapticConnector<CouplingEnds> connector_;

  // Supervisor only.
  std::shared_ptr<Connection> connection_;
  std::unique_ptr<HapticThread> sender_, receiver_;
  std::string said_;
  std::chrono::steady_clock::time_point waiting_since_, transport_checked_;
  bool roudi_lost_ = false;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  Status status_;
  bool stop_ = false;
  std::thread supervisor_;
};

}  // namespace tact::coupling
