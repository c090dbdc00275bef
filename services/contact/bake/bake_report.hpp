#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tact::contact {

/// What is read back of the report beside a baked file (README has all it says).
struct BakeReport {
  double seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
  std::vector<std::string> warnings;

  double voxel_m = 0;  ///< of the field; this and the next three: obstacle
  std::optional<double> error_max_m, error_rms_m, thinnest_wall_m, narrowest_gap_m;  ///< nothing: nowhere measured

  std::size_t points = 0;  ///< of the pointshell; this and the next: tool
  double largest_gap_m = 0;
};

enum class BakedPart { obstacle, tool };

/// Throws SetupError "<file>: <key>: found ..., expected ...: delete it and bake again".
BakeReport read_bake_report(const std::filesystem::path& path, BakedPart part);

}  // namespace tact::contact
