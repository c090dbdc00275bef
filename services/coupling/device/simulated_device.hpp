#pragma once
#include <atomic>

#include "coupling/device/simulated_hand.hpp"

namespace tact::coupling {

/// A simulated arm held by a simulated hand: a product, not a test double. Everything runs in the calling thread, a few
/// microseconds a tick; write() integrates one period (simulated time counts executed ticks).
///
/// Arm: mass and inertia at the handle, viscous friction, no gravity, peak force and torque.
///   M dV/dt = F_hand + F_device - friction V        arm and hand together, semi-implicit Euler
/// at kSubsteps (4) per period or more, never longer than 250 us.
///
/// Pseudo-admittance: the driver's inner loop, a spring and damper from handle to set-point, runs at the substep rate;
/// the set-point moves on at its twist. Gains as a real driver chooses them: driver_spring(). The wrench it reports as
/// the hand's is that of this spring.
class SimulatedDevice final : public HapticDevice {
 public:
  static constexpr int kSubsteps = 4;

  struct Params {
    DeviceMode mode = DeviceMode::pseudo_admittance;
    double rate_hz = 1000;
    double mass_kg = 0.8, inertia_kg_m2 = 0.003;  ///< of the arm at the handle
    double friction_n_s_per_m = 2, friction_nm_s_per_rad = 0.02;
    double force_peak_n = 35, torque_peak_nm = 3;
    double virtual_mass_kg = 0.2, virtual_inertia_kg_m2 = 1e-4;  ///< of the handle body: for the inner gains
    SimulatedHand::Params hand;
  };

  SimulatedDevice(const Params& params, HandMotion motion_WH, const Pose& X_WH);

  const DeviceCapabilities& capabilities() const noexcept override { return capabilities_; }
  rt::Tick wait_tick() noexcept override { return ticker_.wait(); }
  DeviceReading read() noexcept override;
  void write(const Wrench& F_W) noexcept override;
  void write(const SetPoint& set_point) noexcept override;
  SetPoint last_set_point() const noexcept override { return set_point_; }
  void cue(const HandCue& cue) noexcept override { cue_ = cue; }
  void power_off() noexcept override { powered_.store(false, std::memory_order_relaxed); }

  /// What the hand really exerts, in either mode.
  Wrench true_hand_wrench_W() const noexcept { return hand_.wrench_W(X_WH_, V_WH_); }

 private:
  Wrench spring_W() const noexcept;  // of the driver, on the handle
  void advance() noexcept;

  Params params_;
  DeviceCapabilities capabilities_;
  rt::Ticker ticker_;
  SimulatedHand hand_;
  HandCue cue_;
  Pose X_WH_;
  Twist V_WH_;
  Wrench command_W_;
  SetPoint set_point_, set_point_now_;
  std::atomic<bool> powered_{true};
};

}  // namespace tact::coupling
