#pragma once
#include "coupling/dynamics/wrench_model.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "coupling/safety/passivity_controller.hpp"
#include "rt/tick.hpp"

namespace tact::coupling {

/// Keeps the books of the device loop: everything in LoopStats, and the maxima of LoopStatus since the last one.
/// Called once a tick from the loop's thread; no allocation.
class LoopAccount {
 public:
  explicit LoopAccount(double rate_hz);

  /// A reply that arrived for this tick. `F_coupling_W` is the coupling wrench on the tool of the step that led to its
  /// pose, `force_max`, `torque_max` the saturation: they tell quasi-static balance.
  void reply(const ContactReply& reply, const Wrench& F_coupling_W, double force_max, double torque_max) noexcept;

  /// What the passivity observer and controller count.
  void port(const PassivityController& passivity) noexcept;

  /// Static coupling, not cut short by the motion limit: what is left of its equilibrium by its own model.
  void equilibrium(double residual_n) noexcept;

  /// The end of a tick.
  void tick(const rt::Tick& tick, std::int64_t end_ns, WrenchModel::Phase phase, std::uint32_t faults) noexcept;

  /// Where the loop fills in poses and wrenches before it is published.
  LoopStatus& status() noexcept { return status_; }
  /// Before publishing, from the loop's thread: one system call.
  void count_page_faults() noexcept;
  /// After publishing: forgets what counts since the previous status.
  void published() noexcept;

 private:
  LoopStatus status_;
  std::int64_t first_ns_ = 0;
  std::uint64_t first_page_faults_ = 0, first_allocations_ = 0;
  std::uint64_t replies_ = 0, contacts_ = 0, steps_ = 0;
  double step_squares_ = 0;
  bool any_reply_ = false;
  Vec3 last_force_ = Vec3::Zero();
};

}  // namespace tact::coupling
