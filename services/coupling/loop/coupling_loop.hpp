#pragma once
#include <atomic>

#include "coupling/device/device.hpp"
#include "coupling/dynamics/motion_limit.hpp"
#include "coupling/dynamics/wrench_model.hpp"
#include "coupling/loop/coupling_strength.hpp"
#include "coupling/loop/flight_recorder.hpp"
#include "coupling/loop/loop_account.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "coupling/safety/gate.hpp"
#include "fault/fault.hpp"
#include "rt/periodic_thread.hpp"

namespace tact::coupling {

struct LoopConfig {
  double rate_hz = 1000;
  ToolIntegrator::Params tool;
  LoopParameters parameters;
  GateLimits gate;  ///< springs are the device's: taken from its capabilities
  Pose X_WT_start, X_WO, X_TM;
  double gyration_radius_m = 0.03;
  double tool_radius_m = 0.1;  ///< farthest point from To
  double voxel_m = 1e-3;
  double force_max_n = 10;  ///< F_max = k x_max until the first reply says otherwise
  double status_period_s = 0.016;
};

/// The device loop: reads the hand, steps the tool, publishes where it will be, and answers the hand, once a tick.
///
///   device --X_WH,V_WH,F_hand--> step --X_WT--> mail.tool -> contact server      nothing in here waits: the wrench of
///      ^                          |                              |               X_{n+1} is read at the start of the
///      +------- gate <------------+<--------- mail.reply <-------+               next tick
///
/// Calm, the state before the first reply and after a wrench went stale: the tool stands still, the device's wrench
/// goes to zero at the gate's slope, a set-point follows the handle at rest. It ends by itself with the next reply.
/// Real time: step() does not allocate, lock, log, throw or wait.
class CouplingLoop {
 public:
  /// All must outlive the loop. `recorder` may be null.
  CouplingLoop(const LoopConfig& config, HapticDevice& device, Mailboxes& mail, FlightRecorder* recorder);

  rt::Next step(const rt::Tick& tick) noexcept;

  /// From another thread: calm from the next tick on, for good. Give it a moment before the loop is stopped.
  void rest() noexcept { resting_.store(true, std::memory_order_relaxed); }
  /// After the last step, from the thread that ended the loop: writes the last status.
  const LoopStats& finish() noexcept {
    publish_status();
    return account_.status().stats;
  }

  /// Counts executed ticks: for the watchdog.
  const std::atomic<std::uint64_t>& progress() const noexcept { return progress_; }

 private:
  void take_parameters() noexcept;
  void take_hand_target() noexcept;
  DeviceReading read_device() noexcept;
  void take_reply() noexcept;
  void integrate(const DeviceReading& device) noexcept;
  void publish() noexcept;
  void send(const DeviceReading& device) noexcept;
  void close_tick(const rt::Tick& tick, const DeviceReading& device) noexcept;
  void publish_status() noexcept;
  bool calm() const noexcept;
  void raise(Fault fault) noexcept { faults_ |= bit(fault); }

  const LoopConfig config_;
  const double h_;  // period, s
  const DeviceMode mode_;
  HapticDevice& device_;
  Mailboxes& mail_;
  FlightRecorder* recorder_;

  ToolIntegrator tool_;
  WrenchModel wrench_;
  CouplingStrength strength_;
  MotionLimit motion_limit_;
  WrenchGate wrench_gate_;
  SetPointGate set_point_gate_;
  LoopAccount account_;

  HandCue cue_;
  DeviceReading good_;      // last sane reading
  ContactReply reply_;      // latest
  ContactLoad contact_;     // on the tool this tick
  double clearance_m_ = 0;  // of the latest reply
  Wrench F_sent_W_;         // impedance: to the device; otherwise of the coupling on the handle
  SetPoint sent_;
  Pose X_WH_last_;
  bool motion_cut_ = false, ramped_ = false;
  std::uint32_t faults_ = 0;  // this tick
  std::uint64_t seq_ = 0;
  std::uint64_t status_every_, status_in_;
  std::atomic<std::uint64_t> progress_{0};
  std::atomic<bool> resting_{false};
};

}  // namespace tact::coupling
