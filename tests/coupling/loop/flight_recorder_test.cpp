#include "coupling/loop/flight_recorder.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>

#include "fault/fault.hpp"

namespace tact::coupling {
namespace {

class FlightRecorderFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    directory_ = std::filesystem::temp_directory_path() / ("tact-flight-" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  static std::vector<std::uint64_t> ticks_in(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::getline(in, line);
    std::vector<std::uint64_t> ticks;
    while (std::getline(in, line)) ticks.push_back(std::stoull(line));
    return ticks;
  }

  std::filesystem::path directory_;
};

TEST_F(FlightRecorderFiles, AFaultDumpsTheTicksBeforeItAndOneSecondAfter) {
  FlightRecorder recorder(100, 2, directory_);
  std::filesystem::path file;
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) {
    TickRecord record;
    record.tick = tick;
    record.faults = tick >= 500 ? bit(Fault::wrench_stale) : 0;
    recorder.push(record);
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
  ASSERT_EQ(ticks.size(), 300u);
  EXPECT_EQ(ticks.front(), 301u);
  EXPECT_EQ(ticks.back(), 600u);
}

TEST_F(FlightRecorderFiles, TheTwistSentStandsUnderItsName) {
  FlightRecorder recorder(100, 1, directory_);
  TickRecord record;
  record.V_sent = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
  recorder.push(record);
  recorder.drain(0);
  std::ifstream in(recorder.dump("test"));
  std::string columns, cells;
  std::getline(in, columns);
  std::getline(in, columns);
  std::getline(in, cells);
  std::istringstream names(columns), values(cells);
  int found = 0;
  for (std::string name, value; std::getline(names, name, ',') && std::getline(values, value, ',');) {
    if (name.rfind("V_sent_", 0) == 0) {
      EXPECT_EQ(std::stoi(value), ++found) << name;
    }
  }
  EXPECT_EQ(found, 6);
  EXPECT_LT(columns.find("tick_ns"), columns.find("V_sent")) << "of one schema, columns are only added at the end";
  EXPECT_EQ(std::count(columns.begin(), columns.end(), ','), std::count(cells.begin(), cells.end(), ','));
}

TEST_F(FlightRecorderFiles, FaultsThatAreNotAskedForAreNotDumped) {
  FlightRecorder recorder(100, 1, directory_);
  for (std::uint64_t tick = 1; tick <= 500; ++tick) {
    TickRecord record;
    record.tick = tick;
    record.faults = tick % 50 == 0 ? bit(Fault::gate_limited) : 0;
    recorder.push(record);
    if (tick % 10 == 0) {
      EXPECT_TRUE(recorder.drain(bit(Fault::wrench_stale)).empty());
    }
  }
}

TEST_F(FlightRecorderFiles, AReaderThatStopsNeverStopsTheWriter) {
  FlightRecorder recorder(100, 1, directory_);
  for (std::uint64_t tick = 1; tick <= 100000; ++tick) {
    TickRecord record;
    record.tick = tick;
    recorder.push(record);
  }
  EXPECT_TRUE(recorder.drain(0).empty());
}

}  // namespace
}  // namespace tact::coupling
