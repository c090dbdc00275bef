#pragma once
#include <atomic>

#include "coupling/device/device.hpp"
#include "coupling/dynamics/motion_limit.hpp"
#include "coupling/dynamics/wrench_model.hpp"
#include "coupling/loop/coupling_strength.hpp"
#include "coupling/loop/loop_account.hpp"
#include "coupling/loop/loop_config.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "coupling/loop/tick_record.hpp"
#include "coupling/safety/gate.hpp"
#include "fault/fault.hpp"
#include "rt/periodic_thread.hpp"

namespace tact::coupling {

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
  /// All must outlive the loop. `records`, where each tick is told, may be null.
  CouplingLoop(const LoopConfig& config, HapticDevice& device, Mailboxes& mail, TickQueue* records);

  rt::Next step(const rt::Tick& tick) noexcept;

  /// From another thread: calm from the next tick on, for good. Give it a moment before the loop is stopped.
  void rest() noexcept { resting_.store(true, std::memory_order_relaxed); }
  /// After the last step, from the thread that ended the loop: writes the last status.
  const LoopStats& finish() noexcept {
    publish_status();
    return account_.status().stats;
  }

  /// What the next tick depends on besides what comes in then: of this build only (state_layout()).
  void save(LoopSnapshot& out) const noexcept;
  /// Goes on from there. False, and nothing changed, when it is no snapshot of this build.
  bool restore(const LoopSnapshot& snapshot) noexcept;

  /// Counts executed ticks: for the watchdog.
  const std::atomic<std::uint64_t>& progress() const noexcept { return progress_; }

 private:
  void take_parameters() noexcept;
  void take_hand_target() noexcept;
  DeviceReading read_device(const rt::Tick& tick) noexcept;
  void take_reply() noexcept;
  void integrate(const DeviceReading& device) noexcept;
  void publish() noexcept;
  void send(const DeviceReading& device) noexcept;
  void close_tick(const rt::Tick& tick, const DeviceReading& device) noexcept;
  void record(const rt::Tick& tick, std::int64_t end_ns, const DeviceReading& device) noexcept;
  void publish_status() noexcept;
  bool calm() const noexcept;
  /// Every member that outlives a tick and that the next one depends on.
  template <class Self, class F>
  static void each_state(Self& s, F f) noexcept {
    f(s.tool_), f(s.wrench_), f(s.strength_), f(s.wrench_gate_), f(s.set_point_gate_), f(s.good_), f(s.reply_);
    f(s.contact_), f(s.clearance_m_), f(s.F_sent_W_), f(s.sent_), f(s.X_WH_last_), f(s.ramped_), f(s.seq_),
        f(s.since_good_);
  }
  void raise(Fault fault) noexcept { faults_ |= bit(fault); }

  const LoopConfig config_;
  const double h_;  // period, s
  const DeviceMode mode_;
  HapticDevice& device_;
  Mailboxes& mail_;
  TickQueue* records_;

  ToolIntegrator tool_;
  WrenchModel wrench_;
  CouplingStrength strength_;
  MotionLimit motion_limit_;
  WrenchGate wrench_gate_;
  SetPointGate set_point_gate_;
  LoopAccount account_;

  HandCue cue_;
  DeviceReading good_;            // last sane reading
  std::uint64_t since_good_ = 0;  // grid points
  ContactReply reply_;            // latest
  ContactLoad contact_;           // on the tool this tick
  double clearance_m_ = 0;        // of the latest reply
  Wrench F_sent_W_;               // impedance: to the device; otherwise of the coupling on the handle
  SetPoint sent_;
  Pose X_WH_last_;
  bool motion_cut_ = false, ramped_ = false;
  std::uint32_t faults_ = 0;  // this tick
  std::uint64_t seq_ = 0;
  std::uint64_t status_every_, status_in_;
  TickRecord record_;      // of this tick, as far as it has come
  LoopSnapshot snapshot_;  // to push from
  std::uint64_t snapshot_every_, snapshot_in_ = 1;
  std::atomic<std::uint64_t> progress_{0};
  std::atomic<bool> resting_{false};
};

}  // namespace tact::coupling
