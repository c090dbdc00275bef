#pragma once
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>

#include "link/write_guard.hpp"
#include "rt/thread.hpp"

namespace tact {

/// The real-time thread that writes one side of a haptic connection, and can be left behind when it hangs in a write.
class HapticThread {
 public:
  /// Shared with the body, which outlives the HapticThread when it hangs.
  struct Control {
    WriteGuard guard;
    std::atomic<bool> stop{false};  ///< asks the body to return within about 50 ms
    std::atomic<bool> done{false};
  };

  /// `body` writes only between guard.enter() and guard.leave(), and returns at once, touching nothing that it does not
  /// own, when leave() is false. What it needs for the write itself it shares (shared_ptr).
  HapticThread(const rt::ThreadOptions& options, std::function<void(Control&)> body);
  ~HapticThread() { finish(); }

  /// True once it hangs in a write: it is left behind from then on.
  bool hung();
  /// Stops and joins it; false when it hung and was left behind.
  bool finish();
  const std::vector<std::string>& missing() const { return thread_.missing(); }

 private:
  static constexpr std::chrono::milliseconds kWriteLimit{100};
  std::shared_ptr<Control> control_;
  bool hung_ = false;
  rt::Thread thread_;
};

}  // namespace tact
