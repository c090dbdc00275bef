// A recorded hand, played through the coupling once more.
#include <gtest/gtest.h>

#include <map>

#include "coupling/loop/flight_recorder.hpp"
#include "coupling/loop/recorded_hand.hpp"
#include "fault/fault.hpp"
#include "loop/rig.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

class Playback : public ::testing::TestWithParam<DeviceMode> {
 protected:
  Playback() {
    options_.mode = GetParam();
    options_.motion = {{0, 0.5, 1.5, 2},
                       {Pose{{0, 0, 0.01}, Quat::Identity()}, Pose{{0, 0, -0.02}, exp_so3({0.2, 0, 0})},
                        Pose{{0.03, 0, -0.02}, exp_so3({0, 0.3, 0})}, Pose{{0.03, 0, 0.03}, Quat::Identity()}}};
    options_.device = [](SimulatedDevice::Params& p) { p.hand.tremor_n = 0.3; };
  }

  /// Records a session with the wall answering `delay` ticks late; `before` ticks go by until the first answer.
  void record(int before, int delay = 0) {
    SimulatedDevice device(Rig::device_of(options_), options_.motion, Pose{options_.start, Quat::Identity()});
    RecordingInfo info;
    info.scene = "wall";
    info.field_hash = 3;
    info.shell_hash = 4;
    info.config = Rig::config_of(options_);
    info.device = device.capabilities();
    info.first_reading = device.read();
    info.first_set_point = device.last_set_point();
    FlightRecorder recorder(info, dir_.path(), file_);
    options_.records = &recorder.queue();
    options_.delay = delay;
    Rig rig(options_);
    for (int i = 0; i < before + 4000; ++i) {
      rig.wall.silent = i < before;
      rig.tick();
      recorder.drain(0);
    }
    ASSERT_TRUE(rig.status.script_done);
  }
  RecordingWanted wanted() const { return {file_, name(options_.mode), options_.rate_hz, 3, 4}; }

  /// Contact force by played tick, 0 up to the recorded one's last.
  std::map<long, Vec3> play(int before, int delay = 0) {
    DeviceOptions device_options;
    device_options.name = "playback";
    device_options.rate_hz = options_.rate_hz;
    LoopConfig config = Rig::config_of(options_);
    config.X_WT_start = use_recording(wanted(), device_options);
    const auto device = open_device(device_options);
    const auto mail = std::make_unique<Mailboxes>();
    TickQueue records(1000, 0.1);
    CouplingLoop loop(config, *device, *mail, &records);
    Rig like(options_);
    HalfSpace wall = like.wall;
    wall.delay = delay;
    std::map<long, Vec3> forces;
    TickRecord record;
    std::int64_t now = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      wall.silent = static_cast<int>(i) < before;
      now += 1'000'000;
      loop.step({i, now, now, 1'000'000, 0});
      wall.serve(*mail);
      EXPECT_TRUE(records.ticks.pop(record));
      forces[std::lround(record.reading.script_time_s * options_.rate_hz)] = record.F_contact_W.force;
      if (record.reading.script_done) break;
    }
    EXPECT_TRUE(record.reading.script_done);
    return forces;
  }
  std::map<long, Vec3> recorded() const {
    RecordingReader in(file_);
    std::map<long, Vec3> forces;
    for (auto entry = in.next(); entry != RecordingReader::Entry::end; entry = in.next()) {
      if (entry == RecordingReader::Entry::tick) {
        forces[static_cast<long>(in.tick().tick.index)] = in.tick().F_contact_W.force;
      }
    }
    return forces;
  }
  static double largest_difference(const std::map<long, Vec3>& a, const std::map<long, Vec3>& b) {
    double largest = 0, force = 0;
    for (const auto& [tick, f] : a) {
      force = std::max(force, f.norm());
      if (b.count(tick) != 0) largest = std::max(largest, (f - b.at(tick)).norm());
    }
    EXPECT_GT(force, 5) << "it was in contact";
    return largest;
  }

  const test::ScratchDir dir_;
  const std::filesystem::path file_ = dir_.path() / "session.tick";
  Rig::Options options_;
};
INSTANTIATE_TEST_SUITE_P(Modes, Playback, ::testing::Values(DeviceMode::impedance, DeviceMode::pseudo_admittance),
                         [](const auto& i) {
                           return i.param == DeviceMode::impedance ? "Impedance" : "PseudoAdmittance";
                         });

TEST_P(Playback, GivesTheSameWrenchBitForBitWhenRepliesComeAsTheyDid) {
  record(100);
  const auto was = recorded(), is = play(100);
  EXPECT_EQ(was.size(), is.size());
  EXPECT_EQ(largest_difference(was, is), 0);
}

TEST_P(Playback, WaitsForTheFirstReplyAndThenGivesTheSameWrench) {
  record(100);
  EXPECT_LT(largest_difference(recorded(), play(1500)), 1e-3);
  record(1500);
  EXPECT_LT(largest_difference(recorded(), play(30)), 1e-3);
}

TEST_P(Playback, LaterRepliesDoNotLeadItAway) {
  record(100);
  const auto was = recorded(), is = play(100, 3);
  EXPECT_LT(largest_difference(was, is), 2.0) << "while it moves, a late reply is a little off";
  // Two seconds after the motion ended both rest at the same place.
  EXPECT_LT((was.rbegin()->second - is.rbegin()->second).norm(), 1e-3);
}

TEST_P(Playback, AnotherSceneModeRateOrFileIsRefusedWithTheReason) {
  const auto error_of = [](const RecordingWanted& w) -> std::string {
    DeviceOptions options;
    try {
      use_recording(w, options);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "accepted";
  };
  const auto expect = [&](const RecordingWanted& w, const std::string& words) {
    EXPECT_NE(error_of(w).find(words), std::string::npos) << error_of(w);
    EXPECT_NE(error_of(w).find(w.file.string()), std::string::npos) << error_of(w);
  };
  expect(wanted(), "no such file");
  record(10);
  EXPECT_EQ(error_of(wanted()), "accepted");
  RecordingWanted other = wanted();
  other.shell_hash = 5;
  expect(other, "other bodies: scene wall");
  other = wanted();
  other.mode = other.mode == "impedance" ? "pseudo-admittance" : "impedance";
  expect(other, "set device.mode");
  other = wanted();
  other.rate_hz = 500;
  expect(other, "set device.rate_hz");
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) / 2);
  EXPECT_EQ(error_of(wanted()), "accepted") << "of a session that was killed, what there is";
  std::filesystem::resize_file(file_, 100);
  expect(wanted(), "not whole");
}

}  // namespace
}  // namespace tact::coupling
