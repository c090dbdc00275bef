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

struct Lanes {
  V ss[kUpper], B[kUpper], elastic[6], levers[9], sh_less_ss[36], turning[6];
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
        sums.sh_less_ss[6 * a + b] = hn::MulAdd(ws, other[b], sums.sh_less_ss[6 * a + b]);
      }
      sums.turning[a] = hn::MulAdd(hn::Sub(f, along_g), s[a], sums.turning[a]);
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
  int n = 0;
  for (int a = 0; a < 6; ++a) {
    const V ws = hn::Mul(w, s[a]), wbs = hn::Mul(wb, s[a]);
    for (int b = a; b < 6; ++b, ++n) {
      sums.ss[n] = hn::MulAdd(ws, s[b], sums.ss[n]);
      if constexpr (kDamped) sums.B[n] = hn::MulAdd(wbs, s[b], sums.B[n]);
    }
    sums.elastic[a] = hn::MulAdd(f, s[a], sums.elastic[a]);
  }
  for (int a = 0; a < 3; ++a) {
    const V fr = hn::Mul(along_g, r[a]);
    for (int b = 0; b < 3; ++b) sums.levers[3 * a + b] = hn::MulAdd(fr, s[b], sums.levers[3 * a + b]);
  }
}

/// The last contacts, made a whole vector: behind them the last one again, of weight 0.
struct Tail {
  double r[3 * kLanes], N[3 * kLanes], g[3 * kLanes], depth[kLanes], weight[kLanes];

  Tail(const From& from, std::size_t count) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t j = std::min(i, count - 1);
      std::copy_n(from.r + 3 * j, 3, r + 3 * i);
      std::copy_n(from.N + 3 * j, 3, N + 3 * i);
      std::copy_n(from.g + 3 * j, 3, g + 3 * i);
      depth[i] = from.depth[j];
      weight[i] = i < count ? from.weight[j] : 0;
    }
  }
  From from() const { return {r, N, g, depth, weight}; }
};

HWY_INLINE double total(V v) { return hn::GetLane(hn::SumOfLanes(D(), v)); }

HWY_INLINE void put_symmetric(const V* upper, Mat6& out) {
  int n = 0;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b, ++n) out(a, b) = out(b, a) = total(upper[n]);
  }
}

/// Row by row.
template <class Matrix>
HWY_INLINE void put(const V* sums, Matrix& out) {
  for (int a = 0; a < out.rows(); ++a) {
    for (int b = 0; b < out.cols(); ++b) out(a, b) = total(sums[a * out.cols() + b]);
  }
}

template <bool kDamped>
HWY_INLINE void sum_all(From from, std::size_t size, const Factors& factors, ContactSums& out) {
  Lanes sums;
  std::memset(&sums, 0, sizeof(sums));
  for (; size >= kLanes; size -= kLanes) {
    add<kDamped>(from, factors, sums, out);
    from = {from.r + 3 * kLanes, from.N + 3 * kLanes, from.g + 3 * kLanes, from.depth + kLanes, from.weight + kLanes};
  }
  if (size > 0) {
    const Tail tail(from, size);
    add<kDamped>(tail.from(), factors, sums, out);
  }
  put_symmetric(sums.ss, out.ss);
  if constexpr (kDamped) {
    put_symmetric(sums.B, out.B);
  } else {
    out.B.setZero();
  }
  put(sums.elastic, out.elastic);
  put(sums.levers, out.levers);
  if (out.some_along_N) {
    put(sums.sh_less_ss, out.sh_less_ss);
    put(sums.turning, out.turning);
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
