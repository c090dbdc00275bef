#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tact::supervise {

/// How a process ended.
struct Ending {
  int code = 0;    ///< exit code, when signal is 0
  int signal = 0;  ///< that killed it
  bool clean() const { return code == 0 && signal == 0; }
};

/// A service running as our child: in a process group of its own, so that Ctrl-C reaches us alone and we stop it in
/// order; told SIGTERM by the kernel if we die. Its output goes to a file. The thread that starts it must live as long.
class ChildProcess {
 public:
  /// Throws SetupError when the program cannot be started.
  ChildProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments,
               const std::filesystem::path& log);
  ~ChildProcess();  ///< stops it, by SIGKILL when SIGTERM does not within a second
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  pid_t pid() const { return pid_; }
  /// How it ended; empty while it runs. Does not wait.
  const std::optional<Ending>& poll();
  void signal(int number);
  /// Waits for the end, at most `grace`; then kills the whole group. Call signal(SIGTERM) before.
  const Ending& finish(std::chrono::milliseconds grace);

 private:
  pid_t pid_ = -1;
  std::optional<Ending> ending_;
};

/// Why a service ended, for a person: the last error in its log, or the signal and its last words.
std::string reason_of(const Ending& ending, const std::filesystem::path& log);

/// Resident memory and CPU time of a process now; zeros when it is gone.
struct ProcessUse {
  double resident_mb = 0, cpu_s = 0;
};
ProcessUse use_of(pid_t pid);

}  // namespace tact::supervise
