#pragma once
#include <cstdint>
#include <string>

#include "math/pose.hpp"

namespace tact::view {

/// Where a client wants the tool's mesh frame; hold false: it let go.
struct HandCommand {
  Pose X_WM;
  bool hold = false;
};

/// A value a client wants changed, and what the service that owns it says.
struct ParameterRequest {
  std::uint64_t request_id = 0;
  std::string service, key, value;
};
struct ParameterAnswer {
  std::uint64_t request_id = 0;
  std::string key, value;  ///< in force now
  bool accepted = false;
  std::string message;  ///< why not
};

}  // namespace tact::view
