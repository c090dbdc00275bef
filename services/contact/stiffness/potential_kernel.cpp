// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/stiffness/potential_kernel.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include <algorithm>
#include <utility>

#include "contact/stiffness/potential_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kRow = 8;
using D = hn::CappedTag<double, kRow>;
using V = hn::Vec<D>;

constexpr std::size_t kLanes = hn::MaxLanes(D());  // x86: the size of a vector is known
static_assert(kLanes <= ContactBuffer::kBeyond);
constexpr std::size_t kParts = kRow / kLanes;

/// A row in registers.
struct Row {
  explicit HWY_INLINE Row(const PotentialRow& from) {
    for (std::size_t k = 0; k < kParts; ++k) part[k] = hn::Load(D(), from.v + kLanes * k);
  }
  /// to += factor * this.
  HWY_INLINE void add(V factor, PotentialRow& to) const {
    for (std::size_t k = 0; k < kParts; ++k) {
      double* HWY_RESTRICT at = to.v + kLanes * k;
      hn::Store(hn::MulAdd(factor, part[k], hn::Load(D(), at)), D(), at);
    }
  }
  V part[kParts];
};

/// Contacts from one on, as they lie in the buffer: vectors xyz xyz.
struct From {
  const double *r, *N, *g, *depth, *gamma;
};

/// The last contacts, made a whole vector: behind them the last one again.
struct Tail {
  double r[3 * kLanes], N[3 * kLanes], g[3 * kLanes], depth[kLanes], gamma[kLanes];

  From fill(const From& from, std::size_t count) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t j = std::min(i, count - 1);
      std::copy_n(from.r + 3 * j, 3, r + 3 * i);
      std::copy_n(from.N + 3 * j, 3, N + 3 * i);
      std::copy_n(from.g + 3 * j, 3, g + 3 * i);
      depth[i] = from.depth[j];
      gamma[i] = from.gamma[j];
    }
    return {r, N, g, depth, gamma};
  }
};

/// What a vector of contacts adds to the rows of their groups, contact by contact: halves of rows.
struct Terms {
  alignas(64) double own[2][4 * kLanes], less[2][4 * kLanes], weight[kLanes];
};

/// x^n, n >= 0, by squaring.
HWY_INLINE V power(V x, int n) {
  V result = hn::Set(D(), 1.0);
  for (;; x = hn::Mul(x, x)) {
    if (n & 1) result = hn::Mul(result, x);
    n >>= 1;
    if (n == 0) return result;
  }
}

/// (first, y e, y r x e, 0) of a vector of contacts.
HWY_INLINE void put_rows(V first, V y, const V* r, const V* e, double (*out)[4 * kLanes]) {
  const D d;
  V s[6];
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    s[a] = hn::Mul(y, e[a]);
    s[3 + a] = hn::Mul(y, hn::MulSub(r[b], e[c], hn::Mul(r[c], e[b])));
  }
  hn::StoreInterleaved4(first, s[0], s[1], s[2], d, out[0]);
  hn::StoreInterleaved4(s[3], s[4], s[5], hn::Zero(d), d, out[1]);
}

/// True where a gradient vanishes: a force along N.
HWY_INLINE hn::Mask<D> vanishes(const V* g) {
  const V zero = hn::Zero(D());
  return hn::And(hn::And(hn::Eq(g[0], zero), hn::Eq(g[1], zero)), hn::Eq(g[2], zero));
}

/// Returns whether a force does not run along its gradient: only then `less` is written.
HWY_INLINE bool terms_of(const From& from, int p, double inverse_depth, bool along_normal, Terms& out) {
  const D d;
  const V gamma = hn::LoadU(d, from.gamma);
  const V rho = hn::Mul(hn::Mul(gamma, hn::Set(d, inverse_depth)), hn::LoadU(d, from.depth));
  const V bend = power(rho, p - 2), slope = hn::Mul(bend, rho), y = hn::Mul(gamma, slope);
  hn::Store(hn::Mul(hn::Mul(gamma, gamma), bend), d, out.weight);  // times the group's sum, later
  V r[3], g[3];
  hn::LoadInterleaved3(d, from.r, r[0], r[1], r[2]);
  hn::LoadInterleaved3(d, from.g, g[0], g[1], g[2]);
  const V zero = hn::Zero(d);
  const auto along_N = along_normal ? hn::Eq(zero, zero) : vanishes(g);
  if (hn::AllFalse(d, along_N)) {
    put_rows(hn::Mul(slope, rho), y, r, g, out.own);
    return false;
  }
  V N[3], e[3], difference[3];
  hn::LoadInterleaved3(d, from.N, N[0], N[1], N[2]);
  for (int a = 0; a < 3; ++a) {
    e[a] = hn::IfThenElse(along_N, N[a], g[a]);
    difference[a] = hn::Sub(e[a], g[a]);
  }
  put_rows(hn::Mul(slope, rho), y, r, e, out.own);
  put_rows(zero, y, r, difference, out.less);
  return true;
}

HWY_INLINE void add_half(const double* HWY_RESTRICT from, double* HWY_RESTRICT to) {
  const hn::CappedTag<double, 4> d;
  for (std::size_t k = 0; k < 4; k += hn::Lanes(d)) {
    hn::Store(hn::Add(hn::Load(d, to + k), hn::Load(d, from + k)), d, to + k);
  }
}

HWY_INLINE void clear(PotentialRow& row) {
  for (std::size_t k = 0; k < kRow; k += kLanes) hn::Store(hn::Zero(D()), D(), row.v + k);
}

/// Adds the contacts to their groups and begins the weights. Returns whether a group differs.
HWY_INLINE bool add_contacts(From from, int p, double inverse_depth, ContactBuffer& contacts,
                             PotentialWorkspace& work) {
  for (std::size_t g = 0; g < work.size; ++g) {
    clear(work.group[g].own);
    work.group[g].differs = false;
  }
  const bool along_normal = contacts.force_along == ForceDirection::normal;
  bool any = false;
  for (std::size_t begin = 0; begin < contacts.size; begin += kLanes) {
    const std::size_t count = std::min(kLanes, contacts.size - begin);
    Tail tail;
    Terms terms;
    const bool differs =
        terms_of(count == kLanes ? from : tail.fill(from, count), p, inverse_depth, along_normal, terms);
    hn::StoreU(hn::Load(D(), terms.weight), D(), contacts.weight.data() + begin);  // kBeyond
    for (std::size_t i = 0; i < count; ++i) {
      PotentialGroup& group = work.group[work.group_of[begin + i]];
      add_half(terms.own[0] + 4 * i, group.own.v);
      add_half(terms.own[1] + 4 * i, group.own.v + 4);
    }
    if (differs) {
      any = true;
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t g = work.group_of[begin + i];
        if (!std::exchange(work.group[g].differs, true)) clear(work.less_of[g]);
        add_half(terms.less[0] + 4 * i, work.less_of[g].v);
        add_half(terms.less[1] + 4 * i, work.less_of[g].v + 4);
      }
    }
    from = {from.r + 3 * kLanes, from.N + 3 * kLanes, from.g + 3 * kLanes, from.depth + kLanes, from.gamma + kLanes};
  }
  return any;
}

HWY_INLINE double largest(const double* depth, std::size_t count) {
  const D d;
  V most = hn::Zero(d);
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes) most = hn::Max(most, hn::LoadU(d, depth + i));
  double result = hn::GetLane(hn::MaxOfLanes(d, most));
  for (; i < count; ++i) result = std::max(result, depth[i]);
  return result;
}

/// Adds a group's row to the rows of the directions it reaches.
HWY_INLINE void scatter(const PotentialSupports& supports, PotentialSupport support, const PotentialRow& from,
                        PotentialRow* HWY_RESTRICT to) {
  const D d;
  const std::uint16_t* HWY_RESTRICT direction = supports.direction.data();
  const float* HWY_RESTRICT beta = supports.beta.data();
  const Row row(from);
  for (std::size_t e = support.begin; e < support.end; ++e) {
    row.add(hn::Set(d, static_cast<double>(beta[e])), to[direction[e]]);
  }
}

/// Lists the directions in use and what follows from their A. Returns how many there are.
HWY_INLINE std::size_t powers_of_a(int p, PotentialWorkspace& work) {
  const D d;
  constexpr double kSmallest = 1e-290;  // below this, A^(1/p - 1) times a moment could overflow
  std::size_t count = 0;
  for (std::size_t u = 0; u < work.own.size(); ++u) {
    const double A = work.own[u].v[0];
    work.active[count] = static_cast<std::uint32_t>(u);
    work.a[count] = A;
    work.slope[u] = 0;
    count += A > kSmallest ? 1 : 0;
  }
  const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
  std::fill(work.a.data() + count, work.a.data() + padded, 1.0);
  const V inverse_p = hn::Set(d, 1.0 / p);
  for (std::size_t k = 0; k < padded; k += kLanes) {
    const V A = hn::LoadU(d, work.a.data() + k), root = hn::Exp(d, hn::Mul(inverse_p, hn::Log(d, A)));
    const V scale = hn::Div(root, A);
    hn::StoreU(scale, d, work.scale.data() + k);
    hn::StoreU(hn::Mul(scale, root), d, work.a.data() + k);
  }
  for (std::size_t k = 0; k < count; ++k) work.slope[work.active[k]] = work.a[k];
  return count;
}

/// Multiplies the rows of the first `count` active directions by their scale.
HWY_INLINE void scale_rows(const PotentialWorkspace& work, std::size_t count, std::vector<PotentialRow>& rows) {
  const D d;
  for (std::size_t n = 0; n < count; ++n) {
    double* HWY_RESTRICT row = rows[work.active[n]].v;
    const V scale = hn::Set(d, work.scale[n]);
    for (std::size_t k = 0; k < kRow; k += kLanes) hn::Store(hn::Mul(scale, hn::Load(d, row + k)), d, row + k);
  }
}

/// out(a, b) = sum_u own_u[a + 1] right_u[b + 1], of scaled rows.
HWY_NOINLINE void outer_products(const PotentialWorkspace& work, std::size_t count,
                                 const std::vector<PotentialRow>& right_rows, Mat6& out) {
  const D d;
  alignas(64) double sums[6][kRow];
  for (std::size_t k = 0; k < kRow; k += hn::Lanes(d)) {
    V s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0;
    for (std::size_t n = 0; n < count; ++n) {
      const std::size_t u = work.active[n];
      const double* HWY_RESTRICT left = work.own[u].v + 1;
      const V right = hn::Load(d, right_rows[u].v + k);
      s0 = hn::MulAdd(hn::Set(d, left[0]), right, s0);
      s1 = hn::MulAdd(hn::Set(d, left[1]), right, s1);
      s2 = hn::MulAdd(hn::Set(d, left[2]), right, s2);
      s3 = hn::MulAdd(hn::Set(d, left[3]), right, s3);
      s4 = hn::MulAdd(hn::Set(d, left[4]), right, s4);
      s5 = hn::MulAdd(hn::Set(d, left[5]), right, s5);
    }
    const V all[6] = {s0, s1, s2, s3, s4, s5};
    for (std::size_t a = 0; a < 6; ++a) hn::Store(all[a], d, sums[a] + k);
  }
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) out(a, b) = sums[a][b + 1];
  }
}

/// sum[g] = sum_u beta slope_u. Four sums, so that additions do not wait for each other.
HWY_INLINE void gather(const PotentialSupports& supports, PotentialWorkspace& work) {
  const std::uint16_t* HWY_RESTRICT direction = supports.direction.data();
  const float* HWY_RESTRICT beta = supports.beta.data();
  const double* HWY_RESTRICT slope = work.slope.data();
  for (std::size_t g = 0; g < work.size; ++g) {
    const PotentialSupport s = work.group[g].support;
    const auto term = [&](std::size_t e) { return static_cast<double>(beta[e]) * slope[direction[e]]; };
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    std::size_t e = s.begin;
    for (; e + 4 <= s.end; e += 4) {
      s0 += term(e);
      s1 += term(e + 1);
      s2 += term(e + 2);
      s3 += term(e + 3);
    }
    for (; e < s.end; ++e) s0 += term(e);
    work.sum[g] = (s0 + s1) + (s2 + s3);
  }
}

void run(const PotentialSupports& supports, int p, ContactBuffer& contacts, PotentialWorkspace& work) {
  const From from{contacts.r.data()->data(), contacts.N.data()->data(), contacts.g.data()->data(),
                  contacts.depth_m.data(), work.gamma.data()};
  const double deepest = largest(contacts.depth_m.data(), contacts.size), inverse = deepest > 0 ? 1 / deepest : 0;
  const bool differs = add_contacts(from, p, inverse, contacts, work);
  for (PotentialRow& row : work.own) clear(row);
  for (std::size_t g = 0; g < work.size; ++g) {
    scatter(supports, work.group[g].support, work.group[g].own, work.own.data());
  }
  const std::size_t active = powers_of_a(p, work);
  scale_rows(work, active, work.own);
  outer_products(work, active, work.own, work.ss);
  work.sh = work.ss;
  if (differs) {
    for (PotentialRow& row : work.less) clear(row);
    for (std::size_t g = 0; g < work.size; ++g) {
      if (work.group[g].differs) scatter(supports, work.group[g].support, work.less_of[g], work.less.data());
    }
    scale_rows(work, active, work.less);
    Mat6 less;
    outer_products(work, active, work.less, less);
    work.sh -= less;
  }
  gather(supports, work);
  for (std::size_t i = 0; i < contacts.size; ++i) contacts.weight[i] *= work.sum[work.group_of[i]];
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(run);

namespace {

std::size_t whole_vectors(std::size_t n) { return (n + 7) / 8 * 8; }

}  // namespace

PotentialWorkspace::PotentialWorkspace(std::size_t capacity, std::size_t groups, std::size_t directions)
    : group_of(capacity),
      gamma(capacity),
      group(groups),
      less_of(groups),
      own(directions),
      less(directions),
      slope(directions),
      active(directions + 1),
      a(whole_vectors(directions + 1)),
      scale(whole_vectors(directions + 1)),
      sum(groups) {
  ss.setZero();
  sh.setZero();
}

void run_potential(const PotentialSupports& supports, int p, ContactBuffer& contacts,
                   PotentialWorkspace& work) noexcept {
  HWY_DYNAMIC_DISPATCH(run)(supports, p, contacts, work);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
