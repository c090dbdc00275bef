#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tact::supervise {

/// Where this user's sessions keep their files: $XDG_RUNTIME_DIR/tact, for root /run/tact, else /tmp/tact-<uid>.
std::filesystem::path run_root();

/// A session's directory, for us alone (0700), held by a lock for as long as the session runs and removed with it. What
/// a killed supervisor left is taken over.
class RunDir {
 public:
  /// Throws SetupError when a session of that name runs, or the directory cannot be made.
  explicit RunDir(const std::string& session);
  ~RunDir();
  RunDir(const RunDir&) = delete;
  RunDir& operator=(const RunDir&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int lock_ = -1;
};

/// Directories of sessions now running, sorted by name.
std::vector<std::filesystem::path> running_sessions();

}  // namespace tact::supervise
