#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "coupling/device/device.hpp"
#include "coupling/loop/mailboxes.hpp"
#include "rt/spsc_ring.hpp"
#include "rt/tick.hpp"

namespace tact::coupling {

/// One executed tick, as the device loop saw it: everything that came in, and what it made of it. With the state
/// before it, what came in decides what went out.
struct TickRecord {
  // In.
  rt::Tick tick;
  DeviceReading reading;                           ///< as the device gave it, sane or not
  bool resting = false;                            ///< rest() had been called
  bool has_parameters = false, has_reply = false;  ///< taken from the mailboxes this tick
  LoopParameters parameters;
  ContactReply reply;

  // Out.
  std::uint64_t pose_seq = 0;          ///< published this tick
  std::uint64_t reply_seq = 0;         ///< pose the wrench in use was computed at; 0: none yet
  std::uint32_t wrench_age_ticks = 0;  ///< executed ticks since that wrench arrived: 0 on the tick that first used it
  std::uint32_t faults = 0;            ///< tact::Fault bits set in this tick
  std::uint32_t contact_count = 0;
  bool live = false;  ///< the hand was told that haptics are on
  Pose X_WH;          ///< handle, as believed
  BodyState tool;
  Wrench F_contact_W;   ///< on the tool, after extrapolation or fade
  Wrench F_coupling_W;  ///< on the tool
  Wrench F_sent_W;      ///< impedance: wrench sent to the device; pseudo-admittance: of the coupling
  SetPoint sent;        ///< pseudo-admittance, as the device got it: in its own frame, as `reading` is
  double max_depth_m = 0;
  std::int64_t tick_ns = 0;  ///< time the tick took
};

/// The memory of the device loop after a tick, byte for byte: where a replay may begin. Of one build only.
struct LoopSnapshot {
  static constexpr std::size_t kCapacity = 8192;
  std::uint64_t tick = 0;  ///< index of the tick just executed
  std::uint32_t size = 0;
  std::array<std::byte, kCapacity> bytes;
};

/// From the device loop to whoever keeps its records: wait-free; when nobody takes them, they are dropped and counted.
/// A snapshot is pushed before the tick it follows.
struct TickQueue {
  static constexpr double kSnapshotPeriod_s = 0.25;

  /// Room for `seconds` of ticks.
  TickQueue(double rate_hz, double seconds)
      : ticks(static_cast<std::size_t>(rate_hz * seconds) + 1),
        snapshots(static_cast<std::size_t>(seconds / kSnapshotPeriod_s) + 2) {}

  rt::SpscRing<TickRecord> ticks;
  rt::SpscRing<LoopSnapshot> snapshots;
};

}  // namespace tact::coupling
