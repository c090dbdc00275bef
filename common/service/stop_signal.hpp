#pragma once
#include <chrono>

namespace tact {

/// The wish to stop, by SIGINT, SIGTERM, SIGHUP (unless ignored, as under nohup) or request(). Made before the service
/// starts its threads; once set it stays set. One a process at a time; the previous signal handlers come back with the
/// destructor.
class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  /// True at once when stopping is wished, false after `limit` without. Any thread.
  bool wait_for(std::chrono::milliseconds limit) const;
  bool requested() const { return wait_for(std::chrono::milliseconds{0}); }

  /// As a signal would: from any thread.
  void request();
};

}  // namespace tact
