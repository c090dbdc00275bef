#include "field/field_builder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fault/fault.hpp"
#include "field/block_transform.hpp"
#include "field/field_file.hpp"

namespace tact {
namespace {

std::int16_t to_steps(float value_m, double inverse_step) {
  return static_cast<std::int16_t>(std::lround(std::clamp(value_m * inverse_step, -32767.0, 32767.0)));
}

/// Whether the eight corners of a cell could be those of a distance: |v_i - v_j| <= |c_i - c_j| for all pairs. Only a
/// cell of both signs can fail, because unsigned distances to a set always comply. Values in steps.
bool cell_jumps(const std::int16_t* q, double cell_steps) {
  constexpr int dy = kBlockCorners, dz = kBlockCorners * kBlockCorners;
  const int v[8] = {q[0], q[1], q[dy], q[dy + 1], q[dz], q[dz + 1], q[dz + dy], q[dz + dy + 1]};
  const auto [low, high] = std::minmax_element(v, v + 8);
  if (*low >= 0 || *high < 0 || *high - *low <= cell_steps) return false;
  const double limit[4] = {0, cell_steps, std::sqrt(2.0) * cell_steps, std::sqrt(3.0) * cell_steps};
  for (unsigned i = 0; i < 8; ++i) {
    for (unsigned j = i + 1; j < 8; ++j) {
      const auto axes = static_cast<std::size_t>(__builtin_popcount(i ^ j));
      if (std::abs(v[i] - v[j]) > limit[axes] + 3) return true;  // 3 steps of rounding
    }
  }
  return false;
}

bool block_jumps(const FieldBlock& block, double cell_steps) {
  for (int z = 0; z < kBlockCells; ++z) {
    for (int y = 0; y < kBlockCells; ++y) {
      for (int x = 0; x < kBlockCells; ++x) {
        if (cell_jumps(&block.q[static_cast<std::size_t>(FieldBlock::index(x, y, z))], cell_steps)) return true;
      }
    }
  }
  return false;
}

/// Whether the face of a stored block that it shares with an unstored neighbour denies the neighbour's sign.
bool face_denies(const FieldBlock& block, int axis, bool upper, bool inside) {
  for (int a = 0; a < kBlockCorners; ++a) {
    for (int b = 0; b < kBlockCorners; ++b) {
      int c[3];
      c[axis] = upper ? kBlockCells : 0;
      c[(axis + 1) % 3] = a;
      c[(axis + 2) % 3] = b;
      if ((block.q[static_cast<std::size_t>(FieldBlock::index(c[0], c[1], c[2]))] < 0) != inside) return true;
    }
  }
  return false;
}

/// Whether two stored neighbours disagree about a corner of the face they share by more than rounding; `next` is the
/// upper one.
bool corners_differ(const FieldBlock& block, const FieldBlock& next, int axis) {
  for (int a = 0; a < kBlockCorners; ++a) {
    for (int b = 0; b < kBlockCorners; ++b) {
      int c[3];
      c[(axis + 1) % 3] = a;
      c[(axis + 2) % 3] = b;
      c[axis] = kBlockCells;
      const int below = block.q[static_cast<std::size_t>(FieldBlock::index(c[0], c[1], c[2]))];
      c[axis] = 0;
      const int above = next.q[static_cast<std::size_t>(FieldBlock::index(c[0], c[1], c[2]))];
      if (std::abs(below - above) > 1) return true;
    }
  }
  return false;
}

/// Steepest slope of the interpolant in the cells of a block that hold positive values, in steps a cell. In a cell
/// each partial derivative is bilinear in the two other coordinates, so the squared norm of the gradient is convex in
/// each coordinate and largest at a corner, where it is that of the three edges that meet there.
float steepest_slope(const FieldBlock& block) {
  constexpr int dy = kBlockCorners, dz = kBlockCorners * kBlockCorners;
  float steepest = 0;
  for (int z = 0; z < kBlockCells; ++z) {
    for (int y = 0; y < kBlockCells; ++y) {
      const std::int16_t* q = &block.q[static_cast<std::size_t>(FieldBlock::index(0, y, z))];
      float row[kBlockCells];
      for (int x = 0; x < kBlockCells; ++x) {  // vectorised
        float v[8];
        for (int k = 0; k < 8; ++k) v[k] = q[x + (k & 1) + ((k >> 1) & 1) * dy + (k >> 2) * dz];
        float edge[3][4];  // squares: along x by (y, z), along y by (x, z), along z by (x, y)
        float most = 0, largest = v[0];
        for (int k = 0; k < 4; ++k) {
          const float ex = v[2 * k + 1] - v[2 * k];
          const float ey = v[(k & 1) + (k >> 1) * 4 + 2] - v[(k & 1) + (k >> 1) * 4];
          const float ez = v[k + 4] - v[k];
          edge[0][k] = ex * ex;
          edge[1][k] = ey * ey;
          edge[2][k] = ez * ez;
        }
        for (int k = 0; k < 8; ++k) {
          const float square = edge[0][k >> 1] + edge[1][(k & 1) + (k >> 2) * 2] + edge[2][k & 3];
          most = square > most ? square : most;
          largest = v[k] > largest ? v[k] : largest;
        }
        row[x] = largest > 0 ? most : 0;
      }
      for (const float square : row) steepest = std::max(steepest, square);
    }
  }
  return std::sqrt(steepest);
}

/// Keeps the blocks that hold a value within the band, in order of their index.
void drop_far_blocks(FieldParts& parts) {
  const double steps = 32767 * parts.grid.band_m / parts.grid.range_m();
  const auto band = static_cast<std::int16_t>(std::floor(steps));
  std::vector<FieldBlock> kept;
  kept.reserve(parts.blocks.size());
  for (CoarseEntry& entry : parts.coarse) {
    if (!entry.stored()) continue;
    const FieldBlock& block = parts.blocks[entry.slot()];
    const auto values = std::span(block.q).first(kBlockValues);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    std::uint32_t flags = entry.slot_and_flags & CoarseEntry::kDoubtful;
    if (*low > 0) flags |= CoarseEntry::kPositive;
    if (*low > band || *high < -band) {
      flags = (flags & CoarseEntry::kDoubtful) | (*high < 0 ? CoarseEntry::kInside : 0);
      entry.slot_and_flags = flags | CoarseEntry::kNotStored;
    } else {
      entry.slot_and_flags = flags | static_cast<std::uint32_t>(kept.size());
      kept.push_back(block);
    }
  }
  kept.shrink_to_fit();
  parts.blocks = std::move(kept);
}

std::vector<std::uint8_t> find_jumps(const FieldParts& parts) {
  const FieldGrid& grid = parts.grid;
  const double cell_steps = 32767 * grid.voxel_m / grid.range_m();
  std::vector<std::uint8_t> jumps(grid.block_count(), 0);
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        const std::size_t i = grid.block_index(x, y, z);
        const CoarseEntry& entry = parts.coarse[i];
        if (entry.stored() && block_jumps(parts.blocks[entry.slot()], cell_steps)) jumps[i] = 1;
        for (int axis = 0; axis < 3; ++axis) {  // each face once, from its lower side
          int n[3] = {x, y, z};
          if (++n[axis] >= grid.blocks[static_cast<std::size_t>(axis)]) continue;
          const std::size_t j = grid.block_index(n[0], n[1], n[2]);
          const CoarseEntry& next = parts.coarse[j];
          bool denied = false;
          if (entry.stored() && next.stored()) {
            denied = corners_differ(parts.blocks[entry.slot()], parts.blocks[next.slot()], axis);
          } else if (!entry.stored() && !next.stored()) {
            denied = entry.inside() != next.inside();
          } else if (!next.stored()) {
            denied = face_denies(parts.blocks[entry.slot()], axis, true, next.inside());
          } else if (!entry.stored()) {
            denied = face_denies(parts.blocks[next.slot()], axis, false, entry.inside());
          }
          if (denied) jumps[i] = jumps[j] = 1;
        }
      }
    }
  }
  return jumps;
}

/// Lowers `value` of each block to the least within `reach` blocks along `axis`. @pre one value a block
void lowest_nearby(const FieldGrid& grid, int axis, int reach, std::vector<float>& value) {
  const std::array<int, 3>& n = grid.blocks;
  const auto along = static_cast<std::size_t>(axis);
  std::vector<float> line(static_cast<std::size_t>(n[along]));
  int b[3];
  const auto index = [&] { return grid.block_index(b[0], b[1], b[2]); };
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  for (b[v] = 0; b[v] < n[static_cast<std::size_t>(v)]; ++b[v]) {
    for (b[u] = 0; b[u] < n[static_cast<std::size_t>(u)]; ++b[u]) {
      for (b[axis] = 0; b[axis] < n[along]; ++b[axis]) line[static_cast<std::size_t>(b[axis])] = value[index()];
      for (b[axis] = 0; b[axis] < n[along]; ++b[axis]) {
        float& lowest = value[index()];
        for (int k = std::max(0, b[axis] - reach); k <= std::min(n[along] - 1, b[axis] + reach); ++k) {
          lowest = std::min(lowest, line[static_cast<std::size_t>(k)]);
        }
      }
    }
  }
}

/// Sets CoarseEntry::inverse_slope of every block to its own.
void set_own_slopes(FieldParts& parts) {
  const double cell_steps = 32767 * parts.grid.voxel_m / parts.grid.range_m();
  for (CoarseEntry& entry : parts.coarse) {
    if (!entry.stored()) continue;
    const double slope = steepest_slope(parts.blocks[entry.slot()]) / cell_steps;
    entry.inverse_slope = HalfFloat::toward_zero(static_cast<float>((1 - 1e-6) / std::max(1.0, slope)));
  }
}

/// Lowers CoarseEntry::inverse_slope of stored blocks to the least of the neighbours: a ball of values no larger than
/// the range reaches no farther.
void spread_slopes(FieldParts& parts, const std::vector<std::uint8_t>& jumps) {
  const FieldGrid& grid = parts.grid;
  std::vector<float> least(grid.block_count());
  for (std::size_t i = 0; i < least.size(); ++i) least[i] = jumps[i] != 0 ? 0 : parts.coarse[i].inverse_slope.value();
  const int reach = static_cast<int>(std::ceil(grid.range_m() / (kBlockCells * grid.voxel_m)));
  for (int axis = 0; axis < 3; ++axis) lowest_nearby(grid, axis, reach, least);
  for (std::size_t i = 0; i < least.size(); ++i) {
    if (parts.coarse[i].stored()) parts.coarse[i].inverse_slope = HalfFloat::toward_zero(least[i]);
  }
}

/// The slope is the least-squares one, the level as high as the corners allow.
PartBound part_bound(const std::int16_t* q) {
  constexpr int n = kPartCells + 1, half = kPartCells / 2;
  int lowest = 32767, moment[3] = {0, 0, 0};
  const auto at = [&](int x, int y, int z) { return static_cast<int>(q[FieldBlock::index(x, y, z)]); };
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      int row = 0;
      for (int x = 0; x < n; ++x) {
        const int value = at(x, y, z);
        lowest = std::min(lowest, value);
        row += value;
        moment[0] += (x - half) * value;
      }
      moment[1] += (y - half) * row;
      moment[2] += (z - half) * row;
    }
  }
  constexpr int kSquares = 2 * (1 + 4) * n * n;  // sum of (x - half)^2
  static_assert(kPartCells == 4);
  int slope[3], level = 32767;
  for (int i = 0; i < 3; ++i) slope[i] = std::clamp(moment[i] / kSquares, -32767, 32767);
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      const int rest = (y - half) * slope[1] + (z - half) * slope[2];
      for (int x = 0; x < n; ++x) level = std::min(level, at(x, y, z) - rest - (x - half) * slope[0]);
    }
  }
  PartBound bound{static_cast<std::int16_t>(lowest), {}};
  if (level >= -32767) {
    bound.level = static_cast<std::int16_t>(level);
    for (std::size_t i = 0; i < 3; ++i) bound.slope[i] = static_cast<std::int16_t>(slope[i]);
  }
  return bound;
}

void set_part_bounds(FieldParts& parts) {
  for (FieldBlock& block : parts.blocks) {
    for (int k = 0; k < 8; ++k) {
      const int x = kPartCells * (k & 1), y = kPartCells * ((k >> 1) & 1), z = kPartCells * (k >> 2);
      block.part[static_cast<std::size_t>(k)] = part_bound(block.q.data() + FieldBlock::index(x, y, z));
    }
  }
}

/// The affine part of a lower bound of the squared distance: d^2 - |v|^2 is the least of affine functions of v, one for
/// each point of the boundary, so it is concave, and no affine function that is below it at the corners of a block is
/// above it inside. The tilt fits the corners, the level is as high as they allow. All in cells.
void set_bound(const double (&distance)[8], CoarseEntry& entry) {
  constexpr double kHalf = 0.5 * kBlockCells, kCornerSquare = 3 * kHalf * kHalf;
  double tilt[3] = {0, 0, 0};
  for (unsigned k = 0; k < 8; ++k) {
    for (unsigned i = 0; i < 3; ++i) tilt[i] += ((k >> i) & 1 ? 1 : -1) * distance[k] * distance[k] / (8 * kHalf);
  }
  for (unsigned i = 0; i < 3; ++i) {
    entry.tilt[i] = HalfFloat::toward_zero(static_cast<float>(tilt[i]));
    tilt[i] = static_cast<double>(entry.tilt[i].value());
  }
  double level = std::numeric_limits<double>::infinity();
  for (unsigned k = 0; k < 8; ++k) {
    double here = distance[k] * distance[k] - kCornerSquare;
    for (unsigned i = 0; i < 3; ++i) here -= ((k >> i) & 1 ? 1 : -1) * kHalf * tilt[i];
    level = std::min(level, here);
  }
  entry.level = static_cast<float>(level - 1e-6 * (1 + std::fabs(level)));
}

/// Sets CoarseEntry::level and tilt of every block. `to_jump`: from the middle of a block to the nearest jumping block,
/// in cells; empty: there is none.
void set_bounds(FieldParts& parts, const std::vector<float>& to_jump) {
  const FieldGrid& grid = parts.grid;
  constexpr double kHalfDiagonal = 0.8661 * kBlockCells, kFarthest = 1e6;  // finite
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        const std::size_t i = grid.block_index(x, y, z);
        double distance[8], farthest = 0;
        for (int k = 0; k < 8; ++k) {
          const auto at = grid.block_corner_index(x + (k & 1), y + ((k >> 1) & 1), z + (k >> 2));
          distance[k] = std::min(kFarthest, static_cast<double>(parts.distance_m[at]) / grid.voxel_m);
          farthest = std::max(farthest, distance[k]);
        }
        CoarseEntry& entry = parts.coarse[i];
        set_bound(distance, entry);
        if (to_jump.empty()) continue;
        // Not beyond the nearest jumping block. No bound is above its largest corner; this one is `limit` there.
        double limit = std::max(0.0, static_cast<double>(to_jump[i]) - kHalfDiagonal);
        if (limit >= farthest) continue;
        double least_square = static_cast<double>(entry.level);
        for (const HalfFloat tilt : entry.tilt)
          least_square -= 0.5 * kBlockCells * std::fabs(static_cast<double>(tilt.value()));
        limit = std::min(limit, std::sqrt(std::max(0.0, least_square)));
        entry.tilt = {};
        entry.level = static_cast<float>(limit * limit - kHalfDiagonal * kHalfDiagonal);
      }
    }
  }
}

}  // namespace

FieldGrid make_grid(const Vec3& min_O, const Vec3& max_O, double voxel_m, double band_voxels) {
  FieldGrid grid;
  grid.voxel_m = voxel_m;
  grid.band_m = band_voxels * voxel_m;
  if (!min_O.allFinite() || !max_O.allFinite() || !(voxel_m > 0) || !((max_O - min_O).minCoeff() >= 0)) {
    throw SetupError("distance field: the body's box or the voxel size is not finite and positive");
  }
  const double block_m = kBlockCells * voxel_m;
  const double margin = grid.range_m() + voxel_m;
  for (int i = 0; i < 3; ++i) {
    const double blocks = std::ceil((max_O[i] - min_O[i] + 2 * margin) / block_m);
    if (!(blocks <= kMostBlocksPerSide)) {
      throw SetupError("distance field: more than " + std::to_string(kMostBlocksPerSide * kBlockCells) +
                       " cells on a side: choose a lower resolution");
    }
    grid.blocks[static_cast<std::size_t>(i)] = static_cast<int>(blocks);
    grid.min_O[i] = 0.5 * (min_O[i] + max_O[i] - blocks * block_m);
  }
  return grid;
}

void quantise(const FieldGrid& grid, std::span<const float> values_m, FieldBlock& block) {
  TACT_CHECK(values_m.size() == kBlockValues);
  const double inverse_step = 32767 / grid.range_m();
  for (std::size_t i = 0; i < kBlockValues; ++i) block.q[i] = to_steps(values_m[i], inverse_step);
}

FieldTally finish(FieldParts& parts) {
  TACT_CHECK(parts.coarse.size() == parts.grid.block_count());
  TACT_CHECK(parts.distance_m.size() == parts.grid.block_corner_count());
  const std::vector<std::uint8_t> jumps = find_jumps(parts);
  set_own_slopes(parts);
  drop_far_blocks(parts);
  if (parts.blocks.size() > kMostStoredBlocks) {
    throw SetupError("distance field: more than " + std::to_string(kMostStoredBlocks) +
                     " blocks near the surface: choose a lower resolution");
  }
  FieldTally tally;
  tally.stored = parts.blocks.size();
  tally.jumps = static_cast<std::size_t>(std::count(jumps.begin(), jumps.end(), std::uint8_t{1}));
  spread_slopes(parts, jumps);
  std::vector<float> to_jump;
  if (tally.jumps > 0) {
    to_jump = distance_between_blocks(parts.grid, jumps);
    for (float& blocks : to_jump) blocks = kBlockCells * (blocks - 0.8661f);
    for (std::size_t i = 0; i < parts.coarse.size(); ++i) {
      if (jumps[i] != 0) parts.coarse[i].slot_and_flags |= CoarseEntry::kDoubtful;  // one side of it is wrong
    }
  }
  set_bounds(parts, to_jump);
  set_part_bounds(parts);
  for (const CoarseEntry& entry : parts.coarse) tally.doubtful += entry.doubtful() ? 1 : 0;
  return tally;
}

FieldParts sample_distance(const FieldGrid& grid, const std::function<double(const Vec3&)>& distance_m) {
  FieldParts parts;
  parts.grid = grid;
  parts.coarse.resize(grid.block_count());
  parts.distance_m.resize(grid.block_corner_count());
  for (int z = 0; z <= grid.blocks[2]; ++z) {
    for (int y = 0; y <= grid.blocks[1]; ++y) {
      for (int x = 0; x <= grid.blocks[0]; ++x) {
        const double d = distance_m(grid.corner_O(kBlockCells * x, kBlockCells * y, kBlockCells * z));
        parts.distance_m[grid.block_corner_index(x, y, z)] = static_cast<float>(std::fabs(d) * (1 - 1e-6));
      }
    }
  }
  const double reach = grid.range_m() + std::sqrt(3.0) / 2 * kBlockCells * grid.voxel_m;
  std::vector<float> values(kBlockValues);
  for (int z = 0; z < grid.blocks[2]; ++z) {
    for (int y = 0; y < grid.blocks[1]; ++y) {
      for (int x = 0; x < grid.blocks[0]; ++x) {
        CoarseEntry& entry = parts.coarse[grid.block_index(x, y, z)];
        const double centre = distance_m(grid.block_centre_O(x, y, z));
        if (std::fabs(centre) > reach) {
          entry.slot_and_flags = CoarseEntry::kNotStored | (centre < 0 ? CoarseEntry::kInside : 0);
          continue;
        }
        std::size_t i = 0;
        for (int cz = 0; cz < kBlockCorners; ++cz) {
          for (int cy = 0; cy < kBlockCorners; ++cy) {
            for (int cx = 0; cx < kBlockCorners; ++cx) {
              values[i++] = static_cast<float>(
                  distance_m(grid.corner_O(kBlockCells * x + cx, kBlockCells * y + cy, kBlockCells * z + cz)));
            }
          }
        }
        entry.slot_and_flags = static_cast<std::uint32_t>(parts.blocks.size());
        quantise(grid, values, parts.blocks.emplace_back());
      }
    }
  }
  finish(parts);
  return parts;
}

void save_field(const FieldParts& parts, const std::filesystem::path& path, std::uint64_t content_hash) {
  FieldFileInfo info{};
  for (int i = 0; i < 3; ++i) {
    info.min_m[i] = parts.grid.min_O[i];
    info.blocks[i] = parts.grid.blocks[static_cast<std::size_t>(i)];
  }
  info.voxel_m = parts.grid.voxel_m;
  info.band_m = parts.grid.band_m;
  info.stored = static_cast<std::uint32_t>(parts.blocks.size());
  const auto coarse = std::as_bytes(std::span(parts.coarse));
  const std::vector<std::byte> padding(field_coarse_bytes(parts.grid) - coarse.size());
  const std::span<const std::byte> payload[] = {std::as_bytes(std::span(&info, 1)), coarse, padding,
                                                std::as_bytes(std::span(parts.blocks))};
  write_sealed(path, kFieldKind, content_hash, payload);
}

DistanceField build_field(const Vec3& min_O, const Vec3& max_O, double voxel_m,
                          const std::function<double(const Vec3&)>& distance_m, double band_voxels) {
  return make_field(sample_distance(make_grid(min_O, max_O, voxel_m, band_voxels), distance_m));
}

}  // namespace tact
