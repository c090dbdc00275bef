#include "coupling/loop/flight_recorder.hpp"

#include <cmath>

#include "fault/fault.hpp"
#include "file/whole_file.hpp"

namespace tact::coupling {

// A quarter of a second more than promised: a replay begins at a snapshot.
FlightRecorder::FlightRecorder(const RecordingInfo& info, std::filesystem::path directory,
                               const std::filesystem::path& session_file, int files_max)
    : info_(info),
      history_ticks_(
          static_cast<std::size_t>(std::ceil(info.config.rate_hz * (kHistory_s + TickQueue::kSnapshotPeriod_s)))),
      after_ticks_(static_cast<std::size_t>(std::ceil(info.config.rate_hz))),
      directory_(std::move(directory)),
      files_left_(files_max),
      queue_(info.config.rate_hz, kHistory_s) {
  info_.layout = state_layout();
  info_.reason.clear();
  if (!session_file.empty()) session_ = std::make_unique<RecordWriter>(session_file, kRecordingKind, encode(info_));
}

void FlightRecorder::keep(bool is_tick, std::vector<std::byte> bytes, std::string& failed) {
  if (session_) {
    try {
      session_->append(bytes);
    } catch (const SetupError& error) {
      failed = error.what();
      session_.reset();
    }
  }
  history_.push_back({is_tick, std::move(bytes)});
  ticks_ += is_tick ? 1 : 0;
  while (ticks_ > history_ticks_ + after_ticks_) {
    ticks_ -= history_.front().is_tick ? 1 : 0;
    history_.pop_front();
  }
}

std::filesystem::path FlightRecorder::drain(std::uint32_t dump_on) {
  std::filesystem::path written;
  std::string failed;
  while (queue_.ticks.pop(tick_)) {
    keep(true, encode(tick_), failed);
    has_snapshot_ = has_snapshot_ || queue_.snapshots.pop(snapshot_);
    while (has_snapshot_ && snapshot_.tick <= tick_.tick.index) {  // older: its tick was dropped
      if (snapshot_.tick == tick_.tick.index) keep(false, encode(snapshot_), failed);
      has_snapshot_ = queue_.snapshots.pop(snapshot_);
    }
    const std::uint32_t begun = tick_.faults & ~last_faults_ & dump_on;
    last_faults_ = tick_.faults;
    if (begun != 0 && dump_in_ == 0 && files_left_ > 0) {
      dump_in_ = after_ticks_;
      dump_faults_ = begun;
    } else if (dump_in_ > 0 && --dump_in_ == 0) {
      written = dump(fault_names(dump_faults_));
    }
  }
  if (session_) {
    try {
      session_->flush();
    } catch (const SetupError& error) {
      failed = error.what();
      session_.reset();
    }
  }
  if (!failed.empty()) throw SetupError(failed + " The recording ends here, the session goes on");
  return written;
}

std::filesystem::path FlightRecorder::finish(std::uint32_t dump_on) {
  const std::filesystem::path written = drain(dump_on);
  if (dump_in_ == 0) return written;
  dump_in_ = 0;
  return dump(fault_names(dump_faults_));
}

std::filesystem::path FlightRecorder::dump(const std::string& reason) {
  --files_left_;
  const auto path = directory_ / ("flight-" + std::to_string(++files_) + ".tick");
  const std::filesystem::path part = path.string() + ".part";  // whoever sees the file sees all of it
  RecordingInfo info = info_;
  info.reason = reason;
  {
    RecordWriter out(part, kRecordingKind, encode(info));
    for (const Entry& entry : history_) out.append(entry.bytes);
    out.flush();
  }
  std::error_code failed;
  std::filesystem::rename(part, path, failed);
  if (failed) throw SetupError(path.string() + ": flight record: cannot be written: " + failed.message());
  return path;
}

}  // namespace tact::coupling
