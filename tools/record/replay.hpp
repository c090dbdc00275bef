#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tact::record {

/// Up to these a replayed tick counts as the same. The same program on the same machine repeats every bit; another
/// compiler or processor may round otherwise.
struct Tolerance {
  double force_n = 1e-6, torque_nm = 1e-7, position_m = 1e-9, rotation_rad = 1e-8;
};

struct ReplayResult {
  struct Quantity {
    const char *name, *unit;
    double tolerance;
    double largest = 0;  ///< difference
    std::uint64_t at_tick = 0;
  };
  /// Contact force and torque, coupling force and torque, what was sent, tool pose.
  std::array<Quantity, 10> quantities;
  struct First {
    std::uint64_t tick;
    std::string what;  ///< "contact force: 0.12 N apart: recorded (0 0 10) N, replayed (0 0 9.88) N"
  };
  std::optional<First> first;    ///< beyond its tolerance
  std::uint64_t ticks = 0;       ///< replayed
  std::uint64_t unreplayed = 0;  ///< before the first snapshot, or from a gap to the next one
  std::uint64_t gaps = 0;        ///< ticks that were dropped when it was recorded, or more
  bool from_start = false, ended_early = false;
  std::string session, scene, reason;

  bool same() const { return !first; }
};

/// Runs the coupling once more on what a recording says came in, and compares what goes out. Throws SetupError on a
/// file that is no recording, that holds nothing to replay, or whose snapshots are of another build.
ReplayResult replay(const std::filesystem::path& file, const Tolerance& tolerance = {});

}  // namespace tact::record
