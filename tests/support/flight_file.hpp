#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

#include "math/pose.hpp"

namespace tact::test {

/// What tests read of a recording (coupling/loop/recording.hpp).
struct FlightTick {
  std::uint64_t tick, pose_seq, reply_seq;
  std::uint32_t wrench_age_ticks, faults;
  std::uint32_t contact_count;
  Wrench F_contact_W, F_sent_W;
  Pose X_WH, X_BH, X_sent;  ///< handle in W; handle and set-point in the device's frame
  std::uint64_t skipped;    ///< grid points just before
};

/// Throws SetupError on a file that is no recording.
std::vector<FlightTick> read_flight(const std::filesystem::path& file);

}  // namespace tact::test
