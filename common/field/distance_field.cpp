#include "field/distance_field.hpp"

#include <algorithm>
#include <cstring>

#include "fault/fault.hpp"
#include "field/field_builder.hpp"
#include "field/field_file.hpp"

namespace tact {

void DistanceField::adopt(const FieldGrid& grid, const CoarseEntry* coarse, const FieldBlock* blocks) noexcept {
  coarse_ = coarse;
  blocks_ = blocks;
  min_O_ = grid.min_O;
  cells_ = kBlockCells * Vec3(grid.blocks[0], grid.blocks[1], grid.blocks[2]);
  voxel_m_ = grid.voxel_m;
  inverse_voxel_ = 1 / grid.voxel_m;
  band_m_ = grid.band_m;
  scale_m_ = grid.range_m() / 32767;
  row_ = static_cast<std::size_t>(grid.blocks[0]);
  slice_ = row_ * static_cast<std::size_t>(grid.blocks[1]);
}

DistanceField DistanceField::open(const std::filesystem::path& path, std::uint64_t expected_hash, bool lock) {
  const SealedFile file = SealedFile::open(path, kFieldKind, expected_hash, lock);
  const auto bad = [&](const char* what) {
    return SetupError(path.string() + ": the distance field is inconsistent: " + what + ": delete it and bake again");
  };
  const auto payload = file.payload();
  FieldFileInfo info;
  if (payload.size() < sizeof(info)) throw bad("no grid");
  std::memcpy(&info, payload.data(), sizeof(info));
  FieldGrid grid;
  grid.min_O = Vec3(info.min_m[0], info.min_m[1], info.min_m[2]);
  grid.voxel_m = info.voxel_m;
  grid.band_m = info.band_m;
  for (int i = 0; i < 3; ++i) {
    if (info.blocks[i] < 1 || info.blocks[i] > kMostBlocksPerSide) throw bad("number of blocks");
    grid.blocks[static_cast<std::size_t>(i)] = info.blocks[i];
  }
  if (!(grid.voxel_m > 0) || !(grid.band_m > 0) || !std::isfinite(grid.range_m()) || !grid.min_O.allFinite()) {
    throw bad("voxel, band or corner");
  }
  const std::size_t coarse_bytes = field_coarse_bytes(grid);
  if (info.stored >= CoarseEntry::kNotStored ||
      payload.size() != sizeof(info) + coarse_bytes + info.stored * sizeof(FieldBlock)) {
    throw bad("sizes");
  }
  const auto* coarse = reinterpret_cast<const CoarseEntry*>(payload.data() + sizeof(info));
  const auto* blocks = reinterpret_cast<const FieldBlock*>(payload.data() + sizeof(info) + coarse_bytes);
  for (std::size_t i = 0; i < grid.block_count(); ++i) {
    if (coarse[i].stored() && coarse[i].slot() >= info.stored) throw bad("a block that is not there");
  }
  DistanceField field;
  field.adopt(grid, coarse, blocks);
  field.content_hash_ = file.content_hash();
  field.bytes_ = payload.size();
  field.owner_ = std::make_shared<SealedFile>(file);
  return field;
}

DistanceField view_field(const FieldParts& parts) {
  DistanceField field;
  field.adopt(parts.grid, parts.coarse.data(), parts.blocks.data());
  field.bytes_ = parts.coarse.size() * sizeof(CoarseEntry) + parts.blocks.size() * sizeof(FieldBlock);
  return field;
}

DistanceField make_field(FieldParts parts, std::uint64_t content_hash) {
  const auto owner = std::make_shared<const FieldParts>(std::move(parts));
  DistanceField field = view_field(*owner);
  field.content_hash_ = content_hash;
  field.owner_ = owner;
  return field;
}

namespace {
/// For a point outside the grid and any q inside it: |p - q|^2 >= |p - p'|^2 + |p' - q|^2, p' the nearest point of the
/// grid (a convex box). Combines the distance to the grid with a promise made at p'.
double beyond(double to_grid_m, double at_nearest_m) noexcept {
  return std::hypot(to_grid_m, std::max(0.0, at_nearest_m));
}

/// A hair inside the grid, so that the point has a cell.
Vec3 nearest_in_grid(const Vec3& p_O, const Vec3& min_O, const Vec3& max_O, double voxel_m) noexcept {
  const Vec3 inset = Vec3::Constant(1e-6 * voxel_m);
  return p_O.cwiseMax(min_O + inset).cwiseMin(max_O - inset);
}
}  // namespace

double DistanceField::outside_clearance(const Vec3& p_O) const noexcept {
  if (!p_O.allFinite()) return -band_m_;
  const Vec3 nearest = nearest_in_grid(p_O, min_O_, max_O(), voxel_m_);
  return beyond(std::max(0.0, (p_O - nearest).norm() - 1e-5 * voxel_m_), probe(nearest).clearance_m - 1e-5 * voxel_m_);
}

double DistanceField::lower_bound(const Vec3& p_O) const noexcept {
  const Cell c = find(p_O);
  if (c.entry == nullptr) {
    if (!p_O.allFinite()) return -band_m_;
    const Vec3 nearest = nearest_in_grid(p_O, min_O_, max_O(), voxel_m_);
    return beyond(std::max(0.0, (p_O - nearest).norm() - 1e-5 * voxel_m_), lower_bound(nearest) - 1e-5 * voxel_m_);
  }
  if (!c.entry->stored()) return c.entry->inside() ? -band_m_ : coarse_distance(c);
  // Corners are exact to half a step, and the distance is 1-Lipschitz: the mean of eight corners errs by at most
  // their mean distance, sqrt(3)/2 h.
  constexpr double kHalfDiagonal = 0.8661;
  const double value = probe(p_O).value_m - kHalfDiagonal * voxel_m_ - scale_m_;
  return std::min(value, coarse_distance(c));
}

}  // namespace tact
