// Compiled once for each instruction set (Highway's foreach_target), chosen at run time. Without fused multiply-add:
// the same operations in the same order as the inline functions of distance_field.hpp, so the same bits.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "field/field_batch.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <cstring>

#include "field/field_batch.hpp"
#include "field/field_reads-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
using I = hn::Rebind<std::int32_t, D>;

/// Of the points of a chunk.
struct Scratch {
  alignas(64) double f[3][kBatchChunk];          ///< place in the cell
  alignas(64) double v[3][kBatchChunk];          ///< from the block's centre, in cells
  alignas(64) double out_square[kBatchChunk];    ///< squared distance to the grid, in cells; 0: inside; -1: not finite
  alignas(64) double free[kBatchChunk];          ///< what the coarse entry promises where the field is positive, m
  alignas(64) double slope[kBatchChunk];         ///< CoarseEntry::inverse_slope
  alignas(64) std::int32_t index[kBatchChunk];   ///< of the coarse entry; of the nearest point inside
  alignas(64) std::int32_t corner[kBatchChunk];  ///< index of the cell's first corner in its block
  alignas(64) std::int32_t flags[kBatchChunk];
  alignas(64) std::int32_t slot[kBatchChunk];  ///< of the block to read; any where none is
};

/// Where the points are in the grid.
HWY_INLINE void locate(const BatchView& field, const DistanceField::Points& points, Scratch& s) {
  const D d;
  const I di;
  const V zero = hn::Zero(d), half = hn::Set(d, 0.5), eight = hn::Set(d, kBlockCells);
  const V inverse = hn::Set(d, field.inverse_voxel);
  const auto seven = hn::Set(di, kBlockCells - 1), nine = hn::Set(di, kBlockCorners);
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(d)) {
    V ux = hn::Mul(hn::Sub(hn::LoadU(d, points.x_O + i), hn::Set(d, field.min_O[0])), inverse);
    V uy = hn::Mul(hn::Sub(hn::LoadU(d, points.y_O + i), hn::Set(d, field.min_O[1])), inverse);
    V uz = hn::Mul(hn::Sub(hn::LoadU(d, points.z_O + i), hn::Set(d, field.min_O[2])), inverse);
    const auto x_in = hn::And(hn::Ge(ux, zero), hn::Lt(ux, hn::Set(d, field.cells[0])));
    const auto y_in = hn::And(hn::Ge(uy, zero), hn::Lt(uy, hn::Set(d, field.cells[1])));
    const auto z_in = hn::And(hn::Ge(uz, zero), hn::Lt(uz, hn::Set(d, field.cells[2])));
    const auto in = hn::And(x_in, hn::And(y_in, z_in));
    V out_square = zero;
    if (!hn::AllTrue(d, in)) {
      const V inset = hn::Set(d, field.inset);
      const V nx = hn::Min(hn::Max(ux, inset), hn::Sub(hn::Set(d, field.cells[0]), inset));
      const V ny = hn::Min(hn::Max(uy, inset), hn::Sub(hn::Set(d, field.cells[1]), inset));
      const V nz = hn::Min(hn::Max(uz, inset), hn::Sub(hn::Set(d, field.cells[2]), inset));
      const V ox = hn::Sub(ux, nx), oy = hn::Sub(uy, ny), oz = hn::Sub(uz, nz);
      const V square = hn::Add(hn::Add(hn::Mul(ox, ox), hn::Mul(oy, oy)), hn::Mul(oz, oz));
      const V size = hn::Add(hn::Add(hn::Abs(ux), hn::Abs(uy)), hn::Abs(uz));
      const auto finite = hn::Lt(size, hn::Set(d, field.farthest));
      out_square = hn::IfThenElse(in, zero, hn::IfThenElse(finite, square, hn::Set(d, -1.0)));
      ux = hn::IfThenElse(in, ux, hn::IfThenElseZero(finite, nx));
      uy = hn::IfThenElse(in, uy, hn::IfThenElseZero(finite, ny));
      uz = hn::IfThenElse(in, uz, hn::IfThenElseZero(finite, nz));
    }
    hn::StoreU(out_square, d, s.out_square + i);
    const auto wx = hn::DemoteTo(di, ux), wy = hn::DemoteTo(di, uy), wz = hn::DemoteTo(di, uz);
    hn::StoreU(hn::Sub(ux, hn::PromoteTo(d, wx)), d, s.f[0] + i);
    hn::StoreU(hn::Sub(uy, hn::PromoteTo(d, wy)), d, s.f[1] + i);
    hn::StoreU(hn::Sub(uz, hn::PromoteTo(d, wz)), d, s.f[2] + i);
    const auto bx = hn::ShiftRight<3>(wx), by = hn::ShiftRight<3>(wy), bz = hn::ShiftRight<3>(wz);
    hn::StoreU(hn::Sub(ux, hn::Mul(hn::Add(hn::PromoteTo(d, bx), half), eight)), d, s.v[0] + i);
    hn::StoreU(hn::Sub(uy, hn::Mul(hn::Add(hn::PromoteTo(d, by), half), eight)), d, s.v[1] + i);
    hn::StoreU(hn::Sub(uz, hn::Mul(hn::Add(hn::PromoteTo(d, bz), half), eight)), d, s.v[2] + i);
    const auto index = hn::Add(hn::Add(hn::Mul(bz, hn::Set(di, field.slice)), hn::Mul(by, hn::Set(di, field.row))), bx);
    hn::StoreU(index, di, s.index + i);
    const auto zy = hn::Add(hn::Mul(hn::And(wz, seven), nine), hn::And(wy, seven));
    hn::StoreU(hn::Add(hn::Mul(zy, nine), hn::And(wx, seven)), di, s.corner + i);
  }
}

/// Sets the slots. False: no point is in a stored block, and there may be none at all.
HWY_INLINE bool find_slots(std::size_t count, Scratch& s) {
  const I di;
  const auto no_slot = hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kNotStored));
  auto far = hn::Eq(no_slot, no_slot);
  for (std::size_t i = 0; i < count; i += hn::Lanes(di)) {
    const auto slot = hn::And(hn::LoadU(di, s.flags + i), no_slot);
    const auto none = hn::Eq(slot, no_slot);
    hn::StoreU(hn::IfThenZeroElse(none, slot), di, s.slot + i);
    far = hn::And(far, none);
  }
  return !hn::AllTrue(di, far);
}

/// 0 for a stored block, else 1 outside the body and -1 inside.
HWY_INLINE V far_sign(const Scratch& s, std::size_t i) {
  const D d;
  const I di;
  const auto flags = hn::LoadU(di, s.flags + i);
  const V slot = hn::PromoteTo(d, hn::And(flags, hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kSlotMask))));
  const V inside = hn::PromoteTo(d, hn::And(flags, hn::Set(di, static_cast<std::int32_t>(CoarseEntry::kInside))));
  const V sign = hn::IfThenElse(hn::Eq(inside, hn::Zero(d)), hn::Set(d, 1.0), hn::Set(d, -1.0));
  return hn::IfThenElseZero(hn::Eq(slot, hn::Set(d, static_cast<double>(CoarseEntry::kNotStored))), sign);
}

/// Sets flags, free and slope.
HWY_INLINE void promise(const BatchView& field, std::size_t count, Scratch& s) {
  const D d;
  const I di;
  const hn::Rebind<float, D> single;
  const auto high = hn::Set(di, static_cast<std::int32_t>(0xFFFF0000u));
  const V zero = hn::Zero(d), voxel = hn::Set(d, field.voxel_m), slack = hn::Set(d, field.far_slack_m);
  const auto wide = [&](auto bits) { return hn::PromoteTo(d, hn::BitCast(single, bits)); };
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<I> flags, bits, xy, zs;  // level; tilt x and y; tilt z and inverse_slope
    transpose_rows(
        di, [&](std::size_t k) { return entry_row(field.coarse[s.index[i + k]]); }, flags, bits, xy, zs);
    hn::StoreU(flags, di, s.flags + i);
    const V level = wide(bits);
    const V tx = wide(hn::ShiftLeft<16>(xy)), ty = wide(hn::And(xy, high)), tz = wide(hn::ShiftLeft<16>(zs));
    const V vx = hn::LoadU(d, s.v[0] + i), vy = hn::LoadU(d, s.v[1] + i), vz = hn::LoadU(d, s.v[2] + i);
    const V tilted = hn::Add(hn::Add(hn::Mul(tx, vx), hn::Mul(ty, vy)), hn::Mul(tz, vz));
    const V square =
        hn::Add(hn::Add(hn::Add(hn::Add(hn::Mul(vx, vx), hn::Mul(vy, vy)), hn::Mul(vz, vz)), level), tilted);
    const V free = hn::Sub(hn::Mul(voxel, hn::Sqrt(hn::Max(square, zero))), slack);
    hn::StoreU(free, d, s.free + i);
    hn::StoreU(wide(hn::And(zs, high)), d, s.slope + i);
  }
}

/// Values at the eight corners, x fastest. Of points that are in no stored block: any.
HWY_INLINE void corners(const BatchView& field, const Scratch& s, std::size_t i, V* v) {
  const D d;
  const I di;
  const V scale = hn::Set(d, field.scale_m);
  hn::Vec<I> pair[4];
  const auto row = [&](std::size_t k) { return corner_row(field.blocks[s.slot[i + k]].q.data() + s.corner[i + k]); };
  transpose_rows(di, row, pair[0], pair[1], pair[2], pair[3]);
  for (int k = 0; k < 4; ++k) {
    v[2 * k] = hn::Mul(scale, hn::PromoteTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(pair[k]))));
    v[2 * k + 1] = hn::Mul(scale, hn::PromoteTo(d, hn::ShiftRight<16>(pair[k])));
  }
}

HWY_INLINE V mean(V a, V weight_a, V b, V weight_b) { return hn::Add(hn::Mul(a, weight_a), hn::Mul(b, weight_b)); }

/// @pre points.size is a multiple of 8, as in sample_chunk
void probe_chunk(const BatchView& field, const DistanceField::Points& points, double* value_m, double* clearance_m) {
  Scratch s;
  locate(field, points, s);
  promise(field, points.size, s);
  find_slots(points.size, s);
  const D d;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0), band = hn::Set(d, field.band_m),
          minus_band = hn::Set(d, -field.band_m);
  const V face_slack = hn::Set(d, field.face_slack_m), voxel = hn::Set(d, field.voxel_m);
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(d)) {
    const V free = hn::LoadU(d, s.free + i), far = far_sign(s, i);
    V value = hn::Mul(far, band), clearance = hn::IfThenElse(hn::Gt(far, zero), free, minus_band);
    const auto stored = hn::Eq(far, zero);
    if (!hn::AllFalse(d, stored)) {
      const V fx = hn::LoadU(d, s.f[0] + i), fy = hn::LoadU(d, s.f[1] + i), fz = hn::LoadU(d, s.f[2] + i);
      const V ex = hn::Sub(one, fx), ey = hn::Sub(one, fy), ez = hn::Sub(one, fz);
      V v[8];
      corners(field, s, i, v);
      const V y0 = mean(mean(v[0], ex, v[1], fx), ey, mean(v[2], ex, v[3], fx), fy);
      const V y1 = mean(mean(v[4], ex, v[5], fx), ey, mean(v[6], ex, v[7], fx), fy);
      const V whole = mean(y0, ez, y1, fz);
      const V near = hn::Mul(hn::Sub(whole, face_slack), hn::LoadU(d, s.slope + i));
      const auto use_free = hn::And(hn::Gt(whole, zero), hn::Gt(free, near));
      value = hn::IfThenElse(stored, hn::Min(hn::Max(whole, minus_band), band), value);
      clearance = hn::IfThenElse(stored, hn::IfThenElse(use_free, free, near), clearance);
    }
    const V out_square = hn::LoadU(d, s.out_square + i);
    const auto inside = hn::Eq(out_square, zero);
    if (!hn::AllTrue(d, inside)) {
      const V inset_slack = hn::Set(d, field.inset_slack_m);
      const V a = hn::Max(zero, hn::Sub(hn::Mul(voxel, hn::Sqrt(out_square)), inset_slack));
      const V b = hn::Max(zero, hn::Sub(clearance, inset_slack));
      const V far_off = hn::Sqrt(hn::Add(hn::Mul(a, a), hn::Mul(b, b)));
      const auto finite = hn::Gt(out_square, zero);
      value = hn::IfThenElse(inside, value, band);
      clearance = hn::IfThenElse(inside, clearance, hn::IfThenElse(finite, far_off, minus_band));
    }
    hn::StoreU(value, d, value_m + i);
    hn::StoreU(clearance, d, clearance_m + i);
  }
}

void sample_chunk(const BatchView& field, const DistanceField::Points& points, const DistanceField::Samples& out) {
  Scratch s;
  locate(field, points, s);
  for (std::size_t i = 0; i < points.size; ++i) {
    s.flags[i] = static_cast<std::int32_t>(field.coarse[s.index[i]].slot_and_flags);
  }
  const bool some_stored = find_slots(points.size, s);
  const D d;
  const I di;
  const V zero = hn::Zero(d), one = hn::Set(d, 1.0), band = hn::Set(d, field.band_m);
  const V inverse = hn::Set(d, field.inverse_voxel);
  for (std::size_t i = 0; i < points.size; i += hn::Lanes(d)) {
    const V fx = hn::LoadU(d, s.f[0] + i), fy = hn::LoadU(d, s.f[1] + i), fz = hn::LoadU(d, s.f[2] + i);
    const V ex = hn::Sub(one, fx), ey = hn::Sub(one, fy), ez = hn::Sub(one, fz);
    V v[8] = {zero, zero, zero, zero, zero, zero, zero, zero};
    if (some_stored) corners(field, s, i, v);
    const V x00 = mean(v[0], ex, v[1], fx), x10 = mean(v[2], ex, v[3], fx);
    const V x01 = mean(v[4], ex, v[5], fx), x11 = mean(v[6], ex, v[7], fx);
    const V y0 = mean(x00, ey, x10, fy), y1 = mean(x01, ey, x11, fy);
    const V value = mean(y0, ez, y1, fz);
    const V gx = mean(mean(hn::Sub(v[1], v[0]), ey, hn::Sub(v[3], v[2]), fy), ez,
                      mean(hn::Sub(v[5], v[4]), ey, hn::Sub(v[7], v[6]), fy), fz);
    const V gy = mean(hn::Sub(x10, x00), ez, hn::Sub(x11, x01), fz);
    const auto inside = hn::Eq(hn::LoadU(d, s.out_square + i), zero);
    const V far = hn::IfThenElse(inside, far_sign(s, i), one);
    const auto in_band = hn::And(hn::Eq(far, zero), hn::Le(hn::Abs(value), band));
    const V clamped = hn::IfThenElse(hn::Eq(far, zero), hn::CopySign(band, value), hn::Mul(far, band));
    hn::StoreU(hn::IfThenElse(in_band, value, clamped), d, out.value_m + i);
    hn::StoreU(hn::IfThenElseZero(in_band, hn::Mul(inverse, gx)), d, out.gx + i);
    hn::StoreU(hn::IfThenElseZero(in_band, hn::Mul(inverse, gy)), d, out.gy + i);
    hn::StoreU(hn::IfThenElseZero(in_band, hn::Mul(inverse, hn::Sub(y1, y0))), d, out.gz + i);
    const V known = hn::IfThenElseZero(in_band, hn::Set(d, static_cast<double>(DistanceField::kInBand)));
    const V doubt = hn::IfThenElseZero(inside, hn::Set(d, static_cast<double>(DistanceField::kDoubtful)));
    const auto negative = hn::BroadcastSignBit(hn::LoadU(di, s.flags + i));  // CoarseEntry::kDoubtful
    hn::StoreU(hn::Or(hn::DemoteTo(di, known), hn::And(negative, hn::DemoteTo(di, doubt))), di, s.index + i);
  }
  for (std::size_t i = 0; i < points.size; ++i) out.flags[i] = static_cast<std::uint8_t>(s.index[i]);
}

}  // namespace tact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact {

HWY_EXPORT(probe_chunk);
HWY_EXPORT(sample_chunk);

namespace {

/// A chunk of fewer points than whole vectors: with room to read and write beyond them.
struct Padded {
  double x[kBatchChunk], y[kBatchChunk], z[kBatchChunk];
  std::size_t size;

  explicit Padded(const DistanceField::Points& points) {
    std::memcpy(x, points.x_O, points.size * sizeof(double));
    std::memcpy(y, points.y_O, points.size * sizeof(double));
    std::memcpy(z, points.z_O, points.size * sizeof(double));
    for (size = points.size; size % 8 != 0; ++size) x[size] = y[size] = z[size] = 0;
  }
  DistanceField::Points points() const { return {x, y, z, size}; }
};

DistanceField::Points part(const DistanceField::Points& all, std::size_t begin) {
  return {all.x_O + begin, all.y_O + begin, all.z_O + begin, std::min(kBatchChunk, all.size - begin)};
}

}  // namespace

void DistanceField::probe(const Points& points, double* value_m, double* clearance_m) const noexcept {
  const BatchView view = BatchAccess::view(*this);
  for (std::size_t begin = 0; begin < points.size; begin += kBatchChunk) {
    const Points chunk = part(points, begin);
    if (chunk.size % 8 == 0) {
      HWY_DYNAMIC_DISPATCH(probe_chunk)(view, chunk, value_m + begin, clearance_m + begin);
    } else {
      double value[kBatchChunk], clearance[kBatchChunk];
      HWY_DYNAMIC_DISPATCH(probe_chunk)(view, Padded(chunk).points(), value, clearance);
      std::memcpy(value_m + begin, value, chunk.size * sizeof(double));
      std::memcpy(clearance_m + begin, clearance, chunk.size * sizeof(double));
    }
  }
}

void DistanceField::sample(const Points& points, const Samples& samples) const noexcept {
  const BatchView view = BatchAccess::view(*this);
  for (std::size_t begin = 0; begin < points.size; begin += kBatchChunk) {
    const Points chunk = part(points, begin);
    if (chunk.size % 8 == 0) {
      HWY_DYNAMIC_DISPATCH(sample_chunk)
      (view, chunk,
       {samples.value_m + begin, samples.gx + begin, samples.gy + begin, samples.gz + begin, samples.flags + begin});
    } else {
      double value[kBatchChunk], gx[kBatchChunk], gy[kBatchChunk], gz[kBatchChunk];
      std::uint8_t flags[kBatchChunk];
      HWY_DYNAMIC_DISPATCH(sample_chunk)(view, Padded(chunk).points(), {value, gx, gy, gz, flags});
      std::memcpy(samples.value_m + begin, value, chunk.size * sizeof(double));
      std::memcpy(samples.gx + begin, gx, chunk.size * sizeof(double));
      std::memcpy(samples.gy + begin, gy, chunk.size * sizeof(double));
      std::memcpy(samples.gz + begin, gz, chunk.size * sizeof(double));
      std::memcpy(samples.flags + begin, flags, chunk.size);
    }
  }
}

}  // namespace tact
#endif  // HWY_ONCE
