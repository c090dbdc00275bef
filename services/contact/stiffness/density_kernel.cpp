// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/stiffness/density_kernel.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

#include "contact/stiffness/density_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kBlock = DensityWork::kBlock;
using D = hn::CappedTag<double, kBlock>;
using V = hn::Vec<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());  // x86: the size of a vector is known

/// Level 0 are the blocks; a node of a level is eight of the level below. The highest level has eight nodes or fewer.
struct Tree {
  static constexpr std::size_t kMostLevels = 21;  // 64 bits, three a level
  DensityWork& w;
  std::size_t padded;                                  // size in whole blocks
  std::size_t begin[kMostLevels], nodes[kMostLevels];  // of a level, in lo and hi
  std::size_t levels = 0;

  explicit Tree(DensityWork& work) : w(work) {
    padded = (w.size + kBlock - 1) / kBlock * kBlock;
    for (std::size_t i = w.size; i < padded; ++i) {  // the last again, counted 0 times
      w.x[i] = w.x[w.size - 1], w.y[i] = w.y[w.size - 1], w.z[i] = w.z[w.size - 1];
      w.count[i] = 0;
    }
    const double* const v[3] = {w.x.data(), w.y.data(), w.z.data()};
    const double *lo[3] = {v[0], v[1], v[2]}, *hi[3] = {v[0], v[1], v[2]};
    std::size_t at = 0;
    for (std::size_t n = padded / kBlock;; n = (n + kBlock - 1) / kBlock) {
      begin[levels] = at;
      nodes[levels++] = n;
      for (std::size_t k = 0; k < 3; ++k) {
        bound(n, lo[k], hi[k], w.lo[k].data() + at, w.hi[k].data() + at);
        lo[k] = w.lo[k].data() + at;
        hi[k] = w.hi[k].data() + at;
      }
      at += (n + kBlock - 1) / kBlock * kBlock;
      if (n <= kBlock) break;
    }
  }

  /// Boxes round eight boxes each; what fills the last eight up is nowhere.
  HWY_INLINE static void bound(std::size_t n, const double* lo, const double* hi, double* out_lo, double* out_hi) {
    const D d;
    std::size_t i = 0;
    for (; i < n; ++i, lo += kBlock, hi += kBlock) {
      V least = hn::LoadU(d, lo), most = hn::LoadU(d, hi);
      for (std::size_t k = kLanes; k < kBlock; k += kLanes) {
        least = hn::Min(least, hn::LoadU(d, lo + k));
        most = hn::Max(most, hn::LoadU(d, hi + k));
      }
      out_lo[i] = hn::GetLane(hn::MinOfLanes(d, least));
      out_hi[i] = hn::GetLane(hn::MaxOfLanes(d, most));
    }
    for (; i % kBlock != 0; ++i) {
      out_lo[i] = std::numeric_limits<double>::infinity();
      out_hi[i] = -out_lo[i];
    }
  }

  struct Range {
    std::size_t begin, end;
  };
  /// What a node holds.
  Range range(std::size_t level, std::size_t node) const {
    const std::size_t shift = 3 * (level + 1);
    return {node << shift, std::min((node + 1) << shift, padded)};
  }

  struct Vectors {
    V x, y, z;
  };
  HWY_INLINE Vectors load(std::size_t i) const {
    return {hn::LoadU(D(), w.x.data() + i), hn::LoadU(D(), w.y.data() + i), hn::LoadU(D(), w.z.data() + i)};
  }
  HWY_INLINE Vectors broadcast(std::size_t i) const {
    return {hn::Set(D(), w.x[i]), hn::Set(D(), w.y[i]), hn::Set(D(), w.z[i])};
  }
  HWY_INLINE static Vectors minus(const Vectors& a, const Vectors& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
  }
  HWY_INLINE void add_to_phi(std::size_t i, V phi) const {
    hn::StoreU(hn::Add(hn::LoadU(D(), w.phi.data() + i), phi), D(), w.phi.data() + i);
  }

  /// sum_j count_j (1 - |a - b_j|^2) for every a of `to`, over all b_j of `from`.
  HWY_NOINLINE void add_moments(Range from, Range to) {
    const D d;
    const Vectors centre = broadcast(from.begin);
    V count = hn::Zero(d), b2 = count;
    Vectors b{count, count, count};
    for (std::size_t j = from.begin; j < from.end; j += kLanes) {
      const V n = hn::LoadU(d, w.count.data() + j);
      const Vectors v = minus(load(j), centre);
      const V x = hn::Mul(n, v.x), y = hn::Mul(n, v.y), z = hn::Mul(n, v.z);
      count = hn::Add(count, n);
      b = {hn::Add(b.x, x), hn::Add(b.y, y), hn::Add(b.z, z)};
      b2 = hn::MulAdd(x, v.x, hn::MulAdd(y, v.y, hn::MulAdd(z, v.z, b2)));
    }
    count = hn::SumOfLanes(d, count);
    b = {hn::SumOfLanes(d, b.x), hn::SumOfLanes(d, b.y), hn::SumOfLanes(d, b.z)};
    const V two = hn::Set(d, 2.0), own = hn::Sub(count, hn::SumOfLanes(d, b2));
    for (std::size_t i = to.begin; i < to.end; i += kLanes) {
      const Vectors v = minus(load(i), centre);
      const V along = hn::MulAdd(b.x, v.x, hn::MulAdd(b.y, v.y, hn::Mul(b.z, v.z)));
      const V length2 = hn::MulAdd(v.x, v.x, hn::MulAdd(v.y, v.y, hn::Mul(v.z, v.z)));
      add_to_phi(i, hn::MulAdd(two, along, hn::NegMulAdd(count, length2, own)));
    }
  }

  /// sum + count_j hat(a, b_j) for a vector of a.
  HWY_INLINE V add_hat(const Vectors& a, std::size_t j, V sum) const {
    const D d;
    const Vectors v = minus(a, broadcast(j));
    V hat = hn::NegMulAdd(v.x, v.x, hn::Set(d, 1.0));
    hat = hn::NegMulAdd(v.y, v.y, hat);
    hat = hn::Max(hn::NegMulAdd(v.z, v.z, hat), hn::Zero(d));
    return hn::MulAdd(hat, hn::Set(d, w.count[j]), sum);
  }

  /// Two blocks, pair by pair: some are farther apart than 1 and add nothing.
  HWY_INLINE void add_pairs(std::size_t a, std::size_t b) const {
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
      const Vectors va = load(a + i), vb = load(b + i);
      V phi_a = hn::Zero(D()), phi_b = phi_a;
      for (std::size_t j = 0; j < kBlock; ++j) {
        phi_a = add_hat(va, b + j, phi_a);
        if (a != b) phi_b = add_hat(vb, a + j, phi_b);
      }
      add_to_phi(a + i, phi_a);
      add_to_phi(b + i, phi_b);
    }
  }

  /// Which of eight boxes lie within 1, a bit each.
  struct Met {
    std::uint32_t somewhere, everywhere;
  };
  HWY_INLINE Met meet(std::size_t a, std::size_t b) const {
    const D d;
    const V zero = hn::Zero(d), limit = hn::Set(d, 1.0);
    Met met{0, 0};
    for (std::size_t i = 0; i < kBlock; i += kLanes) {
      V gap2 = zero, span2 = zero;  // between the nearest places of two boxes, and the farthest
      for (std::size_t k = 0; k < 3; ++k) {
        const V ab = hn::Sub(hn::Set(d, w.lo[k][a]), hn::LoadU(d, w.hi[k].data() + b + i)),
                ba = hn::Sub(hn::LoadU(d, w.lo[k].data() + b + i), hn::Set(d, w.hi[k][a]));
        const V gap = hn::Max(hn::Max(ab, ba), zero), span = hn::Min(ab, ba);
        gap2 = hn::MulAdd(gap, gap, gap2);
        span2 = hn::MulAdd(span, span, span2);
      }
      std::uint8_t near[8] = {}, full[8] = {};
      hn::StoreMaskBits(d, hn::Lt(gap2, limit), near);
      hn::StoreMaskBits(d, hn::Le(span2, limit), full);
      met.somewhere |= static_cast<std::uint32_t>(near[0]) << i;
      met.everywhere |= static_cast<std::uint32_t>(full[0]) << i;
    }
    return met;
  }

  /// Meetings of nodes of a level, the children of a with those of b >= a of the level above.
  void visit(std::size_t level, std::size_t a, std::size_t b) {
    const std::size_t end = std::min(kBlock * (a + 1), nodes[level]);
    for (std::size_t i = kBlock * a; i < end; ++i) {
      const Met met = meet(begin[level] + i, begin[level] + kBlock * b);
      std::uint32_t bits = met.somewhere;
      if (a == b) bits &= ~0u << (i % kBlock);
      for (; bits != 0; bits &= bits - 1) {
        const std::size_t k = static_cast<std::size_t>(std::countr_zero(bits)), j = kBlock * b + k;
        if (level == 0) {
          add_pairs(kBlock * i, kBlock * j);
        } else if ((met.everywhere >> k) & 1) {
          const Range ri = range(level, i), rj = range(level, j);
          add_moments(ri, rj);
          if (i != j) add_moments(rj, ri);
        } else {
          visit(level - 1, i, j);
        }
      }
    }
  }
};

void sum(DensityWork& work) {
  if (work.size == 0) return;
  Tree tree(work);
  tree.visit(tree.levels - 1, 0, 0);
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(sum);

DensityWork::DensityWork(std::size_t capacity) {
  std::size_t n = (capacity + kBlock - 1) / kBlock, boxes = 0;
  for (auto* array : {&x, &y, &z, &count, &phi}) array->resize(kBlock * n);
  do {
    const std::size_t up = (n + kBlock - 1) / kBlock;
    boxes += kBlock * up;
    n = up;
  } while (n > 1);
  for (std::size_t k = 0; k < 3; ++k) lo[k].resize(boxes), hi[k].resize(boxes);
}

void sum_density(DensityWork& work) noexcept { HWY_DYNAMIC_DISPATCH(sum)(work); }

}  // namespace tact::contact
#endif  // HWY_ONCE
