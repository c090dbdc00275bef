#include "rt/realtime.hpp"

#include <fcntl.h>
#include <linux/capability.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace tact::rt {
namespace {

#ifndef TACT_SANITIZED
/// Enough for a service with its shared memory mapped; below it we do not lock.
constexpr rlim_t kLockedBytesNeeded = rlim_t{1} << 30;

bool may_lock_without_limit() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3]{};
  if (syscall(SYS_capget, &header, data) != 0) return false;
  return (data[0].effective & (1u << CAP_IPC_LOCK)) != 0;
}
#endif

}  // namespace

std::string lock_memory() {
#ifdef TACT_SANITIZED
  return {};
#else
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  const bool enough = limit.rlim_cur == RLIM_INFINITY || limit.rlim_cur >= kLockedBytesNeeded;
  const std::string remedy =
      ": ticks may wait for pages; allow `memlock unlimited` for this user in /etc/security/limits.d, or run as root";
  if (!enough && !may_lock_without_limit()) {
    return "memory not locked: the limit is " + std::to_string(limit.rlim_cur >> 20) + " MB, 1024 MB are needed" +
           remedy;
  }
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
    return std::string("memory not locked (") + std::strerror(errno) + ")" + remedy;
  }
  return {};
#endif
}

CpuDmaLatency::CpuDmaLatency() {
  constexpr const char* kPath = "/dev/cpu_dma_latency";
  const std::int32_t microseconds = 0;
  file_ = ::open(kPath, O_WRONLY | O_CLOEXEC);
  if (file_ >= 0 && ::write(file_, &microseconds, sizeof microseconds) == sizeof microseconds) return;
  missing_ = std::string(kPath) + " not held at 0 (" + std::strerror(errno) +
             "): CPUs fall into deep idle between ticks, wake-up and round trip take several times as long; make it "
             "writable for this user's group by a udev rule, or run as root";
}

CpuDmaLatency::~CpuDmaLatency() {
  if (file_ >= 0) ::close(file_);
}

std::uint64_t thread_page_faults() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt) + static_cast<std::uint64_t>(usage.ru_majflt);
}

}  // namespace tact::rt
