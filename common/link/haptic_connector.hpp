#pragma once
#include <chrono>
#include <memory>
#include <string>

#include "link/haptic_ends.hpp"
#include "link/health.hpp"

namespace tact {

/// Brings one side of the haptic connection up, and notices when it is lost. Used from one thread that may wait.
///
///   coupling                          Health on the session domain                    contact
///   sees contact >= kConnecting  <--  epoch, phase  -->                 sees coupling >= kConnecting
///   makes endpoints named by both epochs                                makes endpoints named by both epochs
///                                <--  shared_memory_capable  -->
///                                <--  peer_epoch = ours, once matched   matched: its reader knows our writer
///   matched and named by the peer: connected, may write                 answers what arrives
///
/// Ends is CouplingEnds or ContactEnds.
template <class Ends>
class HapticConnector {
 public:
  /// All arguments must outlive it. `transport` is "shm" or "udp".
  HapticConnector(const Participant& haptic, const std::string& transport, HealthReporter& health,
                  HealthMonitor& monitor)
      : haptic_(haptic), transport_(transport), health_(health), monitor_(monitor) {}

  /// One step, at most about 20 ms (3 s when making endpoints hangs): the endpoints once connected, else empty.
  /// state() then says what is waited for. Throws SetupError when it can never work: the peer uses another transport,
  /// shared memory was asked for and an endpoint of either side cannot use it.
  std::shared_ptr<Ends> poll();

  /// The peer of the last connection was heard less than `silence` ago, as the same incarnation. A second means dead;
  /// 300 ms leave no doubt that it lives.
  bool peer_alive(std::chrono::milliseconds silence = std::chrono::seconds{1});

  /// Forgets the connection. With a peer that surely lives, or that stopped in order, the endpoints are destroyed;
  /// otherwise, and when a thread `hung` in them, they are abandoned: their destruction may hang after a crash. The
  /// caller's copies may live on, unused.
  void drop(bool hung = false);

  /// What is waited for, one sentence: "waiting for the contact server (loading, 40 %)".
  const std::string& state() const { return state_; }
  std::uint64_t peer_epoch() const { return peer_epoch_; }
  /// The peer can be connected to: if that does not succeed within seconds, something is stuck.
  bool peer_ready() const { return peer_ready_; }

 private:
  std::shared_ptr<Ends> make(std::uint64_t peer_epoch);
  void publish();

  const Participant& haptic_;
  const std::string transport_;
  HealthReporter& health_;
  HealthMonitor& monitor_;
  std::shared_ptr<Ends> ends_;
  std::uint64_t peer_epoch_ = 0;  // of ends_
  bool peer_ready_ = false;
  std::string state_;
};

extern template class HapticConnector<CouplingEnds>;
extern template class HapticConnector<ContactEnds>;

}  // namespace tact
