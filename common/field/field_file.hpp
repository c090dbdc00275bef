#pragma once
#include "field/field_blocks.hpp"
#include "file/sealed_file.hpp"

namespace tact {

/// Payload of a field file: FieldFileInfo, coarse entries (padded to 64 bytes), blocks.
inline constexpr SealedKind kFieldKind{{'F', 'E', 'L', 'D'}, 4, "distance field"};
inline constexpr int kMostBlocksPerSide = 1024;

struct FieldFileInfo {
  double min_m[3];
  double voxel_m, band_m;
  std::int32_t blocks[3];
  std::uint32_t stored;  ///< FieldBlocks that follow
  char reserved[8];
};
static_assert(sizeof(FieldFileInfo) == 64);

inline std::size_t field_coarse_bytes(const FieldGrid& grid) {
  return (grid.block_count() * sizeof(CoarseEntry) + 63) / 64 * 64;
}

}  // namespace tact
