#include "coupling/device/simulated_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coupling/device/driver_spring.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kSubstepMax = 250e-6, kTwistSmoothing_s = 2e-3;
constexpr double kLie_m = 0.3, kLieNorm = 1.2;
constexpr std::uint32_t bits_of(std::initializer_list<DeviceEvent> events) {
  std::uint32_t bits = 0;
  for (const DeviceEvent e : events) bits |= 1u << static_cast<unsigned>(e);
  return bits;
}
constexpr std::uint32_t kMotorsOff = bits_of({DeviceEvent::dead_man, DeviceEvent::e_stop, DeviceEvent::power,
                                              DeviceEvent::indexing, DeviceEvent::alarm, DeviceEvent::lost});

SimulatedHand::Grip grip_of(std::uint32_t events, SimulatedHand::Grip usual) {
  if (on(events, DeviceEvent::grip_absent)) return SimulatedHand::Grip::absent;
  if (on(events, DeviceEvent::grip_soft)) return SimulatedHand::Grip::soft;
  if (on(events, DeviceEvent::grip_stiff)) return SimulatedHand::Grip::stiff;
  return usual;
}

Vec3 in_steps(const Vec3& v, double quantum) {
  return quantum > 0 ? Vec3(quantum * (v / quantum).array().round().matrix()) : v;
}

}  // namespace

SimulatedDevice::SimulatedDevice(const Params& params, HandMotion motion_WH, const Pose& X_WH)
    : params_(params),
      ticker_(static_cast<std::int64_t>(std::llround(1e9 / params.rate_hz))),
      hand_(params.hand, std::move(motion_WH), X_WH),
      arm_(params.arm, X_WH),
      set_point_{X_WH, {}},
      set_point_now_{X_WH, {}},
      X_W_start_(X_WH),
      X_sensed_(X_WH) {
  capabilities_.name = "simulated";
  capabilities_.mode = params.mode;
  capabilities_.force_peak_n = params.arm.force_peak_n;
  capabilities_.torque_peak_nm = params.arm.torque_peak_nm;
  if (params.mode == DeviceMode::pseudo_admittance) {
    const DriverSpring spring = driver_spring(params.rate_hz, params.virtual_mass_kg, params.virtual_inertia_kg_m2);
    capabilities_.spring_n_per_m = spring.n_per_m;
    capabilities_.spring_nm_per_rad = spring.nm_per_rad;
    capabilities_.damper_n_s_per_m = spring.n_s_per_m;
    capabilities_.damper_nm_s_per_rad = spring.nm_s_per_rad;
  }
  sense();
  readings_.fill(readings_[now_]);
}

void SimulatedDevice::cue(const HandCue& cue) noexcept {
  cue_ = cue;
  cue_.X_WH_target = true_of(cue.X_WH_target);
  begun_ = begun_ || cue.live;
}

bool SimulatedDevice::motors() const noexcept {
  return powered_.load(std::memory_order_relaxed) && (events_ & kMotorsOff) == 0;
}

DeviceReading SimulatedDevice::read() noexcept {
  const std::size_t size = readings_.size();
  DeviceReading reading = readings_[(now_ + size - static_cast<std::size_t>(params_.delay_ticks)) % size];
  reading.engaged = motors();
  if (arm_.hot() || on(events_, DeviceEvent::alarm)) reading.faults |= bit(Fault::device_alarm);
  if (on(events_, DeviceEvent::lost)) reading.faults |= bit(Fault::device_lost);
  if (on(events_, DeviceEvent::nan)) reading.X_WH.p.x() = std::numeric_limits<double>::quiet_NaN();
  if (on(events_, DeviceEvent::jump)) reading.X_WH.p.x() += kLie_m;
  if (on(events_, DeviceEvent::quaternion)) reading.X_WH.q.coeffs() *= kLieNorm;
  reading.script_time_s = hand_.script_time_s();
  reading.script_done = hand_.script_done();
  return reading;
}

void SimulatedDevice::write(const Wrench& F_W) noexcept {
  command_W_ = F_W;
  advance();
}

void SimulatedDevice::write(const SetPoint& set_point) noexcept {
  set_point_ = set_point;
  set_point_now_ = {true_of(set_point.X_W), set_point.V_W};
  advance();
}

Wrench SimulatedDevice::spring_W() const noexcept {
  if (!motors()) return {};
  const Pose& X_WH = arm_.X_WH();
  const Twist& V_WH = arm_.V_WH();
  const Vec6 x = displacement(X_WH, set_point_now_.X_W);
  return arm_.motor({capabilities_.spring_n_per_m * x.head<3>() +
                         capabilities_.damper_n_s_per_m * (set_point_now_.V_W.linear - V_WH.linear),
                     capabilities_.spring_nm_per_rad * x.tail<3>() +
                         capabilities_.damper_nm_s_per_rad * (set_point_now_.V_W.angular - V_WH.angular)});
}

void SimulatedDevice::advance() noexcept {
  const double period = 1 / params_.rate_hz;
  if (begun_ && !params_.events.empty()) {
    events_ = active_events(params_.events, event_time_s_);
    event_time_s_ += period;
    hand_.set_grip(grip_of(events_, params_.hand.grip));
    if (on(events_, DeviceEvent::overheat)) arm_.heat();
  }
  const int steps = std::max(kSubsteps, static_cast<int>(std::ceil(period / kSubstepMax)));
  const double dt = period / steps;
  for (int i = 0; i < steps; ++i) {
    hand_.advance(cue_, arm_.X_WH(), dt);
    const Wrench F_hand = hand_.wrench_W(arm_.X_WH(), arm_.V_WH());
    Wrench F_motor;
    if (params_.mode == DeviceMode::pseudo_admittance) {
      F_motor = spring_W();
    } else if (motors()) {
      F_motor = arm_.motor(command_W_);
    }
    arm_.advance(F_hand, F_motor, hand_.mass_kg(), hand_.inertia_kg_m2(), dt);
    set_point_now_.X_W = displaced(set_point_now_.X_W, dt * set_point_now_.V_W.vector());
  }
  sense();
}

Pose SimulatedDevice::quantised(const Pose& X) const noexcept {
  if (params_.quantum_m <= 0 && params_.quantum_rad <= 0) return X;
  const Vec6 x = displacement(X_W_start_, X);
  return displaced(
      X_W_start_,
      (Vec6() << in_steps(x.head<3>(), params_.quantum_m), in_steps(x.tail<3>(), params_.quantum_rad)).finished());
}

void SimulatedDevice::sense() noexcept {
  const DeviceReading& last = readings_[now_];
  DeviceReading next;
  if (on(events_, DeviceEvent::lost)) {
    next = last;
  } else if (on(events_, DeviceEvent::indexing)) {
    next.X_WH = last.X_WH;  // and the offset takes up the motion
    p_offset_ = last.X_WH.p - arm_.X_WH().p;
    q_offset_ = (arm_.X_WH().q.conjugate() * last.X_WH.q).normalized();
    X_sensed_ = quantised(arm_.X_WH());
  } else {
    const Pose X = quantised(arm_.X_WH());
    next.V_WH = arm_.V_WH();
    if (params_.quantum_m > 0 || params_.quantum_rad > 0) {
      const double part = std::min(1.0, 1 / (params_.rate_hz * kTwistSmoothing_s));
      const Vec6 V = V_sensed_.vector();
      next.V_WH = V_sensed_ = Twist::from(V + part * (params_.rate_hz * displacement(X_sensed_, X) - V));
      X_sensed_ = X;
    }
    next.X_WH = {X.p + p_offset_, X.q * q_offset_};
  }
  if (params_.mode == DeviceMode::pseudo_admittance) {
    const Wrench F = spring_W();
    next.F_hand_W = {-F.force, -F.torque};
  } else {
    next.F_hand_W = true_hand_wrench_W();
  }
  now_ = (now_ + 1) % readings_.size();
  readings_[now_] = next;
}

}  // namespace tact::coupling
