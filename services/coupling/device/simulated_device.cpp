#include "coupling/device/simulated_device.hpp"

#include <algorithm>
#include <cmath>

#include "coupling/device/driver_spring.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kSubstepMax = 250e-6;

Vec3 at_most(const Vec3& v, double m) {
  const double norm = v.norm();
  return norm > m ? Vec3(v * (m / norm)) : v;
}

}  // namespace

SimulatedDevice::SimulatedDevice(const Params& params, HandMotion motion_WH, const Pose& X_WH)
    : params_(params),
      ticker_(static_cast<std::int64_t>(std::llround(1e9 / params.rate_hz))),
      hand_(params.hand, std::move(motion_WH), X_WH),
      X_WH_(X_WH),
      set_point_{X_WH, {}},
      set_point_now_{X_WH, {}} {
  capabilities_.name = "simulated";
  capabilities_.mode = params.mode;
  capabilities_.force_peak_n = params.force_peak_n;
  capabilities_.torque_peak_nm = params.torque_peak_nm;
  if (params.mode == DeviceMode::pseudo_admittance) {
    const DriverSpring spring = driver_spring(params.rate_hz, params.virtual_mass_kg, params.virtual_inertia_kg_m2);
    capabilities_.spring_n_per_m = spring.n_per_m;
    capabilities_.spring_nm_per_rad = spring.nm_per_rad;
    capabilities_.damper_n_s_per_m = spring.n_s_per_m;
    capabilities_.damper_nm_s_per_rad = spring.nm_s_per_rad;
  }
}

DeviceReading SimulatedDevice::read() noexcept {
  DeviceReading reading;
  reading.X_WH = X_WH_;
  reading.V_WH = V_WH_;
  reading.engaged = powered_.load(std::memory_order_relaxed);
  if (params_.mode == DeviceMode::pseudo_admittance) {
    const Wrench F = spring_W();
    reading.F_hand_W = {-F.force, -F.torque};
  } else {
    reading.F_hand_W = true_hand_wrench_W();
  }
  reading.script_time_s = hand_.script_time_s();
  reading.script_done = hand_.script_done();
  return reading;
}

void SimulatedDevice::write(const Wrench& F_W) noexcept {
  command_W_ = {at_most(F_W.force, params_.force_peak_n), at_most(F_W.torque, params_.torque_peak_nm)};
  advance();
}

void SimulatedDevice::write(const SetPoint& set_point) noexcept {
  set_point_ = set_point_now_ = set_point;
  advance();
}

Wrench SimulatedDevice::spring_W() const noexcept {
  if (!powered_.load(std::memory_order_relaxed)) return {};
  const Vec6 x = displacement(X_WH_, set_point_now_.X_W);
  const Vec3 force = capabilities_.spring_n_per_m * x.head<3>() +
                     capabilities_.damper_n_s_per_m * (set_point_now_.V_W.linear - V_WH_.linear);
  const Vec3 torque = capabilities_.spring_nm_per_rad * x.tail<3>() +
                      capabilities_.damper_nm_s_per_rad * (set_point_now_.V_W.angular - V_WH_.angular);
  return {at_most(force, params_.force_peak_n), at_most(torque, params_.torque_peak_nm)};
}

void SimulatedDevice::advance() noexcept {
  const double period = 1 / params_.rate_hz;
  const int steps = std::max(kSubsteps, static_cast<int>(std::ceil(period / kSubstepMax)));
  const double dt = period / steps;
  const double mass = params_.mass_kg + params_.hand.mass_kg;
  const double inertia = params_.inertia_kg_m2 + params_.hand.inertia_kg_m2;
  const bool powered = powered_.load(std::memory_order_relaxed);
  for (int i = 0; i < steps; ++i) {
    hand_.advance(cue_, X_WH_, dt);
    const Wrench F_hand = hand_.wrench_W(X_WH_, V_WH_);
    Wrench F_device;
    if (params_.mode == DeviceMode::pseudo_admittance) {
      F_device = spring_W();
    } else if (powered) {
      F_device = command_W_;
    }
    V_WH_.linear += dt / mass * (F_hand.force + F_device.force - params_.friction_n_s_per_m * V_WH_.linear);
    V_WH_.angular += dt / inertia * (F_hand.torque + F_device.torque - params_.friction_nm_s_per_rad * V_WH_.angular);
    X_WH_ = displaced(X_WH_, dt * V_WH_.vector());
    set_point_now_.X_W = displaced(set_point_now_.X_W, dt * set_point_now_.V_W.vector());
  }
}

}  // namespace tact::coupling
