#include "supervise/tcp_port.hpp"

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <memory>

#include "fault/fault.hpp"

namespace tact::supervise {

int usable_port(const std::string& address, int port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
  addrinfo* found = nullptr;
  if (::getaddrinfo(address.c_str(), std::to_string(port).c_str(), &hints, &found) != 0) {
    throw SetupError("view.bind: found \"" + address + "\", expected an address of this machine");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> info(found, ::freeaddrinfo);
  const int socket = ::socket(info->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool bound = ::bind(socket, info->ai_addr, info->ai_addrlen) == 0 && ::listen(socket, 1) == 0;
  const int error = errno;
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  ::getsockname(socket, reinterpret_cast<sockaddr*>(&name), &size);
  ::close(socket);
  if (!bound) {
    const std::string where = "view.port: " + std::to_string(port) + " on " + address;
    if (error == EADDRINUSE) {
      throw SetupError(where +
                       " is taken by another program; choose another with --port, or --port 0 for any free one");
    }
    throw SetupError(where + " cannot be listened on: " + std::strerror(error));
  }
  return ntohs(name.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(name).sin6_port
                                          : reinterpret_cast<sockaddr_in&>(name).sin_port);
}

}  // namespace tact::supervise
