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
#include "coupling/loop/workspace_mapping.hpp"
#include "coupling/safety/gate.hpp"
#include "coupling/safety/passivity_controller.hpp"
#include "fault/fault.hpp"
#include "rt/periodic_thread.hpp"

namespace tact::coupling {

/// The device loop: reads the hand, steps the tool, publishes where it will be, and answers the hand, once a tick.
///
///   device --X_WH,V_WH,F_hand--> step --X_WT--> mail.tool -> contact server      nothing in here waits: the wrench of
///      ^                          |                              |               X_{n+1} is read at the start of the
///      +------- gate <------------+<--------- mail.reply <-------+               next tick
///
/// Only direct coupling in impedance waits, since there X_{n+1} is the handle's pose now: for the wrench it will send.
/// In front of the device everything is mapped from W to the device's own frame, where gate and passivity count.
///
/// Calm, the state before the first reply and after a wrench went stale: the tool stands still, the device's wrench
/// goes to zero at the gate's slope, a set-point follows the handle at rest. It ends by itself with the next reply.
/// Another coupling or integrator may be chosen at any tick: poses and twists go on as they are, the wrench that is
/// sent comes over within kBlend_s. Real time: step() does not allocate, lock, log or throw, and waits only as said.
class CouplingLoop {
 public:
  static constexpr double kBlend_s = 0.1;  ///< time constant

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
  bool newest_reply(ContactReply& reply) noexcept;
  void integrate(const DeviceReading& device) noexcept;
  void publish() noexcept;
  Wrench blended(const Wrench& F_W) noexcept;
  void send(const DeviceReading& device) noexcept;
  void close_tick(const rt::Tick& tick, const DeviceReading& device) noexcept;
  void record(const rt::Tick& tick, std::int64_t end_ns, const DeviceReading& device) noexcept;
  void publish_status() noexcept;
  bool calm() const noexcept;
  /// The tool is where the handle is now, and its wrench is needed in this tick.
  bool direct_now() const noexcept { return mode_ == DeviceMode::impedance && kind_ == CouplingKind::direct; }
  /// Every member that outlives a tick and that the next one depends on.
  template <class Self, class F>
  static void each_state(Self& s, F f) noexcept {
    f(s.tool_), f(s.wrench_), f(s.strength_), f(s.mapping_), f(s.wrench_gate_), f(s.set_point_gate_), f(s.passivity_);
    f(s.kind_), f(s.integrator_), f(s.good_B_), f(s.reply_), f(s.contact_), f(s.clearance_m_), f(s.F_sent_W_);
    f(s.F_sent_B_), f(s.sent_B_), f(s.X_BH_last_), f(s.bump_), f(s.F_wanted_W_), f(s.ramped_), f(s.seq_);
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
  WorkspaceMapping mapping_;
  WrenchGate wrench_gate_;
  SetPointGate set_point_gate_;
  PassivityController passivity_;
  LoopAccount account_;

  CouplingKind kind_;
  Integrator integrator_;
  HandCue cue_;
  DeviceReading good_B_;          // last sane reading, as the device gave it
  std::uint64_t since_good_ = 0;  // grid points
  DeviceReading hand_;            // in W
  ContactReply reply_;            // latest
  ContactLoad contact_;           // on the tool this tick
  double clearance_m_ = 0;        // of the latest reply
  Wrench F_sent_W_;               // impedance: to the device; otherwise of the coupling on the handle
  Wrench F_sent_B_;               // impedance: the same, as the device got it
  SetPoint sent_B_;
  Pose X_BH_last_;
  Vec6 bump_ = Vec6::Zero();  // impedance: what a switch of the coupling would have made the wrench jump by, decaying
  Wrench F_wanted_W_;         // impedance: last, before the gate
  bool switched_ = false;
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
