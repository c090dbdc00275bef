#include "record/replay.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "coupling/loop/flight_recorder.hpp"
#include "fault/fault.hpp"
#include "loop/rig.hpp"
#include "record/plot.hpp"
#include "support/process.hpp"

namespace tact::record {
namespace {

using namespace coupling;

/// A session pressed on a wall on a fake clock, recorded as coupling does it.
class Recorded : public ::testing::TestWithParam<DeviceMode> {
 protected:
  Recorded() {
    options_.mode = GetParam();
    options_.motion = straight({0, 0, 0.01}, {0.02, 0, -0.05}, 0.5);
    options_.device = [](SimulatedDevice::Params& p) {
      p.hand.tremor_n = 0.5;
      p.quantum_m = 1e-5;
    };
  }

  RecordingInfo info() const {
    SimulatedDevice device(Rig::device_of(options_), options_.motion, Pose{options_.start, Quat::Identity()});
    RecordingInfo info;
    info.session = "replay-test";
    info.config = Rig::config_of(options_);
    info.device = device.capabilities();
    info.first_reading = device.read();
    info.first_set_point = device.last_set_point();
    return info;
  }

  /// `with`: once a tick, may change things. Drained every 100 ticks.
  void play(FlightRecorder& recorder, int ticks, const std::function<void(Rig&, int)>& with = {}) {
    options_.records = &recorder.queue();
    Rig rig(options_);
    for (int i = 0; i < ticks; ++i) {
      if (with) with(rig, i);
      rig.tick();
      if (i % 100 == 99) recorder.drain(bit(Fault::wrench_stale));
    }
    recorder.drain(0);
  }
  std::string content() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  const test::ScratchDir dir_;
  const std::filesystem::path file_ = dir_.path() / "session.tick";
  Rig::Options options_;
};
INSTANTIATE_TEST_SUITE_P(Modes, Recorded, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                         [](const auto& i) {
                           return i.param == DeviceMode::impedance ? "Impedance" : "PseudoAdmittance";
                         });

TEST_P(Recorded, AWholeSessionReplaysBitForBit) {
  {
    FlightRecorder recorder(info(), dir_.path(), file_);
    play(recorder, 3000, [](Rig& rig, int i) {
      rig.wall.silent = i > 1500 && i < 1540;  // late, faded, calm, and back
      if (i == 1200) rig.wall.epoch = 2;
      if (i == 1700 || i == 2200) {
        LoopParameters parameters;
        parameters.version = static_cast<std::uint64_t>(i);
        parameters.saturation = i != 1700;
        parameters.stiffness_n_per_m = i == 1700 ? 1500 : 3000;
        rig.mail->parameters.write(parameters);
      }
      if (i == 2900) rig.loop.rest();
    });
  }
  const ReplayResult result = replay(file_, {0, 0, 0, 0});
  EXPECT_TRUE(result.same()) << result.first->tick << ' ' << result.first->what;
  EXPECT_EQ(result.ticks, 3000u);
  EXPECT_TRUE(result.from_start);
  EXPECT_EQ(result.gaps + result.unreplayed, 0u);
  EXPECT_EQ(result.session, "replay-test");
}

TEST_P(Recorded, AFlightReplaysBitForBitFromItsFirstSnapshot) {
  std::filesystem::path flight;
  FlightRecorder recorder(info(), dir_.path());
  play(recorder, 6000, [&](Rig& rig, int i) { rig.wall.silent = i > 4500 && i < 4600; });
  flight = dir_.path() / "flight-1.tick";
  ASSERT_TRUE(std::filesystem::exists(flight));
  const ReplayResult result = replay(flight, {0, 0, 0, 0});
  EXPECT_TRUE(result.same()) << result.first->tick << ' ' << result.first->what;
  EXPECT_FALSE(result.from_start);
  EXPECT_EQ(result.reason, "wrench_stale");
  EXPECT_LE(result.unreplayed, 250u) << "a snapshot every quarter of a second";
  EXPECT_GE(result.ticks, 3000u) << "two seconds before the fault and one after";
}

TEST_P(Recorded, OtherInputIsFoundAtItsTickWithItsSize) {
  // One reply's force is a newton more than what the loop had used.
  const std::uint64_t altered = 2000;
  {
    FlightRecorder recorder(info(), dir_.path(), file_);
    play(recorder, 2500);
  }
  const auto other = dir_.path() / "other.tick";
  {
    RecordingReader in(file_);
    RecordWriter out(other, kRecordingKind, encode(in.info()));
    for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
      if (entry == RecordingReader::Entry::snapshot) continue;
      TickRecord tick = in.tick();
      if (tick.tick.index == altered) {
        ASSERT_TRUE(tick.has_reply);
        tick.reply.F_W.force.z() += 1;
      }
      out.append(encode(tick));
    }
  }
  const ReplayResult result = replay(other);
  ASSERT_TRUE(result.first.has_value());
  EXPECT_EQ(result.first->tick, altered);
  EXPECT_NE(result.first->what.find("contact force: 1 N apart"), std::string::npos) << result.first->what;
  EXPECT_NEAR(result.quantities[0].largest, 1, 0.5);
}

TEST_P(Recorded, AGapIsReportedAndReplayGoesOnAtTheNextSnapshot) {
  {
    FlightRecorder recorder(info(), dir_.path(), file_);
    play(recorder, 2000);
  }
  const auto other = dir_.path() / "other.tick";
  {
    RecordingReader in(file_);
    RecordWriter out(other, kRecordingKind, encode(in.info()));
    for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
      if (entry == RecordingReader::Entry::snapshot) {
        out.append(encode(in.snapshot()));
      } else if (in.tick().tick.index < 900 || in.tick().tick.index > 950) {
        out.append(encode(in.tick()));
      }
    }
  }
  const ReplayResult result = replay(other, {0, 0, 0, 0});
  EXPECT_TRUE(result.same()) << result.first->tick << ' ' << result.first->what;
  EXPECT_EQ(result.gaps, 1u);
  EXPECT_GT(result.unreplayed, 0u);
  EXPECT_LE(result.unreplayed, 250u);
  EXPECT_EQ(result.ticks + result.unreplayed, 2000u - 51);
}

TEST_P(Recorded, AFileCutOffReplaysUpToItsLastWholeTick) {
  {
    FlightRecorder recorder(info(), dir_.path(), file_);
    play(recorder, 1000);
  }
  const std::string whole = content();
  std::ofstream(file_, std::ios::binary) << whole.substr(0, whole.size() / 2 + 3);
  const ReplayResult result = replay(file_, {0, 0, 0, 0});
  EXPECT_TRUE(result.same());
  EXPECT_TRUE(result.ended_early);
  EXPECT_GT(result.ticks, 300u);
  EXPECT_LT(result.ticks, 700u);
}

TEST_P(Recorded, WhatIsNoRecordingIsRefused) {
  EXPECT_THROW(replay(file_), SetupError);
  std::ofstream(file_) << "time_s,x_m\n0,1\n and so on\n";
  EXPECT_THROW(replay(file_), SetupError);
  { FlightRecorder recorder(info(), dir_.path(), file_); }
  EXPECT_THROW(replay(file_), SetupError) << "no tick in it";
}

TEST_P(Recorded, IsDrawnAndWrittenAsCsv) {
  {
    FlightRecorder recorder(info(), dir_.path(), file_);
    play(recorder, 1500);
  }
  plot(file_, dir_.path() / "plot.png");
  EXPECT_GT(std::filesystem::file_size(dir_.path() / "plot.png"), 10000u);
  write_csv(file_, dir_.path() / "ticks.csv");
  std::ifstream csv(dir_.path() / "ticks.csv");
  std::string line;
  std::getline(csv, line);
  const auto columns = std::count(line.begin(), line.end(), ',');
  int rows = 0;
  for (; std::getline(csv, line); ++rows) ASSERT_EQ(std::count(line.begin(), line.end(), ','), columns);
  EXPECT_EQ(rows, 1500);
}

}  // namespace
}  // namespace tact::record
