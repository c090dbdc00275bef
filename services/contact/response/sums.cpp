// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/response/sums.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include <algorithm>
#include <cstring>

#include "contact/response/sums.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;
constexpr std::size_t kLanes = hn::MaxLanes(D());  // x86: the size of a vector is known
constexpr int kUpper = 21;                         // of a symmetric 6 x 6 matrix

/// Contacts from one on, as they lie in the buffer: vectors xyz xyz.
struct From {
  const double *r, *N, *g, *depth, *weight;
};

/// The sums, one behind the other; from kSome on of forces along N, which are few or none.
enum : std::size_t {
  kSs = 0,
  kElastic = kSs + kUpper,
  kLevers = kElastic + 6,
  kB = kLevers + 9,
  kSome = kB + kUpper,
  kShLessSs = kSome,
  kTurning = kShLessSs + 36,
  kAll = kTurning + 6
};

struct Lanes {
  V sum[kAll];

  HWY_INLINE void clear(std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) sum[n] = hn::Zero(D());
  }
};

struct Factors {
  double k, damping;
  const double* twist;
  bool along_normal;
};

/// out = (e, r x e)
HWY_INLINE void screw(const V* r, const V* e, V* out) {
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    out[a] = e[a];
    out[3 + a] = hn::MulSub(r[b], e[c], hn::Mul(r[c], e[b]));
  }
}

/// Adds one vector of contacts.
template <bool kDamped>
HWY_INLINE void add(const From& from, const Factors& factors, Lanes& sums, ContactSums& out) {
  const D d;
  V* HWY_RESTRICT sum = sums.sum;
  const V zero = hn::Zero(d);
  const V w = hn::LoadU(d, from.weight);
  const V spring = hn::Mul(hn::Set(d, factors.k), hn::LoadU(d, from.depth)), f = hn::Mul(spring, w);
  V r[3], g[3], s[6];
  hn::LoadInterleaved3(d, from.r, r[0], r[1], r[2]);
  hn::LoadInterleaved3(d, from.g, g[0], g[1], g[2]);
  screw(r, g, s);

  V along_g = f;  // f of forces along g
  auto along_N = hn::And(hn::And(hn::Eq(g[0], zero), hn::Eq(g[1], zero)), hn::Eq(g[2], zero));
  if (factors.along_normal) along_N = hn::Eq(zero, zero);
  if (!hn::AllFalse(d, along_N)) {
    if (!out.some_along_N) sums.clear(kSome, kAll);
    out.some_along_N = true;
    V N[3], other[6];
    hn::LoadInterleaved3(d, from.N, N[0], N[1], N[2]);
    screw(r, N, other);
    for (int a = 0; a < 6; ++a) {
      const V own = hn::IfThenElse(along_N, other[a], s[a]);
      other[a] = hn::Sub(s[a], own);  // sh - s
      s[a] = own;
    }
    along_g = hn::IfThenZeroElse(along_N, f);
    for (int a = 0; a < 6; ++a) {
      const V ws = hn::Mul(w, s[a]);
      for (int b = 0; b < 6; ++b) {
        V& to = sum[kShLessSs + static_cast<std::size_t>(6 * a + b)];
        to = hn::MulAdd(ws, other[b], to);
      }
      V& to = sum[kTurning + static_cast<std::size_t>(a)];
      to = hn::MulAdd(hn::Sub(f, along_g), s[a], to);
    }
  }

  V wb = zero;
  if constexpr (kDamped) {
    V speed = zero;
    for (int a = 0; a < 6; ++a) speed = hn::MulAdd(hn::Set(d, factors.twist[a]), s[a], speed);
    speed = hn::Abs(speed);
    const V whole = hn::Set(d, factors.damping);
    const auto limited = hn::Gt(hn::Mul(whole, speed), spring);
    out.capped = out.capped || !hn::AllFalse(d, limited);
    wb = hn::Mul(w, hn::IfThenElse(limited, hn::Div(spring, speed), whole));
  }
  std::size_t n = 0;
  for (std::size_t a = 0; a < 6; ++a) {
    const V ws = hn::Mul(w, s[a]), wbs = hn::Mul(wb, s[a]);
    for (std::size_t b = a; b < 6; ++b, ++n) {
      sum[kSs + n] = hn::MulAdd(ws, s[b], sum[kSs + n]);
      if constexpr (kDamped) sum[kB + n] = hn::MulAdd(wbs, s[b], sum[kB + n]);
    }
    sum[kElastic + a] = hn::MulAdd(f, s[a], sum[kElastic + a]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const V fr = hn::Mul(along_g, r[a]);
    for (std::size_t b = 0; b < 3; ++b) {
      sum[kLevers + 3 * a + b] = hn::MulAdd(fr, s[b], sum[kLevers + 3 * a + b]);
    }
  }
}

/// The last contacts, made a whole vector: behind them the last one again, of weight 0.
struct Tail {
  double r[3 * kLanes], N[3 * kLanes], g[3 * kLanes], depth[kLanes], weight[kLanes];

  From fill(const From& from, std::size_t count) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t j = std::min(i, count - 1);
      std::copy_n(from.r + 3 * j, 3, r + 3 * i);
      std::copy_n(from.N + 3 * j, 3, N + 3 * i);
      std::copy_n(from.g + 3 * j, 3, g + 3 * i);
      depth[i] = from.depth[j];
      weight[i] = i < count ? from.weight[j] : 0;
    }
    return {r, N, g, depth, weight};
  }
};

/// Adds up the lanes. A loop of its own: unrolled it would be most of the code of a tick, read once a tick.
HWY_NOINLINE void totals(const V* sums, std::size_t count, double* out) {
  for (std::size_t n = 0; n < count; ++n) out[n] = hn::GetLane(hn::SumOfLanes(D(), sums[n]));
}

HWY_INLINE void put_symmetric(const double* upper, Mat6& out) {
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b) out(a, b) = out(b, a) = *upper++;
  }
}

/// Row by row.
template <class Matrix>
HWY_INLINE void put(const double* sums, Matrix& out) {
  for (int a = 0; a < out.rows(); ++a) {
    for (int b = 0; b < out.cols(); ++b) out(a, b) = *sums++;
  }
}

template <bool kDamped>
HWY_INLINE void sum_all(From from, std::size_t size, const Factors& factors, ContactSums& out) {
  Lanes sums;
  sums.clear(0, kDamped ? kSome : kB);
  while (size > 0) {
    const std::size_t count = std::min(size, kLanes);
    Tail tail;
    add<kDamped>(count == kLanes ? from : tail.fill(from, count), factors, sums, out);
    from = {from.r + 3 * kLanes, from.N + 3 * kLanes, from.g + 3 * kLanes, from.depth + kLanes, from.weight + kLanes};
    size -= count;
  }
  double total[kAll];
  totals(sums.sum, out.some_along_N ? kAll : kDamped ? kSome : kB, total);
  put_symmetric(total + kSs, out.ss);
  put(total + kElastic, out.elastic);
  put(total + kLevers, out.levers);
  if constexpr (kDamped) {
    put_symmetric(total + kB, out.B);
  } else {
    out.B.setZero();
  }
  if (out.some_along_N) {
    put(total + kShLessSs, out.sh_less_ss);
    put(total + kTurning, out.turning);
  } else {
    out.sh_less_ss.setZero();
    out.turning.setZero();
  }
}

void sum(const ContactBuffer& contacts, double k, double damping, const Vec6& twist, ContactSums& out) {
  const From from{contacts.r.data()->data(), contacts.N.data()->data(), contacts.g.data()->data(),
                  contacts.depth_m.data(), contacts.weight.data()};
  const Factors factors{k, damping, twist.data(), contacts.force_along == ForceDirection::normal};
  if (damping > 0) {
    sum_all<true>(from, contacts.size, factors, out);
  } else {
    sum_all<false>(from, contacts.size, factors, out);
  }
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(sum);

static_assert(sizeof(Vec3) == 3 * sizeof(double));

ContactSums sum_contacts(const ContactBuffer& contacts, double k, double damping, const Vec6& twist) noexcept {
  ContactSums out;
  HWY_DYNAMIC_DISPATCH(sum)(contacts, k, damping, twist, out);
  return out;
}

}  // namespace tact::contact
#endif  // HWY_ONCE
