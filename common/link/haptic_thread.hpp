#pragma once
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "link/call_guard.hpp"
#include "rt/thread.hpp"

namespace tact {

/// The real-time thread that speaks for one side of a haptic connection, and can be left behind when it hangs in DDS.
class HapticThread {
 public:
  /// Shared with the body, which outlives the HapticThread when it hangs.
  struct Control {
    CallGuard guard;
    std::atomic<bool> stop{false};  ///< asks the body to return within about 50 ms
    std::atomic<bool> done{false};
  };

  /// `body` calls DDS only between guard.enter_...() and guard.leave(), and returns at once, touching nothing that it
  /// does not own, when leave() is false. What it needs for the call itself it shares (shared_ptr) or has on its stack.
  /// Outside such calls it never waits for long.
  HapticThread(const rt::ThreadOptions& options, std::function<void(Control&)> body);
  ~HapticThread() { finish(); }

  /// True once it hangs in a write: it is left behind from then on.
  bool hung();
  /// Stops and joins it; false when it hung in DDS, about a second after the call at the latest, and was left behind.
  bool finish();
  const std::vector<std::string>& missing() const { return thread_.missing(); }

 private:
  void leave_behind();

  static constexpr std::chrono::milliseconds kWriteLimit{100};
  static constexpr int kFinishLimit = 1000;  // looks, a millisecond apart: a process that was stopped has not hung
  std::shared_ptr<Control> control_;
  bool hung_ = false;
  rt::Thread thread_;
};

}  // namespace tact
