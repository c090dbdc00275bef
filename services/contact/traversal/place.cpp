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

HWY_INLINE V row(const Mat3& R, const Vec3& t, int i, V x, V y, V z) {
  const D d;
  const V xy = hn::Add(hn::Mul(hn::Set(d, R(i, 0)), x), hn::Mul(hn::Set(d, R(i, 1)), y));
  return hn::Add(hn::Add(xy, hn::Mul(hn::Set(d, R(i, 2)), z)), hn::Set(d, t[i]));
}

void place_nodes(const Mat3& R, const Vec3& t, const Node* nodes, std::size_t count, const Placed& out) {
  const D d;
  const hn::Rebind<float, D> single;
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<decltype(single)> x, y, z, radius;
    hn::LoadInterleaved4(single, &nodes[i].x, x, y, z, radius);
    const V px = hn::PromoteTo(d, x), py = hn::PromoteTo(d, y), pz = hn::PromoteTo(d, z);
    hn::StoreU(row(R, t, 0, px, py, pz), d, out.x + i);
    hn::StoreU(row(R, t, 1, px, py, pz), d, out.y + i);
    hn::StoreU(row(R, t, 2, px, py, pz), d, out.z + i);
  }
}

void place_nodes_in_cells(const ToCells& to, const Node* nodes, std::size_t count, const PlacedInCells& out) {
  const hn::CappedTag<float, kPlacedAtOnce> d;
  const auto factor = hn::Set(d, to.factor), slack = hn::Set(d, to.slack);
  float* const place[3] = {out.x, out.y, out.z};
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    hn::Vec<decltype(d)> x, y, z, radius;
    hn::LoadInterleaved4(d, &nodes[i].x, x, y, z, radius);
    for (int a = 0; a < 3; ++a) {
      const auto xt = hn::MulAdd(hn::Set(d, to.A(a, 0)), x, hn::Set(d, to.b[a]));
      const auto xyt = hn::MulAdd(hn::Set(d, to.A(a, 1)), y, xt);
      hn::StoreU(hn::MulAdd(hn::Set(d, to.A(a, 2)), z, xyt), d, place[a] + i);
    }
    hn::StoreU(hn::MulAdd(radius, factor, slack), d, out.needed + i);
  }
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(place_nodes);
HWY_EXPORT(place_nodes_in_cells);

void place(const Mat3& R, const Vec3& t, const Node* nodes, std::size_t count, const Placed& out) noexcept {
  HWY_DYNAMIC_DISPATCH(place_nodes)(R, t, nodes, count, out);
}

void place_in_cells(const ToCells& to, const Node* nodes, std::size_t count, const PlacedInCells& out) noexcept {
  HWY_DYNAMIC_DISPATCH(place_nodes_in_cells)(to, nodes, count, out);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
