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
  if (info.stored > kMostStoredBlocks ||
      payload.size() != sizeof(info) + coarse_bytes + info.stored * sizeof(FieldBlock)) {
    throw bad("sizes");
  }
  const auto* coarse = reinterpret_cast<const CoarseEntry*>(payload.data() + sizeof(info));
  const auto* blocks = reinterpret_cast<const FieldBlock*>(payload.data() + sizeof(info) + coarse_bytes);
  for (std::size_t i = 0; i < grid.block_count(); ++i) {
    const CoarseEntry& entry = coarse[i];
    if (entry.stored() && entry.slot() >= info.stored) throw bad("a block that is not there");
    const float slope = entry.inverse_slope.value();
    if (!std::isfinite(entry.level) || !std::isfinite(entry.tilt[0].value() + entry.tilt[1].value()) ||
        !std::isfinite(entry.tilt[2].value()) || !(slope >= 0 && slope <= 1)) {
      throw bad("a promise of distance that is none");
    }
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

/// For a point p outside the grid, p' the nearest point of the grid (a convex box) and any q inside it:
/// |p - q|^2 >= |p - p'|^2 + |p' - q|^2. Combines the distance to the grid with what `promise` says at p'.
template <class Promise>
double DistanceField::beyond(const Vec3& u, Promise promise) const noexcept {
  if (!(std::fabs(u.x()) + std::fabs(u.y()) + std::fabs(u.z()) < kFarthest)) return -band_m_;  // NaN too
  const Vec3 nearest = u.cwiseMax(kInset).cwiseMin((cells_.array() - kInset).matrix());
  double square = 0;
  for (int i = 0; i < 3; ++i) square += (u[i] - nearest[i]) * (u[i] - nearest[i]);
  const double slack_m = kInsetSlack * voxel_m_;
  const double a = std::max(0.0, voxel_m_ * std::sqrt(square) - slack_m),
               b = std::max(0.0, promise(cell_at(nearest)) - slack_m);
  return std::sqrt(a * a + b * b);
}

double DistanceField::outside_clearance(const Vec3& u) const noexcept {
  return beyond(u, [this](const Cell& c) { return probe_cell(c).clearance_m; });
}

double DistanceField::lower_bound(const Vec3& p_O) const noexcept {
  const Cell c = find(p_O);
  return c.entry != nullptr ? lower_bound(c) : beyond(c.u, [this](const Cell& at) { return lower_bound(at); });
}

double DistanceField::lower_bound(const Cell& c) const noexcept {
  if (!c.entry->stored()) return c.entry->inside() ? -band_m_ : boundary_bound(c);
  // Corners are exact to half a step, and the distance is 1-Lipschitz: the mean of eight corners errs by at most
  // their mean distance, sqrt(3)/2 h.
  constexpr double kHalfDiagonal = 0.8661;
  const double value = probe_cell(c).value_m - kHalfDiagonal * voxel_m_ - scale_m_;
  return c.entry->inverse_slope.value() > 0 ? value : std::min(value, 0.0);  // the sign may be wrong near jumps
}

}  // namespace tact
