// Compiled once for each instruction set (Highway's foreach_target). Without fused multiply-add: see the header.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/traversal/place.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/highway.h>
// clang-format on

#include "contact/traversal/place.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

/// The sums in the order in which Eigen makes them: rows 0 and 1 as a pair, row 2 alone, halves first.
HWY_INLINE V row(const Mat3& R, const Vec3& t, int i, V x, V y, V z) {
  const D d;
  const V xx = hn::Mul(hn::Set(d, R(i, 0)), x), yy = hn::Mul(hn::Set(d, R(i, 1)), y);
  const V zz = hn::Mul(hn::Set(d, R(i, 2)), z);
  const V sum = i < 2 ? hn::Add(hn::Add(xx, yy), zz) : hn::Add(xx, hn::Add(yy, zz));
  return hn::Add(sum, hn::Set(d, t[i]));
}

void place_points(const Mat3& R, const Vec3& t, const float* HWY_RESTRICT x, const float* HWY_RESTRICT y,
                  const float* HWY_RESTRICT z, std::size_t count, double* HWY_RESTRICT out_x,
                  double* HWY_RESTRICT out_y, double* HWY_RESTRICT out_z) {
  const D d;
  const hn::Rebind<float, D> single;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const V px = hn::PromoteTo(d, hn::LoadU(single, x + i));
    const V py = hn::PromoteTo(d, hn::LoadU(single, y + i));
    const V pz = hn::PromoteTo(d, hn::LoadU(single, z + i));
    hn::StoreU(row(R, t, 0, px, py, pz), d, out_x + i);
    hn::StoreU(row(R, t, 1, px, py, pz), d, out_y + i);
    hn::StoreU(row(R, t, 2, px, py, pz), d, out_z + i);
  }
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(place_points);

void place(const Mat3& R, const Vec3& t, const float* x, const float* y, const float* z, std::size_t count,
           double* out_x, double* out_y, double* out_z) noexcept {
  HWY_DYNAMIC_DISPATCH(place_points)(R, t, x, y, z, count, out_x, out_y, out_z);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
