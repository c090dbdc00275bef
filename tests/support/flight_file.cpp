#include "support/flight_file.hpp"

#include "coupling/loop/recording.hpp"

namespace tact::test {

std::vector<FlightTick> read_flight(const std::filesystem::path& file) {
  using coupling::RecordingReader;
  RecordingReader in(file);
  std::vector<FlightTick> ticks;
  for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
    if (entry != RecordingReader::Entry::tick) continue;
    const coupling::TickRecord& t = in.tick();
    ticks.push_back({t.tick.index, t.pose_seq, t.reply_seq, t.wrench_age_ticks, t.faults, t.contact_count,
                     t.F_contact_W, t.F_sent_W, t.X_WH, t.reading.X_WH, t.sent.X_W, t.tick.skipped});
  }
  return ticks;
}

}  // namespace tact::test
