#pragma once
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <optional>

namespace tact::bench {

/// Instructions of this thread outside the kernel, where the machine counts them and we may ask.
class InstructionCounter {
 public:
  InstructionCounter() {
    perf_event_attr what{};
    what.type = PERF_TYPE_HARDWARE;
    what.size = sizeof what;
    what.config = PERF_COUNT_HW_INSTRUCTIONS;
    what.disabled = 1;
    what.exclude_kernel = 1;
    what.exclude_hv = 1;
    fd_ = static_cast<int>(::syscall(SYS_perf_event_open, &what, 0, -1, -1, 0));
  }
  ~InstructionCounter() {
    if (fd_ >= 0) ::close(fd_);
  }
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  template <class F>
  std::optional<double> count(F&& call) {
    if (fd_ < 0) {
      call();
      return std::nullopt;
    }
    ::ioctl(fd_, PERF_EVENT_IOC_RESET, 0);
    ::ioctl(fd_, PERF_EVENT_IOC_ENABLE, 0);
    call();
    ::ioctl(fd_, PERF_EVENT_IOC_DISABLE, 0);
    std::uint64_t instructions = 0;
    if (::read(fd_, &instructions, sizeof instructions) != sizeof instructions) return std::nullopt;
    return static_cast<double>(instructions);
  }

 private:
  int fd_ = -1;
};

}  // namespace tact::bench
