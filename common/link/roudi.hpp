#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>

namespace tact {

/// Throws SetupError, saying what to do, when no RouDi (iceoryx's daemon) takes connections on this machine, within
/// `limit`. Clients call it before they touch shared memory: iceoryx would wait 60 s and abort().
void require_roudi(std::chrono::milliseconds limit = std::chrono::seconds{10});

/// A share in the machine's one RouDi. RouDi belongs to the machine, not to a session: the first lease starts it, the
/// last one stops it and removes its shared memory. Shares are flock()s, so a crashed holder's share goes with it; a
/// RouDi left behind by crashed sessions is replaced by the next first lease. A RouDi that somebody else runs is used
/// and never stopped. Supervisors hold a lease while shared-memory services run; services do not.
///
///   /tmp/tact-roudi.lock    held exclusively while RouDi is started or stopped
///   /tmp/tact-roudi.users   held shared by every lease
///   /tmp/tact-roudi.pid     "<pid> <start time>" of the RouDi we started
///   /tmp/tact-roudi.log     its output
class RoudiLease {
 public:
  /// Starts RouDi when there is none, in a session of its own so that Ctrl-C and the holder's end pass it by, and waits
  /// until it is ready. Throws SetupError: not installed, /dev/shm too small or not permitted, not ready in 10 s.
  explicit RoudiLease(const std::filesystem::path& roudi_toml);
  /// The last lease stops our RouDi, after all clients are gone, and removes what it leaves.
  ~RoudiLease();
  RoudiLease(const RoudiLease&) = delete;
  RoudiLease& operator=(const RoudiLease&) = delete;

  /// False when the RouDi of this lease ended, was replaced, or reads no messages any more (hung). Cheap; up to 1 s
  /// when hung.
  bool is_alive() const;

  /// Kills our RouDi if it still is there and starts a new one; adopts the one another session restarted meanwhile. All
  /// shared-memory processes of this session must be stopped before and started after: old and new ones would match
  /// and exchange nothing. Throws SetupError.
  void restart();

  /// Somebody else runs it: never stopped or restarted by us.
  bool foreign() const { return foreign_; }
  /// Of our RouDi; 0 when foreign.
  pid_t pid() const { return identity_.pid; }

 private:
  struct Identity {  ///< a pid alone may be reused
    pid_t pid = 0;
    unsigned long long start_time = 0;
    bool operator==(const Identity&) const = default;
    bool running() const;  ///< a zombie does not
    void kill() const;     ///< and waits for its end
  };
  class Transition;

  void obtain();
  void start();
  static Identity recorded();
  static void remove_leftovers();

  friend bool leave_roudi() noexcept;

  std::filesystem::path toml_;
  int users_file_ = -1;
  bool foreign_ = false;
  Identity identity_;
};

/// For services: this process is a client now and counts as a user. Again: nothing. Throws SetupError.
void join_roudi();
/// At the very end: no longer. When the process that started this one was killed meanwhile and nobody else uses RouDi,
/// stops it in that one's place: true, and iceoryx has nobody left to say farewell to (leave by _Exit).
bool leave_roudi() noexcept;

}  // namespace tact
