// Is there a RouDi, and does it read its messages? Asked of its socket, without speaking iceoryx.
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <thread>

#include "fault/fault.hpp"
#include "link/roudi.hpp"
#include "link/roudi_probe.hpp"

namespace tact {

RoudiState probe_roudi(std::chrono::milliseconds patience) {
  const int file = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (file < 0) return RoudiState::absent;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::snprintf(address.sun_path, sizeof address.sun_path, "%s", kRoudiSocket);
  RoudiState state = RoudiState::absent;
  if (::connect(file, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    // Its receive queue holds about ten messages and clients send three a second each: full means that nobody reads.
    pollfd wanted{file, POLLOUT, 0};
    state = ::poll(&wanted, 1, static_cast<int>(patience.count())) > 0 ? RoudiState::reachable : RoudiState::hung;
  } else if (errno == EACCES || errno == EPERM) {
    state = RoudiState::forbidden;
  }
  ::close(file);
  return state;
}

std::uint64_t roudi_instance() noexcept {
  struct stat socket {};
  if (::stat(kRoudiSocket, &socket) != 0) return 0;
  return static_cast<std::uint64_t>(socket.st_ctim.tv_sec) * 1'000'000'000u +
         static_cast<std::uint64_t>(socket.st_ctim.tv_nsec);
}

void require_roudi(std::chrono::milliseconds limit) {
  const auto until = std::chrono::steady_clock::now() + limit;
  for (;;) {
    const RoudiState state = probe_roudi(std::chrono::seconds{1});
    if (state == RoudiState::reachable) return;
    if (state == RoudiState::forbidden) {
      throw SetupError(std::string("RouDi: ") + kRoudiSocket +
                       ": permission denied: it runs as another user. Run as that user or join its group as primary "
                       "group (newgrp), or choose transport = \"udp\"");
    }
    if (std::chrono::steady_clock::now() > until) {
      throw SetupError(state == RoudiState::hung
                           ? std::string("RouDi: it runs but reads no messages; stop all sessions and kill iox-roudi")
                           : std::string("RouDi: not running (nothing listens on ") + kRoudiSocket +
                                 "); start the session with `tact run`, or choose transport = \"udp\"");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
}

}  // namespace tact
