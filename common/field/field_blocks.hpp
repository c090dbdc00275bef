#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "math/pose.hpp"

namespace tact {

/// The stored form of a DistanceField, shared by the sampler, the builder and the file (schema 4).
///
/// Space is nb.x * nb.y * nb.z blocks of 8x8x8 cells. Each block has a 16-byte coarse entry; the entry of a block that
/// the band touches names one FieldBlock.
inline constexpr int kBlockCells = 8;
inline constexpr int kBlockCorners = kBlockCells + 1;
inline constexpr int kBlockValues = kBlockCorners * kBlockCorners * kBlockCorners;  ///< 729

/// A part of a block, 4x4x4 cells, and a lower bound of its values: level + slope.v, v in cells from its middle, in
/// steps. An affine function that is below the values at the corners of cells is below them in the cells.
inline constexpr int kPartCells = kBlockCells / 2;
struct PartBound {
  std::int16_t level = 0;
  std::array<std::int16_t, 3> slope{};
};

/// Corner values of one block, x fastest: value_m = range_m * q / 32767. Padded to whole cache lines.
struct alignas(64) FieldBlock {
  std::array<std::int16_t, 736> q{};
  std::array<PartBound, 8> part{};  ///< x fastest; set by finish()

  static constexpr int index(int x, int y, int z) { return (z * kBlockCorners + y) * kBlockCorners + x; }
};
static_assert(sizeof(PartBound) == 8 && sizeof(FieldBlock) == 1536);
/// So that every PartBound of a field has a 32-bit number.
inline constexpr std::size_t kMostStoredBlocks = (std::size_t{1} << 31) / (sizeof(FieldBlock) / sizeof(PartBound));

/// The upper half of a float: 8 bits of precision in two bytes.
struct HalfFloat {
  std::uint16_t bits = 0;

  float value() const noexcept { return std::bit_cast<float>(static_cast<std::uint32_t>(bits) << 16); }
  /// The nearest one not farther from 0.
  static HalfFloat toward_zero(float x) noexcept {
    return {static_cast<std::uint16_t>(std::bit_cast<std::uint32_t>(x) >> 16)};
  }
};

struct CoarseEntry {
  static constexpr std::uint32_t kDoubtful = 1u << 31;
  static constexpr std::uint32_t kInside = 1u << 30;    ///< sign of a block that is not stored
  static constexpr std::uint32_t kPositive = 1u << 29;  ///< stored, and all values are more than 0
  static constexpr std::uint32_t kSlotMask = kPositive - 1;
  static constexpr std::uint32_t kNotStored = kSlotMask;

  std::uint32_t slot_and_flags = kNotStored;
  /// The boundary of the body is nowhere nearer than sqrt(|v|^2 + level + tilt.v), v from the block's centre, all in
  /// cells (README). Less near jumps of the sign: there, no jumping block is nearer either. Set by finish().
  float level = -kBlockCells * kBlockCells;
  std::array<HalfFloat, 3> tilt{};
  /// 1 / steepest slope of positive values, at most 1; of a stored block: of its neighbours too, and 0 near jumps.
  HalfFloat inverse_slope = HalfFloat::toward_zero(1);

  std::uint32_t slot() const noexcept { return slot_and_flags & kSlotMask; }
  bool stored() const noexcept { return slot() != kNotStored; }
  bool inside() const noexcept { return (slot_and_flags & kInside) != 0; }
  bool positive() const noexcept { return (slot_and_flags & kPositive) != 0; }
  bool doubtful() const noexcept { return (slot_and_flags & kDoubtful) != 0; }
};
static_assert(sizeof(CoarseEntry) == 16);

/// The grid: where cells are and what the 16-bit values mean.
struct FieldGrid {
  Vec3 min_O = Vec3::Zero();  ///< m, corner of block (0, 0, 0)
  double voxel_m = 0;         ///< h, edge of a cell
  double band_m = 0;          ///< values are trusted where |sdf| <= band_m
  std::array<int, 3> blocks{0, 0, 0};

  /// Stored values reach a little further than the band, so that a cell with an in-band value has no clamped corner.
  double range_m() const { return band_m + 2 * voxel_m; }
  std::size_t block_count() const {
    return static_cast<std::size_t>(blocks[0]) * static_cast<std::size_t>(blocks[1]) *
           static_cast<std::size_t>(blocks[2]);
  }
  std::size_t block_index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(blocks[0]) +
           static_cast<std::size_t>(x);
  }
  /// Corners of blocks, shared by neighbours: one more than blocks along each axis.
  std::size_t block_corner_count() const { return block_corner_index(0, 0, blocks[2] + 1); }
  std::size_t block_corner_index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(blocks[1] + 1) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(blocks[0] + 1) +
           static_cast<std::size_t>(x);
  }
  Vec3 corner_O(int x, int y, int z) const { return min_O + voxel_m * Vec3(x, y, z); }  ///< global corner indices
  Vec3 block_centre_O(int x, int y, int z) const {
    return min_O + voxel_m * kBlockCells * Vec3(x + 0.5, y + 0.5, z + 0.5);
  }
};

}  // namespace tact
