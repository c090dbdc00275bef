#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

namespace tact {

/// Thrown while configuring only, caught once in service_main. The text names the file, the field, what was found and
/// what to do: "alpha.toml: tool.points: found -3, expected 100 to 1000000".
class SetupError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What can go wrong while running: bits, never exceptions. Same values on the wire (Health, DeviceState,
/// SessionStats).
enum class Fault : std::uint32_t {
  none = 0,
  wrench_late = 1u << 0,         ///< a tick ran on an extrapolated wrench
  wrench_stale = 1u << 1,        ///< no fresh wrench within the fade: the device is calm
  contacts_full = 1u << 2,       ///< contact capacity exceeded, the deepest were kept
  not_finite = 1u << 3,          ///< a non-finite value was stopped by the gate or by the server
  deadline_missed = 1u << 4,     ///< the device loop skipped at least one grid point
  motion_capped = 1u << 5,       ///< the per-tick motion limit cut a motion
  gate_limited = 1u << 6,        ///< the gate clamped or slowed what went to the device
  transport_degraded = 1u << 7,  ///< RouDi gone or shared memory no longer proven
  device_lost = 1u << 8,
  device_alarm = 1u << 9,
  watchdog = 1u << 10,  ///< the watchdog cut power
  sign_doubtful = 1u << 11,
  past_mid_surface = 1u << 12,
  beyond_band = 1u << 13,
  peer_restarted = 1u << 14,
  scene_changed = 1u << 15,  ///< a restarted contact server has other bodies: refused, the device is calm
  device_data = 1u << 16,    ///< what the device said was refused: not finite, no rotation, or a jump
};

constexpr std::uint32_t bit(Fault f) noexcept { return static_cast<std::uint32_t>(f); }

/// "wrench_late, watchdog"; "none" for 0.
std::string fault_names(std::uint32_t bits);

[[noreturn]] void check_failed(const char* expression, const char* file, int line) noexcept;

}  // namespace tact

/// A broken precondition: ours, not the user's. Aborts with the place.
#define TACT_CHECK(expression) \
  ((expression) ? static_cast<void>(0) : ::tact::check_failed(#expression, __FILE__, __LINE__))
