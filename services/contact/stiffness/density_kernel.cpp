// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/stiffness/density_kernel.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "contact/stiffness/density_kernel.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, kDensityPad>;
using V = hn::Vec<D>;

/// What a vector of classes is; lanes beyond the cell are another cell's.
struct Lanes {
  V x, y, z;
  hn::Mask<D> own;

  HWY_INLINE Lanes(const DensityClasses& c, std::size_t i, std::size_t end)
      : x(hn::LoadU(D(), c.x.data() + i)),
        y(hn::LoadU(D(), c.y.data() + i)),
        z(hn::LoadU(D(), c.z.data() + i)),
        own(hn::FirstN(D(), end - i)) {}

  HWY_INLINE void add(V phi, double* to) const {
    hn::StoreU(hn::Add(hn::LoadU(D(), to), hn::IfThenElseZero(own, phi)), D(), to);
  }
};

/// sum_j (1 - |a - b_j|^2 / eps^2) for every class a of `to`, over all b_j of `from`.
HWY_INLINE void add_moments(const DensityCell& from, const DensityCell& to, double inverse_eps2, DensityClasses& c) {
  const D d;
  const V inverse = hn::Set(d, inverse_eps2), count = hn::Set(d, from.count);
  const V twice_x = hn::Set(d, 2 * from.sum_b.x()), twice_y = hn::Set(d, 2 * from.sum_b.y()),
          twice_z = hn::Set(d, 2 * from.sum_b.z());
  for (std::size_t i = to.begin; i < to.end; i += hn::Lanes(d)) {
    const Lanes a(c, i, to.end);
    const V x = hn::Sub(a.x, hn::Set(d, from.centre.x())), y = hn::Sub(a.y, hn::Set(d, from.centre.y())),
            z = hn::Sub(a.z, hn::Set(d, from.centre.z()));
    // count |a|^2 - 2 a.sum_b + sum_b2
    V sum_d2 = hn::MulAdd(hn::MulSub(count, x, twice_x), x, hn::Set(d, from.sum_b2));
    sum_d2 = hn::MulAdd(hn::MulSub(count, y, twice_y), y, sum_d2);
    sum_d2 = hn::MulAdd(hn::MulSub(count, z, twice_z), z, sum_d2);
    a.add(hn::NegMulAdd(sum_d2, inverse, count), c.phi.data() + i);
  }
}

/// The same pair by pair: some are farther apart than eps and add nothing.
HWY_INLINE void add_pairs(const DensityCell& from, const DensityCell& to, double inverse_eps2, DensityClasses& c) {
  const D d;
  const V one = hn::Set(d, 1.0), zero = hn::Zero(d), inverse = hn::Set(d, inverse_eps2);
  for (std::size_t i = to.begin; i < to.end; i += hn::Lanes(d)) {
    const Lanes a(c, i, to.end);
    V phi = zero;
    for (std::size_t j = from.begin; j < from.end; ++j) {
      const V x = hn::Sub(a.x, hn::Set(d, c.x[j])), y = hn::Sub(a.y, hn::Set(d, c.y[j])),
              z = hn::Sub(a.z, hn::Set(d, c.z[j]));
      const V d2 = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
      const V hat = hn::Max(hn::NegMulAdd(d2, inverse, one), zero);
      phi = hn::MulAdd(hat, hn::Set(d, c.count[j]), phi);
    }
    a.add(phi, c.phi.data() + i);
  }
}

void sum(const DensityCell* cells, std::size_t cell_count, const DensityNeighbours& neighbours,
         const std::uint32_t* used_cell, double eps2, DensityClasses& classes) {
  const double inverse_eps2 = 1 / eps2;
  for (std::size_t u = 0; u < cell_count; ++u) {
    const DensityCell& a = cells[u];
    add_moments(a, a, inverse_eps2, classes);
    for (std::uint32_t n = neighbours.begin[a.index]; n < neighbours.begin[a.index + 1]; ++n) {
      const std::uint32_t other = used_cell[neighbours.cell[n]];
      if (other >= cell_count || cells[other].index != neighbours.cell[n]) continue;
      const DensityCell& b = cells[other];
      double gap2 = 0, span2 = 0;  // between the nearest places of the two boxes, and the farthest
      for (int k = 0; k < 3; ++k) {
        const double ab = a.lo[k] - b.hi[k], ba = b.lo[k] - a.hi[k];
        const double gap = ab > ba ? ab : ba, span = ab < ba ? ab : ba;
        gap2 += gap > 0 ? gap * gap : 0;
        span2 += span * span;
      }
      if (gap2 >= eps2) continue;
      if (span2 <= eps2) {
        add_moments(a, b, inverse_eps2, classes);
        add_moments(b, a, inverse_eps2, classes);
      } else {
        add_pairs(a, b, inverse_eps2, classes);
        add_pairs(b, a, inverse_eps2, classes);
      }
    }
  }
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(sum);

void sum_density(const DensityCell* cells, std::size_t cell_count, const DensityNeighbours& neighbours,
                 const std::uint32_t* used_cell, double eps2, DensityClasses& classes) noexcept {
  HWY_DYNAMIC_DISPATCH(sum)(cells, cell_count, neighbours, used_cell, eps2, classes);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
