#include "coupling/device/device_events.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "fault/fault.hpp"
#include "support/process.hpp"

namespace tact::coupling {
namespace {

class DeviceEventFile : public ::testing::Test {
 protected:
  std::string error_of(const std::string& text) const {
    std::ofstream(file_) << text;
    try {
      load_device_events(file_);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "none";
  }
  const test::ScratchDir dir_;
  const std::filesystem::path file_ = dir_.path() / "events.csv";
};

TEST_F(DeviceEventFile, EveryEventIsReadByItsName) {
  {
    std::ofstream out(file_);
    out << "time_s,event,duration_s\n";
    for (std::size_t i = 0; i < kDeviceEvents; ++i)
      out << i << ".5," << name(static_cast<DeviceEvent>(i)) << ",0.25\r\n";
  }
  const auto events = load_device_events(file_);
  ASSERT_EQ(events.size(), kDeviceEvents);
  for (std::size_t i = 0; i < kDeviceEvents; ++i) {
    const double t = static_cast<double>(i) + 0.5;
    EXPECT_EQ(events[i].time_s, t);
    EXPECT_EQ(active_events(events, t), 1u << i);
    EXPECT_EQ(active_events(events, t + 0.2499), 1u << i);
    EXPECT_EQ(active_events(events, t + 0.25), 0u);
  }
}

TEST_F(DeviceEventFile, WhatMakesNoSenseIsNamedWithItsLine) {
  for (const char* line : {"1,no-such-event,1", "1,lost", "-1,lost,1", "x,lost,1", "1,lost,nan", "1,lost,1,2", "1"}) {
    const std::string error = error_of(std::string("time_s,event,duration_s\n0,lost,1\n") + line + "\n");
    EXPECT_NE(error.find("line 3: found \"" + std::string(line)), std::string::npos) << error;
    EXPECT_NE(error.find("dead-man"), std::string::npos) << error;
  }
  EXPECT_NE(error_of("time,event\n1,lost,1\n").find("line 1"), std::string::npos);
  EXPECT_NE(error_of("time_s,event,duration_s\n").find("at least one event"), std::string::npos);
  EXPECT_THROW(load_device_events(dir_.path() / "none.csv"), SetupError);
}

}  // namespace
}  // namespace tact::coupling
