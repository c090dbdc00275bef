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

#include "contact/stiffness/potential_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t kRow = 8;
using D = hn::CappedTag<double, kRow>;
using V = hn::Vec<D>;

constexpr std::size_t kLanes = hn::MaxLanes(D());  // x86: the size of a vector is known
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

/// Adds every group to the rows of the directions it reaches.
template <bool kSymmetric>
HWY_INLINE void scatter(const PotentialSupports& supports, PotentialWorkspace& work) {
  const D d;
  const std::uint16_t* HWY_RESTRICT direction = supports.direction.data();
  const float* HWY_RESTRICT beta = supports.beta.data();
  PotentialRow* HWY_RESTRICT own = work.own.data();
  PotentialRow* HWY_RESTRICT other = work.other.data();
  const PotentialGroup* HWY_RESTRICT groups = work.group.data();
  for (std::size_t g = 0; g < work.size; ++g) {
    const Row group_own(groups[g].own), group_other(groups[g].other);
    for (std::size_t e = groups[g].support.begin, end = groups[g].support.end; e < end; ++e) {
      const V factor = hn::Set(d, static_cast<double>(beta[e]));
      group_own.add(factor, own[direction[e]]);
      if constexpr (!kSymmetric) group_other.add(factor, other[direction[e]]);
    }
  }
}

/// A^(1/p). @pre A > 0
HWY_INLINE V root(int p, V A) {
  const D d;
  if ((p & (p - 1)) != 0) return hn::Exp(d, hn::Mul(hn::Set(d, 1.0 / p), hn::Log(d, A)));
  for (; p > 1; p /= 2) A = hn::Sqrt(A);
  return A;
}

/// scale = A^(1/p - 1), slope = A^(2/p - 1), both 0 where A is.
HWY_INLINE void powers_of_a(int p, PotentialWorkspace& work) {
  const D d;
  const V smallest = hn::Set(d, 1e-290);  // below this, A^(1/p - 1) times a moment could overflow
  for (std::size_t u = 0; u < work.own.size(); ++u) work.a[u] = work.own[u].v[0];
  for (std::size_t u = 0; u < work.a.size(); u += hn::Lanes(d)) {
    const V A = hn::LoadU(d, work.a.data() + u), some = hn::Max(A, smallest), power = root(p, some);
    const V scale = hn::IfThenElseZero(hn::Gt(A, smallest), hn::Div(power, some));
    hn::StoreU(scale, d, work.scale.data() + u);
    hn::StoreU(hn::Mul(scale, power), d, work.slope.data() + u);
  }
}

/// out(a, b) = sum_u scale_u^2 own_u[a + 1] right_u[b + 1].
HWY_INLINE void outer_products(const PotentialWorkspace& work, const std::vector<PotentialRow>& right_rows, Mat6& out) {
  const D d;
  PotentialRow sums[6];
  for (std::size_t k = 0; k < kRow; k += hn::Lanes(d)) {
    V s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0;
    for (std::size_t u = 0; u < work.own.size(); ++u) {
      const double* HWY_RESTRICT left = work.own[u].v + 1;
      const double scale = work.scale[u];
      const V right = hn::Mul(hn::Set(d, scale), hn::Load(d, right_rows[u].v + k));
      s0 = hn::MulAdd(hn::Set(d, scale * left[0]), right, s0);
      s1 = hn::MulAdd(hn::Set(d, scale * left[1]), right, s1);
      s2 = hn::MulAdd(hn::Set(d, scale * left[2]), right, s2);
      s3 = hn::MulAdd(hn::Set(d, scale * left[3]), right, s3);
      s4 = hn::MulAdd(hn::Set(d, scale * left[4]), right, s4);
      s5 = hn::MulAdd(hn::Set(d, scale * left[5]), right, s5);
    }
    const V all[6] = {s0, s1, s2, s3, s4, s5};
    for (std::size_t a = 0; a < 6; ++a) hn::Store(all[a], d, sums[a].v + k);
  }
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 6; ++b) out(a, b) = sums[a].v[b + 1];
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

void run(const PotentialSupports& supports, int p, PotentialWorkspace& work) {
  std::fill(work.own.begin(), work.own.end(), PotentialRow());
  if (work.symmetric) {
    scatter<true>(supports, work);
  } else {
    std::fill(work.other.begin(), work.other.end(), PotentialRow());
    scatter<false>(supports, work);
  }
  powers_of_a(p, work);
  outer_products(work, work.own, work.ss);
  if (work.symmetric) {
    work.sh = work.ss;
  } else {
    outer_products(work, work.other, work.sh);
  }
  gather(supports, work);
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(run);

namespace {

std::size_t whole_vectors(std::size_t n) { return (n + 7) / 8 * 8; }

}  // namespace

PotentialWorkspace::PotentialWorkspace(std::size_t capacity, std::size_t directions)
    : group(capacity),
      own(directions),
      other(directions),
      a(whole_vectors(directions)),
      scale(whole_vectors(directions)),
      slope(whole_vectors(directions)),
      sum(capacity) {
  ss.setZero();
  sh.setZero();
}

void run_potential(const PotentialSupports& supports, int p, PotentialWorkspace& work) noexcept {
  HWY_DYNAMIC_DISPATCH(run)(supports, p, work);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
