// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/stiffness/potential_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>

#include "contact/stiffness/potential_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, PotentialDirections::kPadding>;
using V = hn::Vec<D>;

/// t^q by squaring.
HWY_INLINE V power(V t, int q) {
  V result = (q & 1) ? t : hn::Set(D(), 1.0);
  for (q >>= 1; q > 0; q >>= 1) {
    t = hn::Mul(t, t);
    if (q & 1) result = hn::Mul(result, t);
  }
  return result;
}

/// Six sums over the groups: out[k] = scale sum beta moment[first + k], one lane a direction.
HWY_INLINE void sum_moments(const PotentialWorkspace& work, std::size_t first, V scale, double* HWY_RESTRICT out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  V m0 = hn::Zero(d), m1 = m0, m2 = m0, m3 = m0, m4 = m0, m5 = m0;
  for (std::size_t g = 0; g < work.size; ++g) {
    const V beta = hn::LoadU(d, work.beta.data() + g * lanes);
    const double* HWY_RESTRICT m = work.group[g].moment + first;
    m0 = hn::MulAdd(beta, hn::Set(d, m[0]), m0);
    m1 = hn::MulAdd(beta, hn::Set(d, m[1]), m1);
    m2 = hn::MulAdd(beta, hn::Set(d, m[2]), m2);
    m3 = hn::MulAdd(beta, hn::Set(d, m[3]), m3);
    m4 = hn::MulAdd(beta, hn::Set(d, m[4]), m4);
    m5 = hn::MulAdd(beta, hn::Set(d, m[5]), m5);
  }
  const V sums[6] = {m0, m1, m2, m3, m4, m5};
  for (std::size_t k = 0; k < 6; ++k) hn::StoreU(hn::Mul(scale, sums[k]), d, out + k * lanes);
}

void run(const PotentialDirections& directions, int p, int q, PotentialWorkspace& work) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const double inverse_p = 1.0 / p;
  const V half = hn::Set(d, 0.5), zero = hn::Zero(d);
  // Below this, A^(1/p - 1) times a moment could overflow; such a direction weighs less than 1e-10 in E.
  const V smallest = hn::Set(d, 1e-290);
  double S[12 * PotentialDirections::kPadding];
  double ss[36 * PotentialDirections::kPadding] = {}, sh[36 * PotentialDirections::kPadding] = {};
  for (std::size_t i = 0; i < work.size * lanes; ++i) work.partial[i] = 0;

  for (std::size_t u = 0; u < directions.padded(); u += lanes) {
    const V ux = hn::LoadU(d, directions.x.data() + u);
    const V uy = hn::LoadU(d, directions.y.data() + u);
    const V uz = hn::LoadU(d, directions.z.data() + u);
    V A = zero;
    for (std::size_t g = 0; g < work.size; ++g) {
      const PotentialGroup& group = work.group[g];
      V t = hn::MulAdd(hn::Set(d, group.n[0]), ux, half);
      t = hn::MulAdd(hn::Set(d, group.n[1]), uy, t);
      t = hn::MulAdd(hn::Set(d, group.n[2]), uz, t);
      const V beta = power(hn::Max(t, zero), q);
      hn::StoreU(beta, d, work.beta.data() + g * lanes);
      A = hn::MulAdd(beta, hn::Set(d, group.power), A);
    }
    const auto used = hn::Gt(A, smallest);
    const V log_A = hn::Log(d, hn::Max(A, smallest));
    const V active = hn::IfThenElseZero(used, hn::LoadU(d, directions.active.data() + u));
    const V scale = hn::Mul(active, hn::Exp(d, hn::Mul(hn::Set(d, inverse_p - 1), log_A)));   // A^(1/p - 1)
    const V norm = hn::Exp(d, hn::Mul(hn::Set(d, inverse_p), log_A));                         // A^(1/p)

    const V slope = hn::Mul(scale, norm);   // A^(2/p - 1)
    for (std::size_t g = 0; g < work.size; ++g) {
      const V beta = hn::LoadU(d, work.beta.data() + g * lanes);
      double* HWY_RESTRICT partial = work.partial.data() + g * lanes;
      hn::StoreU(hn::MulAdd(beta, slope, hn::LoadU(d, partial)), d, partial);
    }
    sum_moments(work, 0, scale, S);
    sum_moments(work, 6, scale, S + 6 * lanes);
    for (std::size_t row = 0; row < 6; ++row) {
      const V left = hn::LoadU(d, S + row * lanes);
      for (std::size_t column = 0; column < 6; ++column) {
        double* HWY_RESTRICT to_ss = ss + (6 * row + column) * lanes;
        double* HWY_RESTRICT to_sh = sh + (6 * row + column) * lanes;
        hn::StoreU(hn::MulAdd(left, hn::LoadU(d, S + column * lanes), hn::LoadU(d, to_ss)), d, to_ss);
        hn::StoreU(hn::MulAdd(left, hn::LoadU(d, S + (6 + column) * lanes), hn::LoadU(d, to_sh)), d, to_sh);
      }
    }
  }

  const auto reduce = [&](const double* HWY_RESTRICT from) {
    return hn::GetLane(hn::SumOfLanes(d, hn::LoadU(d, from)));
  };
  for (std::size_t g = 0; g < work.size; ++g) work.sum[g] = reduce(work.partial.data() + g * lanes);
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      const std::size_t at = static_cast<std::size_t>(6 * row + column) * lanes;
      work.ss(row, column) = reduce(ss + at);
      work.sh(row, column) = reduce(sh + at);
    }
  }
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(run);

PotentialDirections::PotentialDirections(int n) : count(n) {
  const std::size_t size = (static_cast<std::size_t>(n) + kPadding - 1) / kPadding * kPadding;
  x.resize(size);
  y.resize(size);
  z.resize(size);
  active.resize(size);
  const double golden_angle = M_PI * (3.0 - std::sqrt(5.0));
  for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
    const double height = 1.0 - (2.0 * static_cast<double>(j) + 1.0) / n;
    const double radius = std::sqrt(1.0 - height * height), angle = golden_angle * static_cast<double>(j);
    x[j] = 0.5 * radius * std::cos(angle);
    y[j] = 0.5 * radius * std::sin(angle);
    z[j] = 0.5 * height;
    active[j] = 1;
  }
}

PotentialWorkspace::PotentialWorkspace(std::size_t capacity)
    : group(capacity),
      beta(capacity * PotentialDirections::kPadding),
      partial(capacity * PotentialDirections::kPadding),
      sum(capacity) {
  ss.setZero();
  sh.setZero();
}

void run_potential(const PotentialDirections& directions, int p, int q, PotentialWorkspace& work) noexcept {
  HWY_DYNAMIC_DISPATCH(run)(directions, p, q, work);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
