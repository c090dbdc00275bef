#pragma once
#include <memory>
#include <string>
#include <vector>

#include "coupling/loop/loop_config.hpp"
#include "coupling/loop/tick_record.hpp"
#include "file/record_file.hpp"

namespace tact::coupling {

/// What a recording says of itself: all that a replay needs besides the ticks.
struct RecordingInfo {
  std::string session, scene;
  std::uint64_t session_id = 0;
  std::uint64_t field_hash = 0, shell_hash = 0;
  std::string reason;  ///< of a flight record: the faults it was written for; empty: a whole session
  LoopConfig config;
  DeviceCapabilities device;
  // Before the first tick.
  DeviceReading first_reading;
  SetPoint first_set_point;
  std::uint64_t layout = 0;  ///< of LoopSnapshot: state_layout() of the writer
};

/// Of this build: snapshots of another one are not read.
std::uint64_t state_layout();

/// One format for flight records and whole sessions (common/file/record_file.hpp): the info, then ticks, and between
/// them a snapshot every quarter of a second. About 0.7 kB a tick in free space, 1.6 kB in contact.
/// Schema 1. Any change of what is written is a new schema.
inline constexpr SealedKind kRecordingKind{{'T', 'I', 'C', 'K'}, 1, "recording"};

std::vector<std::byte> encode(const RecordingInfo& info);
std::vector<std::byte> encode(const TickRecord& tick);
std::vector<std::byte> encode(const LoopSnapshot& snapshot);

/// `wanted`, or wanted-2, wanted-3, ... (before its extension) where that holds a recording of the same session: of a
/// coupling that was started again. Others are written over. Empty stays empty.
std::filesystem::path free_recording_name(const std::filesystem::path& wanted, std::uint64_t session_id);

/// Reads a recording from its beginning to its last whole record.
class RecordingReader {
 public:
  /// Throws SetupError when it is missing, foreign or of another schema, saying what to do.
  explicit RecordingReader(const std::filesystem::path& path);

  const RecordingInfo& info() const noexcept { return info_; }
  enum class Entry { end, tick, snapshot };
  /// Throws SetupError on a record that makes no sense (its checksum does).
  Entry next();
  /// Of the entry next() returned.
  const TickRecord& tick() const noexcept { return *tick_; }
  const LoopSnapshot& snapshot() const noexcept { return *snapshot_; }
  /// The writer was killed, or the file damaged: it ends with its last whole record.
  bool ended_early() const noexcept { return file_.ended_early(); }

 private:
  std::filesystem::path path_;
  RecordReader file_;
  RecordingInfo info_;
  std::vector<std::byte> record_;
  std::unique_ptr<TickRecord> tick_;
  std::unique_ptr<LoopSnapshot> snapshot_;
};

}  // namespace tact::coupling
