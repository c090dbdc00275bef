#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "math/pose.hpp"
#include "rt/tick.hpp"

namespace tact::coupling {

/// Impedance: the device gives the handle's pose and twist and takes a wrench. Pseudo-admittance ([P] fig. 13): it
/// takes a set-point (pose and twist) and gives the wrench of the spring its driver keeps between handle and set-point.
enum class DeviceMode { impedance, pseudo_admittance };

/// "impedance", "pseudo-admittance".
const char* name(DeviceMode mode) noexcept;

struct DeviceCapabilities {
  std::string name;
  DeviceMode mode = DeviceMode::pseudo_admittance;  ///< it was opened in
  double force_peak_n = 0, torque_peak_nm = 0;
  /// Pseudo-admittance: the driver's spring between handle and set-point; the gate bounds their distance by it.
  double spring_n_per_m = 0, spring_nm_per_rad = 0;
  double damper_n_s_per_m = 0, damper_nm_s_per_rad = 0;  ///< the driver's damper beside it
  bool real = false;                                     ///< moves a real arm: hand targets are refused
};

struct DeviceReading {
  Pose X_WH;
  Twist V_WH;
  /// Of the hand on the handle about its origin. Impedance: zero unless the device can measure it.
  Wrench F_hand_W;
  bool engaged = false;  ///< powered, dead-man held, not indexing
  /// False: what the device said was refused and the last good pose stands here. The loop goes calm at the gate's
  /// slope; a device that goes on like this ends its engagement.
  bool trusted = true;
  std::uint32_t faults = 0;   ///< device_lost, device_alarm, device_data
  double script_time_s = -1;  ///< of a simulated hand; < 0: no script
  bool script_done = false;
};

struct SetPoint {
  Pose X_W;
  Twist V_W;
};

/// What a simulated hand must be told and a real one sees for itself.
struct HandCue {
  bool live = false;  ///< haptics are on: a person waits while they are not
  bool hold = false;  ///< a mouse holds the handle
  Pose X_WH_target;   ///< and wants it here
};

/// A haptic device, opened in one mode. One thread calls all of it, except power_off(). Destroying it rests the arm.
/// Frame H is at the tool's centre of mass To when handle and tool are together. Frames, signs: W, about H's origin,
/// linear before angular.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  virtual const DeviceCapabilities& capabilities() const noexcept = 0;

  /// Waits for the next tick: a clock of ours, or the driver's. The only call that may wait, for at most a few periods.
  virtual rt::Tick wait_tick() noexcept = 0;

  // The rest: real time, does not wait, allocate or throw.
  virtual DeviceReading read() noexcept = 0;

  /// Impedance: wrench of the device on the hand, held until the next write.
  virtual void write(const Wrench& F_W) noexcept = 0;
  /// Pseudo-admittance: held until the next write, moving at its twist.
  virtual void write(const SetPoint& set_point) noexcept = 0;
  virtual SetPoint last_set_point() const noexcept = 0;

  virtual void cue(const HandCue&) noexcept {}

  /// What a person should read about the device since the last call, a sentence each: "the emergency stop is pressed".
  /// From a thread that is not real-time, always the same.
  virtual std::vector<std::string> take_news() { return {}; }

  /// Cuts power: no force from now on, whatever is written. From any thread, at any time, also while another thread
  /// hangs inside one of the calls above: takes no lock.
  virtual void power_off() noexcept = 0;
};

}  // namespace tact::coupling
