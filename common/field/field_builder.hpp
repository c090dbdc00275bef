#pragma once
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "field/distance_field.hpp"
#include "field/field_blocks.hpp"

namespace tact {

/// A field under construction. Whoever fills it sets the distances of the blocks' corners, for every block the coarse
/// entry's slot (or kNotStored), sign and doubt, and for slots the quantised corners of cells; then calls finish().
/// @pre every block that may hold a value within grid.range_m() has a slot: those that the band does not touch are
/// dropped by finish()
struct FieldParts {
  FieldGrid grid;
  std::vector<float> distance_m;    ///< grid.block_corner_count(): to the body's boundary, unsigned, rounded down
  std::vector<CoarseEntry> coarse;  ///< grid.block_count()
  std::vector<FieldBlock> blocks;
};

/// What finish() found.
struct FieldTally {
  std::size_t stored = 0;  ///< blocks kept
  std::size_t jumps = 0;   ///< blocks across which the sign changes without a surface: 0 for a sound body
  std::size_t doubtful = 0;
};

/// Grid of cells of side `voxel_m` that encloses the box with room for the band. Throws SetupError when the box is not
/// finite, is empty or needs more than 8192 cells on a side.
FieldGrid make_grid(const Vec3& min_O, const Vec3& max_O, double voxel_m, double band_voxels = 4);

/// Clamps and rounds 729 signed distances, x fastest, into a block.
void quantise(const FieldGrid& grid, std::span<const float> values_m, FieldBlock& block);

/// Drops blocks that the band does not touch, calls blocks doubtful at which the sign jumps, and sets what probe()
/// promises.
FieldTally finish(FieldParts& parts);

/// Samples a signed distance function (exact, or at least 1-Lipschitz; any thread is the caller's). The body must lie
/// inside the box that made the grid, or be cut by it. finish() included.
FieldParts sample_distance(const FieldGrid& grid, const std::function<double(const Vec3&)>& distance_m);

/// A field in memory.
DistanceField make_field(FieldParts parts, std::uint64_t content_hash = 0);

/// A field that looks at `parts` without owning them: they must outlive it and stay as they are.
DistanceField view_field(const FieldParts& parts);

/// Writes the file that DistanceField::open maps; atomically. Throws SetupError.
void save_field(const FieldParts& parts, const std::filesystem::path& path, std::uint64_t content_hash);

/// In one step, for analytic bodies: build_field(lo, hi, h, [](const Vec3& p) { return p.norm() - 0.05; }).
DistanceField build_field(const Vec3& min_O, const Vec3& max_O, double voxel_m,
                          const std::function<double(const Vec3&)>& distance_m, double band_voxels = 4);

}  // namespace tact
