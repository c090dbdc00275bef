#include "coupling/device/virtuose/virtuose_device.hpp"

#include <algorithm>
#include <cmath>

#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling::virtuose {
namespace {

// Nobody moves a handle faster; what does is no motion.
constexpr double kSpeedMax_m_per_s = 5, kSpeedMax_rad_per_s = 60;
constexpr double kNoise_m = 1e-3, kNoise_rad = 2e-2;
constexpr double kGap_s = 0.02;
constexpr std::int64_t kNoPowerPatience_ns = 5'000'000'000;
constexpr std::int64_t kAlarmsApart_ns = 1'000'000'000;

}  // namespace

VirtuoseDevice::VirtuoseDevice(const Library& library, const Params& params)
    : params_(params),
      ticker_(static_cast<std::int64_t>(std::llround(1e9 / params.settings.rate_hz))),
      keeper_(std::make_unique<Keeper>(library, params.settings)) {
  const Settings& s = params.settings;
  capabilities_.name = "virtuose";
  capabilities_.mode = s.mode;
  capabilities_.real = true;
  capabilities_.force_peak_n = s.force_limit_n;
  capabilities_.torque_peak_nm = s.torque_limit_nm;
  if (s.mode == DeviceMode::pseudo_admittance) {
    capabilities_.spring_n_per_m = s.spring.n_per_m;
    capabilities_.spring_nm_per_rad = s.spring.nm_per_rad;
    capabilities_.damper_n_s_per_m = s.spring.n_s_per_m;
    capabilities_.damper_nm_s_per_rad = s.spring.nm_s_per_rad;
  }
  keeper_->parked_pose(good_.X_WH);
  set_point_.X_W = good_.X_WH;
  if (!params.check_only) keeper_->start();
}

VirtuoseDevice::~VirtuoseDevice() {
  if (!keeper_->stop()) static_cast<void>(keeper_.release());  // its thread hangs in the library and still uses it
}

void VirtuoseDevice::begin_service() noexcept {
  serving_ = true;
  armed_ = begun_ = false;
  refused_ticks_ = 0;
  unpowered_ns_ = 0;
  gripped_ = false;
  Pose older;
  keeper_->parked_pose(older);  // taken, so that it is not met again when the keeper has the arm next
}

DeviceReading VirtuoseDevice::parked() noexcept {
  serving_ = false;
  Pose X_WH;
  if (keeper_->parked_pose(X_WH)) {
    good_.X_WH = X_WH;
    set_point_ = {X_WH, {}};
  }
  DeviceReading reading;
  reading.X_WH = good_.X_WH;
  reading.faults = keeper_->parked_faults();
  return reading;
}

DeviceReading VirtuoseDevice::give_back(Why why, const News& news) noexcept {
  keeper_->tell(news);
  keeper_->give_back(why);
  DeviceReading reading = parked();
  if (why == Why::lost) reading.faults |= bit(Fault::device_lost);
  if (why == Why::refused) reading.faults |= bit(Fault::device_data);
  if (why == Why::emergency_stop) reading.faults |= bit(Fault::device_alarm);
  return reading;
}

DeviceReading VirtuoseDevice::read() noexcept {
  if (!keeper_->loop_owns()) return parked();
  if (!serving_) begin_service();
  if (keeper_->cut_requested()) {
    keeper_->give_back(Why::cut);
    return parked();
  }
  ArmState state;
  if (const Failure failure = keeper_->connection().read(state)) return give_back(Why::lost, {News::lost, failure, 0});
  if (!state.chain_closed) return give_back(Why::emergency_stop, {News::emergency_stop, {}, 0});
  const std::int64_t now = rt::monotonic_ns();
  watch_alarms(state.alarm, now);
  if (!state.dead_man) armed_ = true;
  if (power_is_due(state, now)) return give_back(Why::no_power, {News::no_power, {}, 0});

  DeviceReading reading;
  reading.engaged = armed_ && state.powered && state.dead_man && !state.indexing;
  if (state.alarm != 0) reading.faults |= bit(Fault::device_alarm);

  News why;
  if (refused(state, now, why)) {
    if (refused_ticks_ == 0) keeper_->tell(why);
    if (++refused_ticks_ >= kRefusedMax) {
      keeper_->give_back(Why::refused);
      reading = parked();
      reading.faults |= bit(Fault::device_data);
      return reading;
    }
    reading.X_WH = good_.X_WH;
    reading.trusted = false;
    reading.faults |= bit(Fault::device_data);
    return reading;
  }
  refused_ticks_ = 0;
  if (!begun_ || !good_.engaged || state.raw != raw_) {  // without a hand it may well stand still
    raw_ = state.raw;
    changed_ns_ = now;
    begun_ = true;
  }
  const double unchanged_s = static_cast<double>(now - changed_ns_) * 1e-9;
  if (reading.engaged && params_.stale_after_s > 0 && unchanged_s > params_.stale_after_s) {
    return give_back(Why::lost, {News::lost_silent, {}, unchanged_s});
  }
  reading.X_WH = state.X_WH();
  reading.X_WH.q.normalize();
  reading.V_WH = state.V_WH();
  reading.F_hand_W = state.F_hand_W();
  return good_ = reading;
}

/// Tells what changed, once a second at most: motors may saturate and recover in every contact.
void VirtuoseDevice::watch_alarms(unsigned alarm, std::int64_t now_ns) noexcept {
  if (alarm == alarm_ || now_ns - alarm_told_ns_ < kAlarmsApart_ns) return;
  if (const unsigned on = alarm & ~alarm_; on != 0) keeper_->tell({News::alarm_on, {}, static_cast<double>(on)});
  if (const unsigned off = alarm_ & ~alarm; off != 0) keeper_->tell({News::alarm_off, {}, static_cast<double>(off)});
  alarm_ = alarm;
  alarm_told_ns_ = now_ns;
}

bool VirtuoseDevice::refused(const ArmState& state, std::int64_t now_ns, News& why) const noexcept {
  if ((state.alarm & alarm_position) != 0) {
    why = {News::position_error, {}, 0};
    return true;
  }
  for (const float v : state.raw) {
    if (!std::isfinite(v)) {
      why = {News::not_finite, {}, 0};
      return true;
    }
  }
  const Pose X_WH = state.X_WH();
  if (const double norm = X_WH.q.norm(); std::abs(norm - 1) > 1e-3) {
    why = {News::not_a_rotation, {}, norm};
    return true;
  }
  if (!begun_ || !good_.engaged) return false;  // elsewhere after indexing is no jump
  // A late tick is no licence: what a hand does in kGap_s is all that is believed.
  const double dt = std::min(kGap_s, static_cast<double>(now_ns - changed_ns_) * 1e-9);
  const Vec6 step = displacement(good_.X_WH, X_WH);
  if (step.head<3>().norm() > kNoise_m + kSpeedMax_m_per_s * dt ||
      step.tail<3>().norm() > kNoise_rad + kSpeedMax_rad_per_s * dt) {
    why = {News::jump, {}, step.head<3>().norm()};
    return true;
  }
  return false;
}

/// Motors off in a hand that would have them on, for so long that asking again is due. Some arms have them off
/// whenever the dead-man is released; but where they go off in a grip, they shall not come back in it.
bool VirtuoseDevice::power_is_due(const ArmState& state, std::int64_t now_ns) noexcept {
  if (gripped_ && state.dead_man && !state.powered) armed_ = false;
  gripped_ = state.dead_man && state.powered;
  if (state.powered || !state.dead_man) {
    unpowered_ns_ = 0;
    return false;
  }
  if (unpowered_ns_ == 0) unpowered_ns_ = now_ns;
  return now_ns - unpowered_ns_ > kNoPowerPatience_ns;
}

void VirtuoseDevice::write(const Wrench& F_W) noexcept {
  if (!serving_ || !keeper_->loop_owns()) return;
  const bool cut = keeper_->cut_requested();
  const Failure failure = keeper_->connection().write(cut ? Wrench{} : F_W);
  if (cut) {
    keeper_->give_back(Why::cut);
  } else if (failure) {
    give_back(Why::lost, {News::lost, failure, 0});
  }
}

void VirtuoseDevice::write(const SetPoint& set_point) noexcept {
  set_point_ = set_point;
  if (!serving_ || !keeper_->loop_owns()) return;
  if (keeper_->cut_requested()) {
    keeper_->give_back(Why::cut);
  } else if (const Failure failure = keeper_->connection().write(set_point)) {
    give_back(Why::lost, {News::lost, failure, 0});
  }
}

}  // namespace tact::coupling::virtuose
