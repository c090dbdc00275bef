#include "supervise/run_dir.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "fault/fault.hpp"

namespace tact::supervise {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLockName = "lock";

/// The directory, made if need be, and refused when it is not ours alone: others could replace what we write.
void make_private(const fs::path& path) {
  std::error_code error;
  if (path.has_parent_path()) fs::create_directories(path.parent_path(), error);
  if (::mkdir(path.c_str(), 0700) != 0 && errno != EEXIST) {
    throw SetupError(path.string() + ": cannot make this directory: " + std::strerror(errno));
  }
  struct stat info {};
  if (::lstat(path.c_str(), &info) != 0 || !S_ISDIR(info.st_mode) || info.st_uid != ::geteuid()) {
    throw SetupError(path.string() + ": is not a directory of ours; remove it, or set XDG_RUNTIME_DIR");
  }
  ::chmod(path.c_str(), 0700);
}

/// An open, locked file; -1 when somebody else holds the lock or there is no such file.
int try_lock(const fs::path& path, int flags) {
  const int file = ::open(path.c_str(), O_RDWR | O_CLOEXEC | flags, 0600);
  if (file >= 0 && ::flock(file, LOCK_EX | LOCK_NB) != 0) {
    ::close(file);
    return -1;
  }
  return file;
}

}  // namespace

fs::path run_root() {
  if (const char* dir = std::getenv("XDG_RUNTIME_DIR"); dir != nullptr && *dir == '/' && ::access(dir, W_OK) == 0) {
    return fs::path(dir) / "tact";
  }
  if (::geteuid() == 0) return "/run/tact";
  return "/tmp/tact-" + std::to_string(::geteuid());
}

RunDir::RunDir(const std::string& session) : path_(run_root() / session) {
  make_private(run_root());
  make_private(path_);
  lock_ = try_lock(path_ / kLockName, O_CREAT);
  if (lock_ < 0) {
    throw SetupError("session: \"" + session + "\" is already running (" + path_.string() +
                     "); choose another name with --session");
  }
  for (const auto& entry : fs::directory_iterator(path_)) {
    if (entry.path().filename() != kLockName) fs::remove_all(entry.path());
  }
}

RunDir::~RunDir() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  ::close(lock_);
}

std::vector<fs::path> running_sessions() {
  std::vector<fs::path> found;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(run_root(), error)) {
    const fs::path lock = entry.path() / kLockName;
    if (!fs::exists(lock, error)) continue;
    const int file = try_lock(lock, 0);
    if (file < 0) found.push_back(entry.path());
    if (file >= 0) ::close(file);
  }
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace tact::supervise
