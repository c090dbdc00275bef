#pragma once
#include <array>
#include <atomic>

#include "coupling/device/device_events.hpp"
#include "coupling/device/simulated_arm.hpp"
#include "coupling/device/simulated_hand.hpp"

namespace tact::coupling {

/// A simulated arm held by a simulated hand: a product, not a test double. Everything runs in the calling thread, a few
/// microseconds a tick; write() integrates one period (simulated time counts executed ticks), in kSubsteps (4) or more,
/// never longer than 250 us. The same inputs give the same motion, bit for bit.
///
/// Pseudo-admittance: the driver's inner loop, a spring and damper from handle to set-point, runs at the substep rate;
/// the set-point moves on at its twist. Gains as a real driver chooses them: driver_spring(). The wrench it reports as
/// the hand's is that of this spring.
///
/// Encoders: the pose in steps of quantum_m and quantum_rad (of the rotation vector from the start); the twist then is
/// its difference over a period, smoothed over 2 ms. Sampling and transport: readings are delay_ticks old.
/// Events (device_events.hpp): by their times since haptics were first live.
class SimulatedDevice final : public HapticDevice {
 public:
  static constexpr int kSubsteps = 4;
  static constexpr int kDelayMax = 20;

  struct Params {
    DeviceMode mode = DeviceMode::pseudo_admittance;
    double rate_hz = 1000;
    SimulatedArm::Params arm;
    double virtual_mass_kg = 0.2, virtual_inertia_kg_m2 = 1e-4;  ///< of the handle body: for the inner gains
    SimulatedHand::Params hand;
    double quantum_m = 0, quantum_rad = 0;  ///< 0: exact
    int delay_ticks = 0;                    ///< 0 to kDelayMax
    std::vector<TimedEvent> events;
  };

  SimulatedDevice(const Params& params, HandMotion motion_WH, const Pose& X_WH);

  const DeviceCapabilities& capabilities() const noexcept override { return capabilities_; }
  rt::Tick wait_tick() noexcept override { return ticker_.wait(); }
  DeviceReading read() noexcept override;
  void write(const Wrench& F_W) noexcept override;
  void write(const SetPoint& set_point) noexcept override;
  SetPoint last_set_point() const noexcept override { return set_point_; }
  void cue(const HandCue& cue) noexcept override;
  void power_off() noexcept override { powered_.store(false, std::memory_order_relaxed); }

  /// What the hand really exerts, in either mode, and where the handle really is.
  Wrench true_hand_wrench_W() const noexcept { return hand_.wrench_W(arm_.X_WH(), arm_.V_WH()); }
  const Pose& true_X_WH() const noexcept { return arm_.X_WH(); }
  const Twist& true_V_WH() const noexcept { return arm_.V_WH(); }

 private:
  bool motors() const noexcept;      // on
  Wrench spring_W() const noexcept;  // of the driver, on the handle
  void advance() noexcept;
  void sense() noexcept;  // a new reading, at the end of a period
  Pose quantised(const Pose& X) const noexcept;
  Pose true_of(const Pose& X_reported) const noexcept {
    return {X_reported.p - p_offset_, X_reported.q * q_offset_.conjugate()};
  }

  Params params_;
  DeviceCapabilities capabilities_;
  rt::Ticker ticker_;
  SimulatedHand hand_;
  SimulatedArm arm_;
  HandCue cue_;
  Wrench command_W_;
  SetPoint set_point_, set_point_now_;
  Pose X_W_start_;
  Vec3 p_offset_ = Vec3::Zero();  // moved by indexing: p reported = p true + p_offset, q reported = q true * q_offset,
  Quat q_offset_ = Quat::Identity();  // so that twists and wrenches are the same in both
  Pose X_sensed_;                     // last, for the twist
  Twist V_sensed_;
  std::array<DeviceReading, kDelayMax + 1> readings_;  // a ring, newest at now_
  std::size_t now_ = 0;
  bool begun_ = false;  // haptics have been live
  double event_time_s_ = 0;
  std::uint32_t events_ = 0;  // now on
  std::atomic<bool> powered_{true};
};

}  // namespace tact::coupling
