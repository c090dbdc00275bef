#include "fault/fault.hpp"

#include <array>
#include <cstdio>
#include <cstdlib>

namespace tact {
namespace {
constexpr std::array kNames{"wrench_late",   "wrench_stale",  "contacts_full",      "not_finite",  "deadline_missed",
                            "motion_capped", "gate_limited",  "transport_degraded", "device_lost", "device_alarm",
                            "watchdog",      "sign_doubtful", "past_mid_surface",   "beyond_band", "peer_restarted",
                            "scene_changed", "device_data"};
}

std::string fault_names(std::uint32_t bits) {
  std::string names;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if ((bits >> i) & 1u) {
      if (!names.empty()) names += ", ";
      names += kNames[i];
    }
  }
  return names.empty() ? "none" : names;
}

void check_failed(const char* expression, const char* file, int line) noexcept {
  std::fprintf(stderr, "%s:%d: broken precondition: %s\n", file, line, expression);
  std::abort();
}

}  // namespace tact
