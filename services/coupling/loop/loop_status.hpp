#pragma once
#include <cstdint>

#include "math/pose.hpp"
#include "rt/histogram.hpp"

namespace tact::coupling {

/// Everything counted since the loop began: the wire's SessionStats in our own types.
struct LoopStats {
  double duration_s = 0;           ///< wall clock since the first tick
  double rate_hz = 0;              ///< of the grid
  std::uint64_t ticks = 0;         ///< executed
  std::uint64_t missed_ticks = 0;  ///< grid points skipped by an overrun
  std::uint64_t wrench_fresh = 0;  ///< ticks that began with a new reply; the wait for the first one counts nowhere
  std::uint64_t wrench_late = 0;   ///< ticks on an extrapolated wrench
  std::uint64_t wrench_stale = 0;  ///< ticks faded or calm
  rt::Histogram loop_jitter;       ///< wake-up after the grid point
  rt::Histogram tick;              ///< from wake-up to the end of the tick
  rt::Histogram round_trip;        ///< pose published to its reply received
  rt::Histogram contact_compute;   ///< of the server, each fresh reply
  double contacts_mean = 0;        ///< over fresh replies
  std::uint32_t contacts_max = 0;
  double penetration_max_m = 0;  ///< deepest shell point at any query
  /// The same, over ticks in quasi-static balance: the resultant of contact and coupling on the tool is under 10 % of
  /// F_max in force and of the torque cap in torque. Impacts and free flight are not in it.
  double penetration_quasi_static_max_m = 0;
  double force_max_n = 0, torque_max_nm = 0;          ///< contact wrench
  double pull_max_n = 0;                              ///< force of the virtual coupling on the tool while in contact
  double force_step_rms_n = 0, force_step_max_n = 0;  ///< contact force from one fresh reply to the next, in contact
  double net_stiffness_max_n_per_m = 0;               ///< largest eigenvalue of the translational block of K
  /// Energy that left through the device port, J; > 0: we were active. Impedance: integral of F_sent . V_H.
  /// Pseudo-admittance: minus the integral of F_hand . V_set-point.
  double port_energy_j = 0;
  std::uint64_t passivity_ticks = 0;  ///< the passivity controller was at work
  double passivity_dissipated_j = 0;  ///< by it
  double static_residual_max_n = 0;   ///< static coupling: left of F_contact + F_VC by its own model of the contact
  std::uint64_t static_unsolved_ticks = 0;  ///< with more left than stated
  std::uint32_t faults_ever = 0;            ///< tact::Fault bits
  std::uint64_t page_faults = 0;            ///< of the loop's thread since its first tick
  std::uint64_t allocations = 0;            ///< malloc family calls within ticks, where the hooks are linked
};

/// What the device loop tells the rest of the world, every few milliseconds: the wire's DeviceState in our own types.
struct LoopStatus {
  std::uint64_t tick = 0;
  std::int64_t t_mono_ns = 0;
  Pose X_WH, X_WT, X_WM;  ///< handle, tool, mesh frame of the tool
  Twist V_WH, V_WT;
  Wrench F_contact_W, F_coupling_W;  ///< on the tool, about To
  Wrench F_hand_W;                   ///< of the hand on the handle, where the device knows it
  std::uint32_t contact_count = 0;
  double net_stiffness_n_per_m = 0;
  std::int64_t round_trip_ns = 0;  ///< latest
  double script_time_s = -1;       ///< < 0: no script
  bool script_done = false;
  bool engaged = false;                  ///< device powered, dead-man held, past its ramp
  bool capped = false;                   ///< motion limit or saturation active
  std::uint64_t parameters_version = 0;  ///< LoopParameters in force
  // Since the previous status:
  double max_depth_m = 0, force_max_n = 0;
  std::int64_t tick_ns_max = 0;
  std::uint32_t faults = 0;  ///< tact::Fault bits set in any tick since
  LoopStats stats;
};

}  // namespace tact::coupling
