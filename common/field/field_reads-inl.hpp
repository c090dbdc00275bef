// Reads of a field that the batch kernels share: compiled once for each instruction set.
#if defined(TACT_FIELD_READS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef TACT_FIELD_READS_INL_HPP
#undef TACT_FIELD_READS_INL_HPP
#else
#define TACT_FIELD_READS_INL_HPP
#endif
#include <hwy/highway.h>

#include <cstring>

#include "field/field_blocks.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
/// Four words.
struct FieldRow {
  std::int32_t word[4];
};
#else
using FieldRow = hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::CappedTag<std::int32_t, 4>>;
#endif

/// A coarse entry: slot_and_flags; level; tilt x and y; tilt z and inverse_slope.
HWY_INLINE FieldRow entry_row(const CoarseEntry& entry) {
#if HWY_TARGET == HWY_SCALAR
  FieldRow row;
  std::memcpy(row.word, &entry, sizeof row.word);
  return row;
#else
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<std::int32_t, 4> d;
  return hn::BitCast(
      d, hn::LoadU(hn::Repartition<std::uint8_t, decltype(d)>(), reinterpret_cast<const std::uint8_t*>(&entry)));
#endif
}

/// The corners of a cell, at (y, z) = 00, 10, 01, 11 two along x, as in memory. `q`: the first of them.
HWY_INLINE FieldRow corner_row(const std::int16_t* q) {
  constexpr int dy = FieldBlock::index(0, 1, 0), dz = FieldBlock::index(0, 0, 1);
#if HWY_TARGET == HWY_SCALAR
  FieldRow row;
  std::memcpy(row.word, q, 4);
  std::memcpy(row.word + 1, q + dy, 4);
  std::memcpy(row.word + 2, q + dz, 4);
  std::memcpy(row.word + 3, q + dy + dz, 4);
  return row;
#else
  namespace hn = hwy::HWY_NAMESPACE;
  const hn::CappedTag<std::int32_t, 4> d;
  const hn::Repartition<std::int16_t, decltype(d)> d16;
  const hn::Repartition<std::int64_t, decltype(d)> d64;
  // Whole vectors are read: the padding of a block is as long.
  static_assert(FieldBlock::index(kBlockCells - 1, kBlockCells, kBlockCells) + 8 <= sizeof(FieldBlock) / 2);
  const auto y0z0 = hn::BitCast(d, hn::LoadU(d16, q)), y1z0 = hn::BitCast(d, hn::LoadU(d16, q + dy));
  const auto y0z1 = hn::BitCast(d, hn::LoadU(d16, q + dz)), y1z1 = hn::BitCast(d, hn::LoadU(d16, q + dy + dz));
  const auto z0 = hn::BitCast(d64, hn::InterleaveLower(d, y0z0, y1z0));
  const auto z1 = hn::BitCast(d64, hn::InterleaveLower(d, y0z1, y1z1));
  return hn::BitCast(d, hn::InterleaveLower(d64, z0, z1));
#endif
}

/// The two words of each lane as two vectors, in registers too. `index`: of the lanes, in `from`.
template <class DI, class V = hwy::HWY_NAMESPACE::Vec<DI>>
HWY_INLINE void transpose_pairs(DI d, const PartBound* from, const std::int32_t* index, V& v0, V& v1) {
  namespace hn = hwy::HWY_NAMESPACE;
  constexpr std::size_t kLanes = hn::MaxLanes(DI());  // x86: the size of a vector is known
  static_assert(sizeof(PartBound) == 8);
  if constexpr (kLanes < 4) {
    std::int32_t first[kLanes], second[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) {
      std::int32_t words[2];
      std::memcpy(words, from + index[k], sizeof words);
      first[k] = words[0], second[k] = words[1];
    }
    v0 = hn::LoadU(d, first), v1 = hn::LoadU(d, second);
  } else {
#if HWY_TARGET != HWY_SCALAR
    const hn::Repartition<std::uint64_t, DI> d64;
    const hn::CappedTag<std::uint64_t, 2> d2;
    const hn::CappedTag<std::uint64_t, 1> d1;
    const auto one = [&](std::size_t k) {
      std::uint64_t words;
      std::memcpy(&words, from + index[k], sizeof words);
      return hn::Set(d1, words);
    };
    // Lanes k, k + 2 and, four by four, those behind.
    const auto blocks = [&](std::size_t k) {
      const auto low = hn::Combine(d2, one(k + 2), one(k));
      if constexpr (kLanes == 4) {
        return low;
      } else {
        const hn::CappedTag<std::uint64_t, 4> d4;
        const auto two = hn::Combine(d4, hn::Combine(d2, one(k + 6), one(k + 4)), low);
        if constexpr (kLanes == 8) {
          return two;
        } else {
          const auto high =
              hn::Combine(d4, hn::Combine(d2, one(k + 14), one(k + 12)), hn::Combine(d2, one(k + 10), one(k + 8)));
          return hn::Combine(d64, high, two);
        }
      }
    };
    const auto even = blocks(0), odd = blocks(1);
    v0 = hn::OddEven(hn::BitCast(d, hn::ShiftLeft<32>(odd)), hn::BitCast(d, even));
    v1 = hn::OddEven(hn::BitCast(d, odd), hn::BitCast(d, hn::ShiftRight<32>(even)));
#endif
  }
}

/// The four words of each lane's row as four vectors. In registers: what is stored in parts and read back whole has to
/// wait for the stores. row(lane) gives a row.
template <class DI, class Row, class V = hwy::HWY_NAMESPACE::Vec<DI>>
HWY_INLINE void transpose_rows(DI d, Row row, V& v0, V& v1, V& v2, V& v3) {
  namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_SCALAR
  const FieldRow r = row(std::size_t{0});
  v0 = hn::Set(d, r.word[0]), v1 = hn::Set(d, r.word[1]), v2 = hn::Set(d, r.word[2]), v3 = hn::Set(d, r.word[3]);
#else
  constexpr std::size_t kLanes = hn::MaxLanes(DI());  // x86: the size of a vector is known
  if constexpr (kLanes < 4) {
    const hn::CappedTag<std::int32_t, 4> d4;
    alignas(16) std::int32_t words[4 * kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) hn::Store(row(k), d4, words + 4 * k);
    hn::LoadInterleaved4(d, words, v0, v1, v2, v3);
  } else {
    const hn::Repartition<std::int64_t, DI> d64;
    // Lanes k, k + 4, k + 8, ..., a block of four words each.
    const auto blocks = [&](std::size_t k) {
      if constexpr (kLanes == 4) {
        return row(k);
      } else {
        const hn::CappedTag<std::int32_t, 8> d8;
        const auto low = hn::Combine(d8, row(k + 4), row(k));
        if constexpr (kLanes == 8) {
          return low;
        } else {
          return hn::Combine(d, hn::Combine(d8, row(k + 12), row(k + 8)), low);
        }
      }
    };
    const V a = blocks(0), b = blocks(1), c = blocks(2), e = blocks(3);
    const auto ab_low = hn::BitCast(d64, hn::InterleaveLower(d, a, b));
    const auto ab_high = hn::BitCast(d64, hn::InterleaveUpper(d, a, b));
    const auto ce_low = hn::BitCast(d64, hn::InterleaveLower(d, c, e));
    const auto ce_high = hn::BitCast(d64, hn::InterleaveUpper(d, c, e));
    v0 = hn::BitCast(d, hn::InterleaveLower(d64, ab_low, ce_low));
    v1 = hn::BitCast(d, hn::InterleaveUpper(d64, ab_low, ce_low));
    v2 = hn::BitCast(d, hn::InterleaveLower(d64, ab_high, ce_high));
    v3 = hn::BitCast(d, hn::InterleaveUpper(d64, ab_high, ce_high));
  }
#endif
}

}  // namespace tact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // TACT_FIELD_READS_INL_HPP
