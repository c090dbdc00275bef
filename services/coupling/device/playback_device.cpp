#include "coupling/device/playback_device.hpp"

#include <cmath>

#include "math/exp_log.hpp"

namespace tact::coupling {

PlaybackDevice::PlaybackDevice(const DeviceCapabilities& recorded, double rate_hz, std::vector<PlaybackTick> ticks)
    : capabilities_(recorded),
      rate_hz_(rate_hz),
      ticker_(static_cast<std::int64_t>(std::llround(1e9 / rate_hz))),
      ticks_(std::move(ticks)),
      set_point_(ticks_.front().set_point_before) {
  capabilities_.name = "playback";
  capabilities_.real = false;
}

DeviceReading PlaybackDevice::read() noexcept {
  const PlaybackTick& now = ticks_[now_];
  DeviceReading reading = now.reading;
  reading.engaged = reading.engaged && powered_.load(std::memory_order_relaxed);
  reading.script_done = now_ + 1 == ticks_.size();
  reading.script_time_s = static_cast<double>(now_) / rate_hz_;
  if (waiting_ || reading.script_done) reading.V_WH = {};
  if (capabilities_.mode == DeviceMode::pseudo_admittance && reading.engaged) {
    const Vec6 v = set_point_.V_W.vector() - now.set_point_before.V_W.vector();
    const Vec6 x = displacement(now.set_point_before.X_W, set_point_.X_W) + v / rate_hz_;  // it moves on at its twist
    reading.F_hand_W.force -= capabilities_.spring_n_per_m * x.head<3>() + capabilities_.damper_n_s_per_m * v.head<3>();
    reading.F_hand_W.torque -=
        capabilities_.spring_nm_per_rad * x.tail<3>() + capabilities_.damper_nm_s_per_rad * v.tail<3>();
  }
  return reading;
}

void PlaybackDevice::advance() noexcept {
  waiting_ = ticks_[now_].live && !live_;
  if (!waiting_ && now_ + 1 < ticks_.size()) ++now_;
}

}  // namespace tact::coupling
