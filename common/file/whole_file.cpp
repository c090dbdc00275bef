#include "file/whole_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <random>
#include <string>
#include <system_error>

#include "fault/fault.hpp"

namespace tact {
namespace {

/// The file under its first name; closed and removed unless it got its last one.
class Draft {
 public:
  Draft(const std::filesystem::path& path, mode_t mode) : path_(path) {
    std::random_device random;
    do {
      char suffix[8];
      std::snprintf(suffix, sizeof(suffix), ".%06x", random() & 0xffffffu);
      name_ = path.string() + suffix;
      fd_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    } while (fd_ < 0 && errno == EEXIST);
    if (fd_ < 0) refuse(errno);
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft() {
    if (fd_ >= 0) ::close(fd_);
    if (!name_.empty()) ::unlink(name_.c_str());
  }

  void write(const void* data, std::size_t bytes) {
    const char* at = static_cast<const char*>(data);
    while (bytes > 0) {
      const ssize_t n = ::write(fd_, at, std::min<std::size_t>(bytes, 1u << 30));
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) refuse(n < 0 ? errno : ENOSPC);
      at += n;
      bytes -= static_cast<std::size_t>(n);
    }
  }

  void publish(bool synced) {
    if (synced && ::fsync(fd_) != 0) refuse(errno);
    const int fd = fd_;
    fd_ = -1;
    if (::close(fd) != 0) refuse(errno);  // NFS says only here that the disk is full
    if (::rename(name_.c_str(), path_.c_str()) != 0) refuse(errno);
    name_.clear();
  }

 private:
  [[noreturn]] void refuse(int error) const {
    throw SetupError(path_.string() + ": cannot write: " + std::error_code(error, std::generic_category()).message() +
                     ": free some space, fix the folder's permissions or choose another place");
  }

  const std::filesystem::path& path_;
  std::string name_;
  int fd_ = -1;
};

}  // namespace

void write_whole(const std::filesystem::path& path, std::span<const std::span<const std::byte>> parts,
                 const WholeFileOptions& options) {
  Draft draft(path, options.mode);
  for (const auto& part : parts) draft.write(part.data(), part.size());
  draft.publish(options.synced);
}

void write_whole(const std::filesystem::path& path, std::string_view text, const WholeFileOptions& options) {
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(text))};
  write_whole(path, parts, options);
}

}  // namespace tact
