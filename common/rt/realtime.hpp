#pragma once
#include <cstdint>
#include <string>

namespace tact::rt {

/// Locks all present and future memory of the process (mlockall), so that no tick waits for a page. Returns what is
/// missing and what to do, empty when done. Refuses without trying when the limit is too small for what will follow:
/// a locked process whose limit runs out later cannot allocate at all. Does nothing in sanitizer builds.
std::string lock_memory();

/// Keeps the CPUs out of deep idle states while it lives, by holding /dev/cpu_dma_latency open at 0: the largest single
/// gain in wake-up latency. One a process is enough.
class CpuDmaLatency {
 public:
  CpuDmaLatency();
  ~CpuDmaLatency();
  CpuDmaLatency(const CpuDmaLatency&) = delete;
  CpuDmaLatency& operator=(const CpuDmaLatency&) = delete;

  /// What is missing, what it costs and what to do; empty when held.
  const std::string& missing() const { return missing_; }

 private:
  int file_ = -1;
  std::string missing_;
};

/// Page faults of the calling thread since it began, minor and major together. One system call, no allocation.
std::uint64_t thread_page_faults() noexcept;

}  // namespace tact::rt
