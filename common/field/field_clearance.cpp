// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "field/field_clearance.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "field/field_batch.hpp"
#include "field/field_clearance.hpp"
#include "field/field_reads-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, kPlacesAtOnce>;
using I = hn::RebindToSigned<F>;
using VF = hn::Vec<F>;
using VI = hn::Vec<I>;

/// Of the places of a chunk.
struct ClearanceScratch {
  alignas(64) float v[3][kBatchChunk];          ///< from the block's centre
  alignas(64) float out_square[kBatchChunk];    ///< squared distance to the grid
  alignas(64) float free[kBatchChunk];          ///< what the coarse entry promises where the field is positive
  alignas(64) std::int32_t index[kBatchChunk];  ///< of the coarse entry; of the nearest place inside
  alignas(64) std::int32_t flags[kBatchChunk], slope[kBatchChunk];
  alignas(64) std::int32_t part[kBatchChunk];  ///< number of the part of a block; any where none is stored
};

/// From a part of a block to that of the next block.
constexpr std::int32_t kPartsApart = sizeof(FieldBlock) / sizeof(PartBound);

HWY_INLINE void find_cells(const ClearanceView& field, const CellPlaces& places, ClearanceScratch& s) {
  const F d;
  const I di;
  const float* from[3] = {places.x, places.y, places.z};
  const VI row = hn::Set(di, field.row), slice = hn::Set(di, field.slice);
  for (std::size_t i = 0; i < places.size; i += hn::Lanes(d)) {
    VF out = hn::Zero(d);
    VI block[3];
    for (int a = 0; a < 3; ++a) {
      const VF u = hn::LoadU(d, from[a] + i), cells = hn::Set(d, field.cells[a]);
      const VF nearest = hn::Min(hn::Max(u, hn::Zero(d)), cells);
      const VF beyond = hn::Sub(u, nearest);
      out = hn::MulAdd(beyond, beyond, out);
      const VI cell = hn::ConvertTo(di, hn::Min(nearest, hn::Sub(cells, hn::Set(d, 1.0f))));
      block[a] = hn::ShiftRight<3>(cell);
      const VI middle = hn::Add(hn::ShiftLeft<3>(block[a]), hn::Set(di, kBlockCells / 2));
      hn::Store(hn::Sub(nearest, hn::ConvertTo(d, middle)), d, s.v[a] + i);
    }
    hn::Store(out, d, s.out_square + i);
    const VI index = hn::Add(hn::Add(hn::Mul(block[2], slice), hn::Mul(block[1], row)), block[0]);
    hn::Store(index, di, s.index + i);
  }
}

/// Sets free. Where the entry alone promises enough the flags become those of a block that is not stored.
HWY_INLINE void promise_alone(const ClearanceView& field, std::size_t count, const float* enough, ClearanceScratch& s) {
  const F d;
  const I di;
  const VF slack = hn::Set(d, field.far_slack);
  const VI high = hn::Set(di, static_cast<std::int32_t>(0xFFFF0000u));
  const VI positive = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kPositive));
  const VI not_stored = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kNotStored));
  const VI slot_mask = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kSlotMask));
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    VI flags, level, xy, zs;  // tilt x and y; tilt z and inverse_slope
    transpose_rows(
        di, [&](std::size_t k) { return entry_row(field.coarse[s.index[i + k]]); }, flags, level, xy, zs);
    const VF tx = hn::BitCast(d, hn::ShiftLeft<16>(xy)), ty = hn::BitCast(d, hn::And(xy, high)),
             tz = hn::BitCast(d, hn::ShiftLeft<16>(zs));
    const VF vx = hn::Load(d, s.v[0] + i), vy = hn::Load(d, s.v[1] + i), vz = hn::Load(d, s.v[2] + i);
    // |v|^2 + tilt.v + level
    VF square = hn::MulAdd(vx, hn::Add(vx, tx), hn::BitCast(d, level));
    square = hn::MulAdd(vy, hn::Add(vy, ty), square);
    square = hn::MulAdd(vz, hn::Add(vz, tz), square);
    const VF free = hn::Sub(hn::Sqrt(hn::Max(square, hn::Zero(d))), slack);
    hn::Store(free, d, s.free + i);
    const auto known = hn::And(hn::RebindMask(d, hn::TestBit(flags, positive)), hn::Gt(free, hn::LoadU(d, enough + i)));
    flags = hn::Or(flags, hn::IfThenElseZero(hn::RebindMask(di, known), not_stored));
    const VI slot = hn::And(flags, slot_mask);
    const auto upper = [&](VF v, int part) {
      return hn::IfThenElseZero(hn::RebindMask(di, hn::Ge(v, hn::Zero(d))), hn::Set(di, part));
    };
    const VI part = hn::Or(hn::Or(upper(vx, 1), upper(vy, 2)), upper(vz, 4));
    hn::Store(flags, di, s.flags + i);
    hn::Store(hn::And(zs, high), di, s.slope + i);
    // Without a block: the first part of all, if any.
    const VI number = hn::Add(hn::Mul(slot, hn::Set(di, kPartsApart)), part);
    hn::Store(hn::IfThenZeroElse(hn::Eq(slot, not_stored), number), di, s.part + i);
  }
}

/// From the middle of the part.
HWY_INLINE VF in_part(VF v) { return hn::Sub(v, hn::CopySign(hn::Set(F(), kPartCells / 2.0f), v)); }

/// The halves of words as numbers.
HWY_INLINE VF low_half(VI words) { return hn::ConvertTo(F(), hn::ShiftRight<16>(hn::ShiftLeft<16>(words))); }
HWY_INLINE VF high_half(VI words) { return hn::ConvertTo(F(), hn::ShiftRight<16>(words)); }

void clear_chunk(const ClearanceView& field, const CellPlaces& places, const float* enough, float* clearance) {
  ClearanceScratch s;
  find_cells(field, places, s);
  promise_alone(field, places.size, enough, s);
  const F d;
  const I di;
  const VF zero = hn::Zero(d), minus_band = hn::Set(d, -field.band), step = hn::Set(d, field.step),
           face_slack = hn::Set(d, field.face_slack);
  const VI no_slot = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kNotStored));
  const VI inside_bit = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kInside));
  // Where no place needs a block there may be none at all.
  auto far = hn::Eq(no_slot, no_slot);
  for (std::size_t i = 0; i < places.size; i += hn::Lanes(d)) {
    far = hn::And(far, hn::Eq(hn::And(hn::Load(di, s.flags + i), no_slot), no_slot));
  }
  const bool all_far = hn::AllTrue(di, far);
  for (std::size_t i = 0; i < places.size; i += hn::Lanes(d)) {
    const VF free = hn::Load(d, s.free + i);
    const VI flags = hn::Load(di, s.flags + i);
    VF clear = hn::IfThenElse(hn::RebindMask(d, hn::TestBit(flags, inside_bit)), minus_band, free);
    if (!all_far) {
      VI level_x, y_z;
      transpose_pairs(di, field.parts, s.part + i, level_x, y_z);
      VF bound = hn::MulAdd(high_half(level_x), in_part(hn::Load(d, s.v[0] + i)), low_half(level_x));
      bound = hn::MulAdd(low_half(y_z), in_part(hn::Load(d, s.v[1] + i)), bound);
      bound = hn::MulAdd(high_half(y_z), in_part(hn::Load(d, s.v[2] + i)), bound);
      const VF value = hn::Mul(step, bound);  // not less is the field there
      const VF slope = hn::BitCast(d, hn::Load(di, s.slope + i));
      const VF near = hn::Mul(hn::Sub(value, face_slack), slope);
      const auto stored = hn::RebindMask(d, hn::Ne(hn::And(flags, no_slot), no_slot));
      clear = hn::IfThenElse(stored, hn::IfThenElse(hn::Gt(value, zero), hn::Max(free, near), near), clear);
    }
    const VF out_square = hn::Load(d, s.out_square + i);
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

ClearanceView::ClearanceView(const DistanceField& field) noexcept {
  const BatchView view = BatchAccess::view(field);
  coarse = view.coarse;
  parts =
      reinterpret_cast<const PartBound*>(reinterpret_cast<const std::byte*>(view.blocks) + offsetof(FieldBlock, part));
  for (int a = 0; a < 3; ++a) cells[a] = static_cast<float>(view.cells[a]);
  row = view.row, slice = view.slice;
  band = static_cast<float>(view.band_m / view.voxel_m);
  step = static_cast<float>(view.scale_m / view.voxel_m);
  face_slack = static_cast<float>(view.face_slack_m / view.voxel_m);
  far_slack = static_cast<float>(view.far_slack_m / view.voxel_m);
}

void clearances(const ClearanceView& field, const CellPlaces& places, const float* enough, float* clearance) noexcept {
  for (std::size_t k = 0; k < places.size; k += kBatchChunk) {
    const CellPlaces chunk{places.x + k, places.y + k, places.z + k, std::min(kBatchChunk, places.size - k)};
    HWY_DYNAMIC_DISPATCH(clear_chunk)(field, chunk, enough + k, clearance + k);
  }
}

}  // namespace tact
#endif  // HWY_ONCE
