// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/stiffness/potential_kernel.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
#include <hwy/contrib/math/math-inl.h>
// clang-format on

#include "contact/stiffness/potential_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, PotentialDirections::kPadding>;
using V = hn::Vec<D>;

/// t^q by squaring.
struct AnyPower {
  int q;
  HWY_INLINE V operator()(V t) const {
    V result = (q & 1) ? t : hn::Set(D(), 1.0);
    for (int rest = q >> 1; rest > 0; rest >>= 1) {
      t = hn::Mul(t, t);
      if (rest & 1) result = hn::Mul(result, t);
    }
    return result;
  }
};

/// The default, without the loop.
struct EighthPower {
  HWY_INLINE V operator()(V t) const {
    t = hn::Mul(t, t);
    t = hn::Mul(t, t);
    return hn::Mul(t, t);
  }
};

/// For one vector of directions: beta of each group, and out[k] = sum beta (power, moment)[k], one lane a direction.
/// The sums stay in registers: an array of vectors would not.
template <class Power>
HWY_INLINE void sum_groups(V ux, V uy, V uz, Power power, PotentialWorkspace& work, double* HWY_RESTRICT out) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const V half = hn::Set(d, 0.5), zero = hn::Zero(d);
  V a = zero, m0 = zero, m1 = zero, m2 = zero, m3 = zero, m4 = zero, m5 = zero;
  V m6 = zero, m7 = zero, m8 = zero, m9 = zero, m10 = zero, m11 = zero;
  double* HWY_RESTRICT beta_out = work.beta.data();
  for (std::size_t g = 0; g < work.size; ++g) {
    const PotentialGroup& group = work.group[g];
    V t = hn::MulAdd(hn::Set(d, group.n[0]), ux, half);
    t = hn::MulAdd(hn::Set(d, group.n[1]), uy, t);
    t = hn::MulAdd(hn::Set(d, group.n[2]), uz, t);
    const V beta = power(hn::Max(t, zero));
    hn::StoreU(beta, d, beta_out + g * lanes);
    const double* HWY_RESTRICT m = group.moment;
    a = hn::MulAdd(beta, hn::Set(d, group.power), a);
    m0 = hn::MulAdd(beta, hn::Set(d, m[0]), m0);
    m1 = hn::MulAdd(beta, hn::Set(d, m[1]), m1);
    m2 = hn::MulAdd(beta, hn::Set(d, m[2]), m2);
    m3 = hn::MulAdd(beta, hn::Set(d, m[3]), m3);
    m4 = hn::MulAdd(beta, hn::Set(d, m[4]), m4);
    m5 = hn::MulAdd(beta, hn::Set(d, m[5]), m5);
    m6 = hn::MulAdd(beta, hn::Set(d, m[6]), m6);
    m7 = hn::MulAdd(beta, hn::Set(d, m[7]), m7);
    m8 = hn::MulAdd(beta, hn::Set(d, m[8]), m8);
    m9 = hn::MulAdd(beta, hn::Set(d, m[9]), m9);
    m10 = hn::MulAdd(beta, hn::Set(d, m[10]), m10);
    m11 = hn::MulAdd(beta, hn::Set(d, m[11]), m11);
  }
  const V sums[13] = {a, m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, m10, m11};
  for (std::size_t k = 0; k < 13; ++k) hn::StoreU(sums[k], d, out + k * lanes);
}

template <class Power>
HWY_INLINE void run_with(const PotentialDirections& directions, int p, Power power, PotentialWorkspace& work) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  const double inverse_p = 1.0 / p;
  // Below this, A^(1/p - 1) times a moment could overflow; such a direction weighs less than 1e-10 in E.
  const V smallest = hn::Set(d, 1e-290);
  double sums[13 * PotentialDirections::kPadding];
  double* HWY_RESTRICT S = sums + lanes;
  double ss[36 * PotentialDirections::kPadding] = {}, sh[36 * PotentialDirections::kPadding] = {};
  for (std::size_t i = 0; i < work.size * lanes; ++i) work.partial[i] = 0;

  for (std::size_t u = 0; u < directions.padded(); u += lanes) {
    sum_groups(hn::LoadU(d, directions.x.data() + u), hn::LoadU(d, directions.y.data() + u),
               hn::LoadU(d, directions.z.data() + u), power, work, sums);
    const V A = hn::LoadU(d, sums);
    const V log_A = hn::Log(d, hn::Max(A, smallest));
    const V active = hn::IfThenElseZero(hn::Gt(A, smallest), hn::LoadU(d, directions.active.data() + u));
    const V scale = hn::Mul(active, hn::Exp(d, hn::Mul(hn::Set(d, inverse_p - 1), log_A)));  // A^(1/p - 1)
    const V norm = hn::Exp(d, hn::Mul(hn::Set(d, inverse_p), log_A));                        // A^(1/p)

    const V slope = hn::Mul(scale, norm);  // A^(2/p - 1)
    for (std::size_t g = 0; g < work.size; ++g) {
      const V beta = hn::LoadU(d, work.beta.data() + g * lanes);
      double* HWY_RESTRICT partial = work.partial.data() + g * lanes;
      hn::StoreU(hn::MulAdd(beta, slope, hn::LoadU(d, partial)), d, partial);
    }
    for (std::size_t k = 0; k < 12; ++k) hn::StoreU(hn::Mul(scale, hn::LoadU(d, S + k * lanes)), d, S + k * lanes);
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

void run(const PotentialDirections& directions, int p, int q, PotentialWorkspace& work) {
  if (q == 8) {
    run_with(directions, p, EighthPower(), work);
  } else {
    run_with(directions, p, AnyPower{q}, work);
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
