#pragma once
#include <atomic>
#include <vector>

#include "coupling/device/device.hpp"

namespace tact::coupling {

/// What a device gave in one recorded tick, and where its set-point was then.
struct PlaybackTick {
  DeviceReading reading;
  SetPoint set_point_before;  ///< pseudo-admittance: in force while it was read
  bool live = false;          ///< haptics were on
};

/// Gives the readings of a recorded session once more, one an executed tick, whatever is written: the handle moves as
/// it did. It waits, at rest, where the recorded haptics were on and these are not yet: the first seconds of two
/// sessions are never alike. Pseudo-admittance: the hand's wrench is that of the recorded driver's spring between the
/// recorded handle and the set-point of now, so a set-point that differs is drawn back to the recorded one:
///   F = F_recorded - K (x - x_recorded) - B (v - v_recorded)       x, v: set-point; exact where nothing differs
/// script_time_s counts played ticks over the rate. After the last tick the handle rests there.
class PlaybackDevice final : public HapticDevice {
 public:
  /// @pre ticks is not empty
  PlaybackDevice(const DeviceCapabilities& recorded, double rate_hz, std::vector<PlaybackTick> ticks);

  const DeviceCapabilities& capabilities() const noexcept override { return capabilities_; }
  rt::Tick wait_tick() noexcept override { return ticker_.wait(); }
  DeviceReading read() noexcept override;
  void write(const Wrench&) noexcept override { advance(); }
  void write(const SetPoint& set_point) noexcept override {
    set_point_ = set_point;
    advance();
  }
  SetPoint last_set_point() const noexcept override { return set_point_; }
  void cue(const HandCue& cue) noexcept override { live_ = cue.live; }
  void power_off() noexcept override { powered_.store(false, std::memory_order_relaxed); }

 private:
  void advance() noexcept;

  DeviceCapabilities capabilities_;
  double rate_hz_;
  rt::Ticker ticker_;
  std::vector<PlaybackTick> ticks_;
  std::size_t now_ = 0;
  bool live_ = false, waiting_ = false;
  SetPoint set_point_;
  std::atomic<bool> powered_{true};
};

}  // namespace tact::coupling
