// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "field/field_clearance.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstring>

#include "field/field_batch.hpp"
#include "field/field_clearance.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, 8>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;

/// Of the places of a chunk.
struct ClearanceScratch {
  alignas(64) float f[3][kBatchChunk];           ///< place in the cell
  alignas(64) float v[3][kBatchChunk];           ///< from the block's centre
  alignas(64) float out_square[kBatchChunk];     ///< squared distance to the grid
  alignas(64) float free[kBatchChunk];           ///< what the coarse entry promises where the field is positive
  alignas(64) std::int32_t index[kBatchChunk];   ///< of the coarse entry; of the nearest place inside
  alignas(64) std::int32_t corner[kBatchChunk];  ///< index of the cell's first corner in its block
  /// CoarseEntry as words: slot_and_flags; level; tilt x and y; tilt z and inverse_slope.
  alignas(64) std::int32_t flags[kBatchChunk], level[kBatchChunk], tilt_xy[kBatchChunk], tilt_z_slope[kBatchChunk];
  alignas(64) std::int32_t pair[4][kBatchChunk];  ///< corners at (y, z) = 00, 10, 01, 11, two along x as in memory
};

HWY_INLINE void find_cells(const BatchView& field, const CellPlaces& places, ClearanceScratch& s) {
  const F d;
  const I di;
  const float* from[3] = {places.x, places.y, places.z};
  const std::int32_t stride[3] = {1, field.row, field.slice};
  const std::int32_t step[3] = {1, kBlockCorners, kBlockCorners * kBlockCorners};
  for (std::size_t i = 0; i < places.size; i += hn::Lanes(d)) {
    VF out = hn::Zero(d);
    auto index = hn::Zero(di), corner = hn::Zero(di);
    for (int a = 0; a < 3; ++a) {
      const auto cells = static_cast<float>(field.cells[a]);
      const VF u = hn::LoadU(d, from[a] + i);
      const VF nearest = hn::Min(hn::Max(u, hn::Zero(d)), hn::Set(d, cells));
      const VF beyond = hn::Sub(u, nearest);
      out = hn::MulAdd(beyond, beyond, out);
      const auto cell = hn::Min(hn::ConvertTo(di, nearest), hn::Set(di, static_cast<std::int32_t>(cells) - 1));
      const auto block = hn::ShiftRight<3>(cell);
      hn::StoreU(hn::Sub(nearest, hn::ConvertTo(d, cell)), d, s.f[a] + i);
      const VF centre = hn::ConvertTo(d, hn::Add(hn::ShiftLeft<3>(block), hn::Set(di, kBlockCells / 2)));
      hn::StoreU(hn::Sub(nearest, centre), d, s.v[a] + i);
      index = hn::Add(index, hn::Mul(block, hn::Set(di, stride[a])));
      const auto in_block = hn::And(cell, hn::Set(di, kBlockCells - 1));
      corner = hn::Add(corner, hn::Mul(in_block, hn::Set(di, step[a])));
    }
    hn::StoreU(out, d, s.out_square + i);
    hn::StoreU(index, di, s.index + i);
    hn::StoreU(corner, di, s.corner + i);
  }
}

HWY_INLINE void read_entries(const BatchView& field, std::size_t count, ClearanceScratch& s) {
  for (std::size_t i = 0; i < count; ++i) {
    std::int32_t words[4];
    std::memcpy(words, field.coarse + s.index[i], sizeof words);
    s.flags[i] = words[0];
    s.level[i] = words[1];
    s.tilt_xy[i] = words[2];
    s.tilt_z_slope[i] = words[3];
  }
}

/// Sets free. Where the entry alone promises enough the flags become those of a block that is not stored.
HWY_INLINE void promise_alone(const BatchView& field, std::size_t count, const float* enough, ClearanceScratch& s) {
  const F d;
  const I di;
  const VF slack = hn::Set(d, static_cast<float>(field.far_slack_m / field.voxel_m));
  const auto high = hn::Set(di, static_cast<std::int32_t>(0xFFFF0000u));
  const auto positive = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kPositive));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto xy = hn::LoadU(di, s.tilt_xy + i), zs = hn::LoadU(di, s.tilt_z_slope + i);
    const VF tx = hn::BitCast(d, hn::ShiftLeft<16>(xy)), ty = hn::BitCast(d, hn::And(xy, high)),
             tz = hn::BitCast(d, hn::ShiftLeft<16>(zs));
    const VF vx = hn::LoadU(d, s.v[0] + i), vy = hn::LoadU(d, s.v[1] + i), vz = hn::LoadU(d, s.v[2] + i);
    // |v|^2 + tilt.v + level
    VF square = hn::MulAdd(vx, hn::Add(vx, tx), hn::BitCast(d, hn::LoadU(di, s.level + i)));
    square = hn::MulAdd(vy, hn::Add(vy, ty), square);
    square = hn::MulAdd(vz, hn::Add(vz, tz), square);
    const VF free = hn::Sub(hn::Sqrt(hn::Max(square, hn::Zero(d))), slack);
    hn::StoreU(free, d, s.free + i);
    const auto flags = hn::LoadU(di, s.flags + i);
    const auto known =
        hn::And(hn::RebindMask(d, hn::Eq(hn::And(flags, positive), positive)), hn::Gt(free, hn::LoadU(d, enough + i)));
    const auto not_stored = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kNotStored));
    hn::StoreU(hn::Or(flags, hn::IfThenElseZero(hn::RebindMask(di, known), not_stored)), di, s.flags + i);
  }
}

constexpr FieldBlock kNoBlock{};

/// Reads the corners of the places whose flags name a block; zeros for the others.
HWY_INLINE void read_corners(const BatchView& field, std::size_t count, ClearanceScratch& s) {
  constexpr std::size_t dy = kBlockCorners, dz = kBlockCorners * kBlockCorners;
  const std::int16_t* at[kBatchChunk];
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t slot = static_cast<std::uint32_t>(s.flags[i]) & CoarseEntry::kSlotMask;
    const FieldBlock* block = slot != CoarseEntry::kNotStored ? field.blocks + slot : &kNoBlock;
    at[i] = block->q.data() + s.corner[i];
    __builtin_prefetch(at[i]);
    __builtin_prefetch(at[i] + dz);
  }
  for (std::size_t i = 0; i < count; ++i) {
    std::memcpy(&s.pair[0][i], at[i], 4);
    std::memcpy(&s.pair[1][i], at[i] + dy, 4);
    std::memcpy(&s.pair[2][i], at[i] + dz, 4);
    std::memcpy(&s.pair[3][i], at[i] + dz + dy, 4);
  }
}

/// Between two corners along x, in steps.
HWY_INLINE VF along_x(const ClearanceScratch& s, std::size_t i, int k, VF fx) {
  const F d;
  const I di;
  const auto both = hn::LoadU(di, s.pair[k] + i);
  const VF low = hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(both)));
  const VF high = hn::ConvertTo(d, hn::ShiftRight<16>(both));
  return hn::MulAdd(fx, hn::Sub(high, low), low);
}

void clear_chunk(const BatchView& field, const CellPlaces& places, const float* enough, float* clearance) {
  ClearanceScratch s;
  find_cells(field, places, s);
  read_entries(field, places.size, s);
  promise_alone(field, places.size, enough, s);
  read_corners(field, places.size, s);
  const F d;
  const I di;
  const VF zero = hn::Zero(d), minus_band = hn::Set(d, static_cast<float>(-field.band_m / field.voxel_m));
  const VF step = hn::Set(d, static_cast<float>(field.scale_m / field.voxel_m));
  const VF face_slack = hn::Set(d, static_cast<float>(field.face_slack_m / field.voxel_m));
  const auto no_slot = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kNotStored));
  const auto inside_bit = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kInside));
  for (std::size_t i = 0; i < places.size; i += hn::Lanes(d)) {
    const VF free = hn::LoadU(d, s.free + i);
    const auto flags = hn::LoadU(di, s.flags + i);
    const auto far = hn::RebindMask(d, hn::Eq(hn::And(flags, no_slot), no_slot));
    const auto inside = hn::RebindMask(d, hn::Eq(hn::And(flags, inside_bit), inside_bit));
    VF clear = hn::IfThenElse(inside, minus_band, free);
    if (!hn::AllTrue(d, far)) {
      const VF fx = hn::LoadU(d, s.f[0] + i), fy = hn::LoadU(d, s.f[1] + i), fz = hn::LoadU(d, s.f[2] + i);
      const VF x00 = along_x(s, i, 0, fx), x10 = along_x(s, i, 1, fx);
      const VF x01 = along_x(s, i, 2, fx), x11 = along_x(s, i, 3, fx);
      const VF y0 = hn::MulAdd(fy, hn::Sub(x10, x00), x00), y1 = hn::MulAdd(fy, hn::Sub(x11, x01), x01);
      const VF value = hn::Mul(step, hn::MulAdd(fz, hn::Sub(y1, y0), y0));
      const auto zs = hn::LoadU(di, s.tilt_z_slope + i);
      const VF slope = hn::BitCast(d, hn::And(zs, hn::Set(di, static_cast<std::int32_t>(0xFFFF0000u))));
      const VF near = hn::Mul(hn::Sub(value, face_slack), slope);
      clear = hn::IfThenElse(far, clear, hn::IfThenElse(hn::Gt(value, zero), hn::Max(free, near), near));
    }
    const VF out_square = hn::LoadU(d, s.out_square + i);
    const auto outside = hn::Gt(out_square, zero);
    if (!hn::AllFalse(d, outside)) {
      const VF at_grid = hn::Max(clear, zero);
      clear = hn::IfThenElse(outside, hn::Sqrt(hn::MulAdd(at_grid, at_grid, out_square)), clear);
    }
    hn::StoreU(clear, d, clearance + i);
  }
}

}  // namespace tact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact {

HWY_EXPORT(clear_chunk);

void clearances(const DistanceField& field, const CellPlaces& places, const float* enough, float* clearance) noexcept {
  const BatchView view = BatchAccess::view(field);
  for (std::size_t k = 0; k < places.size; k += kBatchChunk) {
    const CellPlaces chunk{places.x + k, places.y + k, places.z + k, std::min(kBatchChunk, places.size - k)};
    HWY_DYNAMIC_DISPATCH(clear_chunk)(view, chunk, enough + k, clearance + k);
  }
}

}  // namespace tact
#endif  // HWY_ONCE
