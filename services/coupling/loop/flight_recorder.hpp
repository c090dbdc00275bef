#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <string>

#include "math/pose.hpp"
#include "rt/spsc_ring.hpp"

namespace tact::coupling {

/// One executed tick, as the device loop saw it.
struct TickRecord {
  std::uint64_t tick = 0;
  std::int64_t t_mono_ns = 0;
  std::uint64_t pose_seq = 0;          ///< published this tick
  std::uint64_t reply_seq = 0;         ///< pose the wrench in use was computed at; 0: none yet
  std::uint32_t wrench_age_ticks = 0;  ///< executed ticks since that wrench arrived: 0 on the tick that first used it
  std::uint32_t faults = 0;            ///< tact::Fault bits set in this tick
  std::uint32_t contact_count = 0;
  Pose X_WH, X_WT;
  Wrench F_contact_W;  ///< on the tool, after extrapolation or fade
  Wrench F_sent_W;     ///< impedance: wrench sent to the device; pseudo-admittance: of the coupling
  Pose X_sent;         ///< pseudo-admittance: set-point sent
  Twist V_sent;        ///< pseudo-admittance: its twist
  double max_depth_m = 0;
  std::int64_t tick_ns = 0;  ///< time the tick took
};

/// The last seconds of ticks, always. The device loop pushes (wait-free); another thread drains, and writes the history
/// to a CSV file when a fault begins, with what follows it for a second.
class FlightRecorder {
 public:
  /// Keeps `history_s` seconds at `rate_hz`. Files go to `directory` as flight-<n>.csv, at most `files_max` of them.
  FlightRecorder(double rate_hz, double history_s, std::filesystem::path directory, int files_max = 20);

  /// Device loop: real time, does not allocate, never waits.
  void push(const TickRecord& record) noexcept { ring_.push(record); }

  /// Another thread, at least every `history_s`: takes what was pushed. A fault bit among `dump_on` that was not set a
  /// tick before starts a dump; the file is written one second of ticks later. Returns the file written, or empty.
  std::filesystem::path drain(std::uint32_t dump_on);

  /// At the end: as drain(), and writes a dump that still waits for its second of ticks.
  std::filesystem::path finish(std::uint32_t dump_on);

  /// Writes what there is now, whatever the faults. Throws SetupError when the file cannot be written.
  std::filesystem::path dump(const std::string& reason);

 private:
  std::size_t history_ticks_, after_ticks_;
  std::filesystem::path directory_;
  int files_left_, files_ = 0;
  rt::SpscRing<TickRecord> ring_;
  std::deque<TickRecord> history_;
  std::uint32_t last_faults_ = 0;
  std::size_t dump_in_ = 0;  // ticks until the pending dump; 0: none pending
  std::uint32_t dump_faults_ = 0;
};

}  // namespace tact::coupling
