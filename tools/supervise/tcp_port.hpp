#pragma once
#include <string>

namespace tact::supervise {

/// `port` if a server can listen there now, a free one if it is 0. Throws SetupError: taken, no such address,
/// forbidden.
int usable_port(const std::string& address, int port);

}  // namespace tact::supervise
