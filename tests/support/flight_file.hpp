#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "math/pose.hpp"

namespace tact::test {

/// What tests read of a flight record (coupling/loop/flight_recorder.hpp).
struct FlightTick {
  std::uint64_t tick, pose_seq, reply_seq;
  std::uint32_t wrench_age_ticks, faults;
  std::uint32_t contact_count;
  Wrench F_contact_W, F_sent_W;
  Pose X_WH, X_sent;
};

/// Reads columns by their names. Throws std::runtime_error on a file that is not a flight record.
std::vector<FlightTick> read_flight(const std::filesystem::path& file);

}  // namespace tact::test
