#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tact::test {

/// A real child process in a process group of its own; its output (stdout and stderr together) goes to a file.
/// Whatever still runs at the end of a test is killed, with its group.
class Process {
 public:
  Process(std::vector<std::string> command, std::filesystem::path log,
          std::map<std::string, std::string> environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  pid_t pid() const { return pid_; }
  void signal(int number) const;
  /// Exit code, or 128 + signal; empty when it still runs after `limit`.
  std::optional<int> wait(std::chrono::milliseconds limit);
  std::string output() const;

 private:
  pid_t pid_ = -1;
  std::filesystem::path log_;
  std::optional<int> result_;
};

/// Polls until `condition` holds; false after `limit`. The limit is a safety net, not an assertion about speed.
bool eventually(const std::function<bool()>& condition, std::chrono::milliseconds limit = std::chrono::seconds{30});

/// Processes now running whose executable's file name is `name`.
std::vector<pid_t> pids_of(const std::string& name);

/// Files in /dev/shm that iceoryx or we made.
std::vector<std::string> shared_memory_files();

/// A directory of this test's own, removed at the end.
class ScratchDir {
 public:
  ScratchDir();
  ~ScratchDir();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tact::test
