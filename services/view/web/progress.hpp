#pragma once
#include <cstdint>

namespace tact::view {

/// What the other end of a TCP connection has taken, as the kernel knows it from its acknowledgements.
struct Progress {
  std::uint64_t taken_bytes = 0;
  bool nothing_waits = true;  ///< all that was written has been taken; also when the kernel does not tell
};
Progress progress_of(int socket) noexcept;

}  // namespace tact::view
