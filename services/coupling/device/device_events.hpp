#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace tact::coupling {

/// What can happen to a simulated arm and to the hand on it, for tests and for people to try.
enum class DeviceEvent : std::uint8_t {
  grip_soft,    ///< a relaxed hand: a quarter of the stiffness, half the damping and strength
  grip_stiff,   ///< a tense hand: 2.5 times the stiffness
  grip_absent,  ///< nobody holds the handle; afterwards it is taken where it is
  dead_man,     ///< released: motors off
  e_stop,       ///< pressed: motors off
  power,        ///< off: motors off
  indexing,     ///< offset button: motors off, the reported pose stands while the arm moves, and goes on from there
  alarm,        ///< the arm's own: motors off, device_alarm
  overheat,     ///< motors too hot: force limited to the continuous one, device_alarm
  lost,         ///< nothing is heard from the arm, its driver has cut the motors: device_lost, the last reading
  nan,          ///< lies: a position that is no number
  jump,         ///< lies: 0.3 m beside
  quaternion,   ///< lies: not of unit length
};
inline constexpr std::size_t kDeviceEvents = 13;

/// "grip-soft", "dead-man", "e-stop", ...
const char* name(DeviceEvent event) noexcept;

struct TimedEvent {
  double time_s = 0, duration_s = 0;  ///< since haptics were first live; simulated time
  DeviceEvent event = DeviceEvent::dead_man;
};

/// CSV, first line exactly time_s,event,duration_s. Throws SetupError "<file>: line <n>: found ..., expected ...".
std::vector<TimedEvent> load_device_events(const std::filesystem::path& csv);

/// Which of them are on at a time, as bits 1 << event.
std::uint32_t active_events(const std::vector<TimedEvent>& events, double time_s) noexcept;
constexpr bool on(std::uint32_t bits, DeviceEvent event) noexcept {
  return ((bits >> static_cast<unsigned>(event)) & 1u) != 0;
}

}  // namespace tact::coupling
