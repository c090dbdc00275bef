#include "coupling/loop/flight_recorder.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "fault/fault.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

class FlightRecorderFiles : public ::testing::Test {
 protected:
  static RecordingInfo info(double rate_hz = 100) {
    RecordingInfo info;
    info.session = "recorder";
    info.config.rate_hz = rate_hz;
    return info;
  }
  static TickRecord tick_record(std::uint64_t index, std::uint32_t faults = 0) {
    TickRecord record;
    record.tick.index = index;
    record.faults = faults;
    return record;
  }
  static std::vector<std::uint64_t> ticks_in(const std::filesystem::path& file) {
    RecordingReader in(file);
    std::vector<std::uint64_t> ticks;
    for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
      if (entry == RecordingReader::Entry::tick) ticks.push_back(in.tick().tick.index);
    }
    return ticks;
  }

  const test::ScratchDir scratch_;
  const std::filesystem::path directory_ = scratch_.path();
};

TEST_F(FlightRecorderFiles, AFaultDumpsTwoSecondsBeforeItAndOneAfter) {
  FlightRecorder recorder(info(), directory_);
  std::filesystem::path file;
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    recorder.queue().ticks.push(tick_record(tick, tick >= 500 ? bit(Fault::wrench_stale) : 0));
    if (tick % 10 == 0) {
      const auto written = recorder.drain(bit(Fault::wrench_stale));
      if (!written.empty()) {
        EXPECT_TRUE(file.empty()) << "one fault, one file";
        file = written;
      }
    }
  }
  ASSERT_FALSE(file.empty());
  const auto ticks = ticks_in(file);
  EXPECT_LE(ticks.front(), 300u);
  EXPECT_GE(ticks.front(), 250u) << "memory is bounded";
  EXPECT_EQ(ticks.back(), 600u);
  EXPECT_EQ(ticks.size(), ticks.back() - ticks.front() + 1);
  EXPECT_EQ(RecordingReader(file).info().reason, "wrench_stale");
}

TEST_F(FlightRecorderFiles, SnapshotsStandBehindTheirTicks) {
  FlightRecorder recorder(info(), directory_);
  LoopSnapshot snapshot;
  snapshot.size = 100;
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    if (tick % 25 == 7) {
      snapshot.tick = tick;
      snapshot.bytes.fill(static_cast<std::byte>(tick));
      recorder.queue().snapshots.push(snapshot);
    }
    recorder.queue().ticks.push(tick_record(tick));
  }
  recorder.drain(0);
  RecordingReader in(recorder.dump("test"));
  std::uint64_t last = 0;
  int found = 0;
  for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
    if (entry == RecordingReader::Entry::tick) {
      last = in.tick().tick.index;
    } else {
      ++found;
      EXPECT_EQ(in.snapshot().tick, last);
      EXPECT_EQ(in.snapshot().size, 100u);
      EXPECT_EQ(in.snapshot().bytes[99], static_cast<std::byte>(last));
    }
  }
  EXPECT_EQ(found, 4);
}

TEST_F(FlightRecorderFiles, ARecordIsReadBackBitForBit) {
  TickRecord r = tick_record(41, 7);
  r.reading.X_WH = {{0.1, -0.2, 1.0 / 3}, Quat(0.5, 0.5, -0.5, 0.5)};
  r.reading.F_hand_W.torque = {1, 2, 1e-300};
  r.reading.trusted = false;
  r.has_reply = r.has_parameters = true;
  r.parameters.damping_ratio = 0.7;
  r.reply.pose_seq = 12;
  r.reply.G.setRandom();
  r.reply.clearance_m = 0.25;
  r.sent.V_W.angular = {-1, 0, 1};
  r.tool.X_W.p = {3, 2, 1};
  r.tick_ns = 123;
  FlightRecorder recorder(info(), directory_);
  recorder.queue().ticks.push(r);
  recorder.drain(0);
  RecordingReader in(recorder.dump("test"));
  ASSERT_EQ(in.next(), RecordingReader::Entry::tick);
  EXPECT_EQ(encode(in.tick()), encode(r));
  EXPECT_EQ(in.tick().reply.G, r.reply.G);
  EXPECT_EQ(in.tick().reply.K, Mat6::Zero());
  EXPECT_EQ(in.tick().reading.F_hand_W.torque, r.reading.F_hand_W.torque);
  EXPECT_EQ(in.tick().tick_ns, 123);
  EXPECT_FALSE(in.tick().reading.trusted);
  EXPECT_EQ(in.next(), RecordingReader::Entry::end);
}

TEST_F(FlightRecorderFiles, AWholeSessionIsReadableWhileItIsWritten) {
  FlightRecorder recorder(info(), directory_, directory_ / "session.tick");
  for (std::uint64_t tick = 0; tick < 1000; ++tick) {
    recorder.queue().ticks.push(tick_record(tick));
    if (tick % 10 == 9) recorder.drain(0);
  }
  const auto ticks = ticks_in(directory_ / "session.tick");
  EXPECT_EQ(ticks.size(), 1000u);
  EXPECT_TRUE(RecordingReader(directory_ / "session.tick").info().reason.empty());
}

TEST_F(FlightRecorderFiles, AFullDiskEndsTheRecordingOnceAndTheFlightGoesOn) {
  EXPECT_THROW(FlightRecorder(info(), directory_, "/dev/full"), SetupError);
  EXPECT_THROW(FlightRecorder(info(), directory_, directory_ / "no/such/folder"), SetupError);
}

TEST_F(FlightRecorderFiles, ARestartedCouplingWritesBesideTheRecordingOfItsSession) {
  RecordingInfo mine = info();
  mine.session_id = 7;
  const auto file = directory_ / "s.tick";
  EXPECT_EQ(free_recording_name({}, 7), "");
  EXPECT_EQ(free_recording_name(file, 7), file);
  { FlightRecorder recorder(mine, directory_, file); }
  EXPECT_EQ(free_recording_name(file, 8), file);
  EXPECT_EQ(free_recording_name(file, 7), directory_ / "s-2.tick");
  { FlightRecorder recorder(mine, directory_, directory_ / "s-2.tick"); }
  EXPECT_EQ(free_recording_name(file, 7), directory_ / "s-3.tick");
}

TEST_F(FlightRecorderFiles, FaultsThatAreNotAskedForAreNotDumped) {
  FlightRecorder recorder(info(), directory_);
  for (std::uint64_t tick = 1; tick <= 500; ++tick) {
    recorder.queue().ticks.push(tick_record(tick, tick % 50 == 0 ? bit(Fault::gate_limited) : 0));
    if (tick % 10 == 0) {
      EXPECT_TRUE(recorder.drain(bit(Fault::wrench_stale)).empty());
    }
  }
}

TEST_F(FlightRecorderFiles, AReaderThatStopsNeverStopsTheWriterAndWhatIsDroppedIsCounted) {
  FlightRecorder recorder(info(), directory_);
  std::uint64_t kept = 0;
  for (std::uint64_t tick = 0; tick < 100000; ++tick) kept += recorder.queue().ticks.push(tick_record(tick)) ? 1 : 0;
  EXPECT_EQ(recorder.dropped(), 100000 - kept);
  EXPECT_GE(kept, 200u) << "two seconds fit";
  EXPECT_LE(kept, 1000u) << "and not much more";
  EXPECT_TRUE(recorder.drain(0).empty());
}

}  // namespace
}  // namespace tact::coupling
