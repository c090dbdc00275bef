#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "link/wire.hpp"
#include "session/session.hpp"

namespace tact {

/// SCHED_FIFO priority of the haptic domain's own threads (shared-memory listener, keep-alive): above every real-time
/// thread of ours, for a starved one stops the data.
inline constexpr int kTransportPriority = 85;

/// Where a process meets the others of its session. Two domains, both on the loopback interface only:
///   session  UDP: every service and tool, all low-rate topics `rt/tact/<session>/<topic>`
///   haptic   shared memory (or UDP when the machine file says transport = "udp"): tact-contact and tact-coupling only
/// One domain object a process and kind, shared by its participants; the two domains of one process are of one session.
class Participant {
 public:
  /// Threads that Cyclone starts for the domain (receive, shared-memory listener, keep-alive) inherit these: they must
  /// not starve while real-time threads run, so they rank above them.
  struct Threads {
    int priority = 0;  ///< SCHED_FIFO; 0: normal
    int cpu = -1;
  };

  /// Throws SetupError when the domain cannot be made, and, for shared memory, when RouDi is not reachable: iceoryx
  /// itself would wait 60 s and abort().
  Participant(wire::Channel kind, const Session& session) : Participant(kind, session, Threads{}) {}
  Participant(wire::Channel kind, const Session& session, const Threads& threads);
  /// A haptic participant is leaked instead when endpoints were abandoned: their destruction may hang.
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  std::int32_t entity() const { return entity_; }
  wire::Channel kind() const { return kind_; }
  const std::string& session_name() const { return session_name_; }

  /// Haptic, shared memory: false once RouDi is gone, hung, or another one than at creation. Existing endpoints go on,
  /// new ones must not be made. Otherwise always true. Some system calls; up to 100 ms when RouDi hangs.
  bool transport_intact() const;

 private:
  struct Domain;
  std::shared_ptr<Domain> domain_;
  std::int32_t entity_ = 0;
  wire::Channel kind_;
  std::string session_name_;
  std::uint64_t roudi_instance_ = 0;  // 0: no shared memory
};

/// True once something of this process was abandoned: leave by _Exit, its destructors may hang. service_main does.
bool endpoints_abandoned() noexcept;
void note_endpoints_abandoned() noexcept;

/// Start of this process since the machine's, ns: larger after each restart, whatever happens to the wall clock. The
/// incarnation ("epoch") on the wire.
std::uint64_t process_epoch();

}  // namespace tact
