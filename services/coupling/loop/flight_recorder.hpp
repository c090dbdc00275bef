#pragma once
#include <cstdint>
#include <deque>
#include <filesystem>
#include <memory>
#include <string>

#include "coupling/loop/recording.hpp"

namespace tact::coupling {

/// The last seconds of ticks, always; and every tick of the session in a file, if asked for. The device loop pushes
/// into queue() (wait-free); another thread drains. When a fault begins, the history is written as a recording, with
/// what follows for a second. Memory is bounded: the queue holds two seconds, the history three; what a slow disk
/// leaves in a full queue is dropped there, counted, and a gap in the file.
class FlightRecorder {
 public:
  static constexpr double kHistory_s = 2;

  /// Files go to `directory` as flight-<n>.tick, at most `files_max` of them. `session_file`: the whole session goes
  /// there; empty: nowhere. Throws SetupError when that file cannot be made.
  FlightRecorder(const RecordingInfo& info, std::filesystem::path directory,
                 const std::filesystem::path& session_file = {}, int files_max = 20);

  /// For the device loop.
  TickQueue& queue() noexcept { return queue_; }

  /// Another thread, at least every kHistory_s: takes what was pushed. A fault bit among `dump_on` that was not set a
  /// tick before starts a dump; the file is written one second of ticks later. Returns the file written, or empty.
  /// Throws SetupError, once, when the session's file can no longer be written; the flight goes on.
  std::filesystem::path drain(std::uint32_t dump_on);

  /// At the end: as drain(), and writes a dump that still waits for its second of ticks.
  std::filesystem::path finish(std::uint32_t dump_on);

  /// Writes what there is now, whatever the faults. Throws SetupError when the file cannot be written.
  std::filesystem::path dump(const std::string& reason);

  /// Ticks that found the queue full.
  std::uint64_t dropped() const noexcept { return queue_.ticks.dropped(); }

 private:
  struct Entry {
    bool is_tick;
    std::vector<std::byte> bytes;
  };
  void keep(bool is_tick, std::vector<std::byte> bytes, std::string& failed);

  RecordingInfo info_;
  std::size_t history_ticks_, after_ticks_;
  std::filesystem::path directory_;
  int files_left_, files_ = 0;
  TickQueue queue_;
  std::unique_ptr<RecordWriter> session_;
  std::deque<Entry> history_;
  std::size_t ticks_ = 0;  // in history_
  TickRecord tick_;        // one at a time
  LoopSnapshot snapshot_;
  bool has_snapshot_ = false;
  std::uint32_t last_faults_ = 0;
  std::size_t dump_in_ = 0;  // ticks until the pending dump; 0: none pending
  std::uint32_t dump_faults_ = 0;
};

}  // namespace tact::coupling
