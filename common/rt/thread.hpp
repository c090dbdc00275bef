#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace tact::rt {

struct ThreadOptions {
  std::string name = "tact";          ///< at most 15 characters: `ps -L`, `top -H`
  int priority = 0;                   ///< SCHED_FIFO 1..99; 0: normal scheduling
  int cpu = -1;                       ///< pinned to this CPU; -1: any
  std::size_t stack_bytes = 1 << 20;  ///< allocated by us and touched before the body runs
};

/// A thread of our own with a scheduling class. The body must not throw. What the system refuses (priority, affinity)
/// does not stop it: it runs without, and missing() says what, what it costs and what to do. Threads it creates inherit
/// its class.
class Thread {
 public:
  /// Returns once the thread is set up and about to run `body`. Throws SetupError when no thread can be made at all.
  Thread(const ThreadOptions& options, std::function<void()> body);
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;
  ~Thread() { join(); }

  /// Waits for the body to end: the body decides when.
  void join();
  /// Leaves the thread to itself: for one that hangs in a call that will never return.
  void detach();

  /// One sentence for each thing the system refused; empty when all is as asked for.
  const std::vector<std::string>& missing() const { return missing_; }

 private:
  unsigned long handle_ = 0;  // pthread_t
  std::vector<std::string> missing_;
};

}  // namespace tact::rt
