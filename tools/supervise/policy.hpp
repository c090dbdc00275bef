#pragma once
#include <chrono>
#include <deque>
#include <optional>

namespace tact::supervise {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using Duration = Clock::duration;

/// When to start a dead service again: at once the first time, then after 0.25 s, 0.5 s, 1 s, ...; not any more after
/// `limit` deaths within a minute.
class RestartPolicy {
 public:
  explicit RestartPolicy(std::size_t limit = 5) : limit_(limit) {}
  /// How long to wait before the next start; empty: give up.
  std::optional<Duration> after_death(Time now);

 private:
  std::size_t limit_;
  std::deque<Time> deaths_;
};

/// A killed process can leave iceoryx queues locked for ever. Its successor uses new topic names; when that brings no
/// fresh wrench within two seconds of both ends being up, only new shared memory helps.
class FreshWatch {
 public:
  static constexpr Duration kPatience = std::chrono::seconds{2};

  void restarted() {
    armed_ = true;
    since_.reset();
  }
  /// True when RouDi and all shared-memory processes must be restarted together; then waits for the next restarted().
  bool stuck(Time now, bool both_up, bool fresh);

 private:
  bool armed_ = false;
  std::optional<Time> since_;
};

/// RouDi's death leaves existing pairs running. They are restarted with a new RouDi when the hand is out of contact for
/// a moment, or after ten seconds whatever it does.
class RoudiWatch {
 public:
  static constexpr Duration kLongest = std::chrono::seconds{10};
  static constexpr Duration kOutOfContact = std::chrono::milliseconds{300};

  bool lost() const { return lost_.has_value(); }
  /// True when it is time for the restart; forgets the loss.
  bool restart_now(Time now, bool roudi_alive, bool in_contact);

 private:
  std::optional<Time> lost_, free_;
};

}  // namespace tact::supervise
