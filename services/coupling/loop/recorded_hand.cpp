#include "coupling/loop/recorded_hand.hpp"

#include <cmath>
#include <sstream>

#include "coupling/loop/recording.hpp"
#include "fault/fault.hpp"

namespace tact::coupling {

Pose use_recording(const RecordingWanted& wanted, DeviceOptions& options) {
  RecordingReader reader(wanted.file);
  const RecordingInfo& info = reader.info();
  const auto refuse = [&](const auto& found, const auto& expected) {
    std::ostringstream text;
    text << wanted.file.string() << ": device.recording: found " << found << ", expected " << expected;
    throw SetupError(text.str());
  };
  const auto identity = [](std::uint64_t field, std::uint64_t shell) { return hex(field) + "/" + hex(shell); };
  if ((wanted.field_hash != 0 && info.field_hash != wanted.field_hash) ||
      (wanted.shell_hash != 0 && info.shell_hash != wanted.shell_hash)) {
    refuse("a recording of other bodies: scene " + info.scene + ", field/pointshell " +
               identity(info.field_hash, info.shell_hash),
           identity(wanted.field_hash, wanted.shell_hash) + ", those of this session: run the scene that was recorded");
  }
  if (const std::string mode = name(info.device.mode); mode != wanted.mode) {
    refuse("a recording in mode " + mode, "the mode of this session, " + wanted.mode + ": set device.mode");
  }
  if (info.config.rate_hz != wanted.rate_hz) {
    std::ostringstream rate;
    rate << "the rate of this session, " << wanted.rate_hz << " Hz: set device.rate_hz";
    refuse("a recording at " + std::to_string(std::lround(info.config.rate_hz)) + " Hz", rate.str());
  }
  options.recorded = info.device;
  options.playback.clear();
  SetPoint before = info.first_set_point;
  std::uint64_t next = 0;
  for (auto entry = reader.next(); entry != RecordingReader::Entry::end; entry = reader.next()) {
    if (entry != RecordingReader::Entry::tick) continue;
    const TickRecord& tick = reader.tick();
    if (tick.tick.index != next) {
      refuse(next == 0 ? "a flight record: it begins in mid-session"
                       : "ticks missing after tick " + std::to_string(next - 1),
             "a whole session (tact run --record)");
    }
    ++next;
    options.playback.push_back({tick.reading, before, tick.live});
    before = tick.sent;
  }
  if (options.playback.empty()) refuse("no tick", "a session that ran");
  return info.config.X_WT_start;
}

}  // namespace tact::coupling
