#include "contact/bake/worker/field_bake.hpp"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/bake/worker/block_distances.hpp"
#include "contact/bake/worker/edges.hpp"
#include "contact/bake/worker/parallel.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  Vec3 low = Vec3::Constant(kInfinity), high = -low;
};

Box box_of(const Mesh& mesh) {
  Box box;
  for (const auto& v : mesh.vertices) {
    box.low = box.low.cwiseMin(v.cast<double>());
    box.high = box.high.cwiseMax(v.cast<double>());
  }
  return box;
}

/// Distance to the boundary of the body from any place, and whether that is inside a plate.
struct Nearest {
  double solid = kInfinity, sheet = kInfinity;  ///< of the last place, or an upper bound

  double move(const SplitSoup& split, const Vec3& p, double step_m) {
    solid = split.solid.distance(p, solid + 1.001 * step_m);
    sheet = split.sheets.distance(p, sheet + 1.001 * step_m);
    return std::min(solid, std::fabs(sheet - split.half_thickness_m));
  }
  bool in_plate(const SplitSoup& split) const { return sheet < split.half_thickness_m; }
};

/// Distances of the blocks' corners; decides which blocks are stored. Rows in parallel: along a row the last distance
/// bounds the next.
void coarse_distances(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const FieldGrid& grid = parts.grid;
  const double block_m = kBlockCells * grid.voxel_m, half_diagonal = std::sqrt(3.0) / 2 * block_m;
  const double reach = grid.range_m() + half_diagonal;
  const int nx = grid.blocks[0], ny = grid.blocks[1], nz = grid.blocks[2];
  std::vector<std::uint8_t> in_plate(grid.block_corner_count(), 0), stored(grid.block_count(), 0);
  parallel_stage("far field", static_cast<std::size_t>(ny + 1) * static_cast<std::size_t>(nz + 1), progress,
                 [&](std::size_t row) {
                   const int y = static_cast<int>(row) % (ny + 1), z = static_cast<int>(row) / (ny + 1);
                   Nearest nearest;
                   for (int x = 0; x <= nx; ++x) {
                     const std::size_t i = grid.block_corner_index(x, y, z);
                     const Vec3 corner = grid.corner_O(kBlockCells * x, kBlockCells * y, kBlockCells * z);
                     parts.distance_m[i] = static_cast<float>(nearest.move(split, corner, block_m) * (1 - 1e-6));
                     in_plate[i] = nearest.in_plate(split);
                   }
                 });
  parallel_stage("near field", static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), progress,
                 [&](std::size_t row) {
                   const int y = static_cast<int>(row) % ny, z = static_cast<int>(row) / ny;
                   for (int x = 0; x < nx; ++x) {
                     float least = std::numeric_limits<float>::infinity();
                     for (int k = 0; k < 8; ++k) {
                       const int at[3] = {x + (k & 1), y + ((k >> 1) & 1), z + (k >> 2)};
                       least = std::min(least, parts.distance_m[grid.block_corner_index(at[0], at[1], at[2])]);
                     }
                     const std::size_t i = grid.block_index(x, y, z);
                     CoarseEntry& entry = parts.coarse[i];
                     if (in_plate[grid.block_corner_index(x, y, z)]) entry.slot_and_flags |= CoarseEntry::kInside;
                     // Every place of a block is within half a diagonal of a corner, and of the centre.
                     if (static_cast<double>(least) > reach) continue;
                     Nearest nearest{1.001 * reach, 1.001 * reach + split.half_thickness_m};
                     stored[i] = nearest.move(split, grid.block_centre_O(x, y, z), 0) <= reach;
                   }
                 });
  std::size_t slots = 0;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i]) parts.coarse[i].slot_and_flags = static_cast<std::uint32_t>(slots++);
  }
  parts.blocks.resize(slots);
}

template <class Body>  ///< body(slot, x, y, z)
void for_each_stored(const char* stage, FieldParts& parts, const StageProgress& progress, const Body& body) {
  const FieldGrid& grid = parts.grid;
  std::vector<std::array<int, 3>> at(parts.blocks.size());
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        const CoarseEntry& entry = parts.coarse[grid.block_index(x, y, z)];
        if (entry.stored()) at[entry.slot()] = {x, y, z};
      }
    }
  }
  parallel_stage(stage, at.size(), progress,
                 [&](std::size_t slot) { body(slot, at[slot][0], at[slot][1], at[slot][2]); });
}

/// Unsigned distances of all stored corners to the solid part.
void solid_distances(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const double limit = parts.grid.range_m() * (1 + 1e-6);
  tbb::enumerable_thread_specific<BlockDistances> scratch([&] { return BlockDistances(split.solid, parts.grid); });
  for_each_stored("distances", parts, progress, [&](std::size_t slot, int x, int y, int z) {
    std::array<float, kBlockValues> values;
    scratch.local().compute(x, y, z, limit, values);
    quantise(parts.grid, values, parts.blocks[slot]);
  });
}

/// Signed values become the least of solid and plates.
void add_sheets(FieldParts& parts, const SplitSoup& split, const StageProgress& progress) {
  const double half = split.half_thickness_m, range = parts.grid.range_m();
  const double step = range / 32767;
  tbb::enumerable_thread_specific<BlockDistances> scratch([&] { return BlockDistances(split.sheets, parts.grid); });
  for_each_stored("sheets", parts, progress, [&](std::size_t slot, int x, int y, int z) {
    std::array<float, kBlockValues> values;
    scratch.local().compute(x, y, z, (range + half) * (1 + 1e-6), values);
    FieldBlock& block = parts.blocks[slot];
    for (std::size_t i = 0; i < kBlockValues; ++i) {
      values[i] = static_cast<float>(std::min(step * block.q[i], static_cast<double>(values[i]) - half));
    }
    quantise(parts.grid, values, block);
  });
}

/// Blocks, by index, that the rim of a hole which was not closed passes through.
std::vector<std::uint8_t> find_rim(const FieldGrid& grid, const Soup& soup) {
  std::vector<std::uint8_t> rim(grid.block_count(), 0);
  const double block_m = kBlockCells * grid.voxel_m;
  for_each_edge(edges_of(soup.mesh.triangles), [&](const Edge* first, const Edge* last) {
    if (last - first != 1 || soup.closed.of[first->triangle] != 0) return;
    const Vec3 a = (soup.mesh.vertices[first->a].cast<double>() - grid.min_O) / block_m,
               b = (soup.mesh.vertices[first->b].cast<double>() - grid.min_O) / block_m;
    const int steps = 1 + static_cast<int>(2 * kBlockCells * (b - a).norm());  // half a voxel
    for (int k = 0; k <= steps; ++k) {
      const Vec3 at = a + (b - a) * (static_cast<double>(k) / steps);
      const double hair = 1.0 / kBlockCells;  // corners across a face of the block are its own too
      for (int corner = 0; corner < 8; ++corner) {
        std::array<int, 3> block;
        for (int i = 0; i < 3; ++i) {
          const auto axis = static_cast<std::size_t>(i);
          block[axis] =
              std::clamp(static_cast<int>(at[i] + ((corner >> i) & 1 ? hair : -hair)), 0, grid.blocks[axis] - 1);
        }
        rim[grid.block_index(block[0], block[1], block[2])] = 1;
      }
    }
  });
  return rim;
}

/// What closes a hole is a guess: blocks are doubtful as far off as it may be wrong, if the grid resolves that.
void doubt_holes(FieldParts& parts, const Soup& soup) {
  const FieldGrid& grid = parts.grid;
  const double block_m = kBlockCells * grid.voxel_m, half_diagonal = std::sqrt(3.0) / 2 * block_m;
  for (const Hole& hole : soup.closed.holes) {
    if (hole.error_m < 0.5 * grid.voxel_m) continue;
    for (std::uint32_t k = hole.first; k < hole.first + hole.count; ++k) {
      Vec3 corner[3];
      for (std::size_t i = 0; i < 3; ++i) corner[i] = soup.mesh.vertices[soup.closed.caps[k][i]].cast<double>();
      const Triangle cap(corner[0], corner[1], corner[2]);
      const Vec3 reach = Vec3::Constant(hole.error_m);
      const Vec3 low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]) - reach - grid.min_O,
                 high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]) + reach - grid.min_O;
      std::array<int, 3> first, last;
      for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        first[i] = std::max(0, static_cast<int>(low[a] / block_m));
        last[i] = std::min(grid.blocks[i] - 1, static_cast<int>(high[a] / block_m));
      }
      for (int z = first[2]; z <= last[2]; ++z) {
        for (int y = first[1]; y <= last[1]; ++y) {
          for (int x = first[0]; x <= last[0]; ++x) {
            const double reached = half_diagonal + hole.error_m;
            if (cap.square_distance(grid.block_centre_O(x, y, z)) > reached * reached) continue;
            parts.coarse[grid.block_index(x, y, z)].slot_and_flags |= CoarseEntry::kDoubtful;
          }
        }
      }
    }
  }
}

}  // namespace

FieldParts bake_field(const Soup& soup, const FieldOptions& options, const StageProgress& progress,
                      FieldReport& report) {
  const SplitSoup split = split_soup(soup, options.sheet_thickness_m, progress);
  report.solids = split.report;
  const Box box = box_of(soup.mesh);
  const Vec3 margin = Vec3::Constant(split.half_thickness_m);
  FieldParts parts;
  parts.grid = make_grid(box.low - margin, box.high + margin, (box.high - box.low).maxCoeff() / options.resolution,
                         options.band_voxels);
  parts.coarse.resize(parts.grid.block_count());
  parts.distance_m.resize(parts.grid.block_corner_count());

  coarse_distances(parts, split, progress);
  solid_distances(parts, split, progress);
  report.signs = settle_signs(parts, split.inside, find_rim(parts.grid, soup), progress);
  doubt_holes(parts, soup);
  if (!split.sheets.empty()) add_sheets(parts, split, progress);
  const FieldTally tally = finish(parts);

  report.resolution = options.resolution;
  report.voxel_m = parts.grid.voxel_m;
  for (std::size_t i = 0; i < 3; ++i) report.cells[i] = kBlockCells * parts.grid.blocks[i];
  report.blocks_stored = tally.stored;
  report.bytes = parts.blocks.size() * sizeof(FieldBlock) + parts.coarse.size() * sizeof(CoarseEntry);
  report.jumping_blocks = tally.jumps;
  report.signs.doubtful_blocks = tally.doubtful;
  report.quality = judge_field(parts, split, progress);
  return parts;
}

}  // namespace tact::contact
