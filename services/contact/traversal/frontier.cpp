// Compiled once for each instruction set (Highway's foreach_target), chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "contact/traversal/frontier.cpp"
// The order matters: what follows foreach_target.h is compiled for every target.
#include <hwy/foreach_target.h>
// clang-format off
#include <hwy/cache_control.h>
#include <hwy/highway.h>
// clang-format on

#include <algorithm>

#include "contact/traversal/frontier.hpp"
#include "field/distance_field.hpp"

HWY_BEFORE_NAMESPACE();
namespace tact::contact::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using F = hn::CappedTag<float, kBeyond>;
using U = hn::RebindToUnsigned<F>;
using D = hn::CappedTag<double, 8>;
using V = hn::Vec<D>;

HWY_INLINE void append_one(Family family, const Hierarchy& all, Frontier& to) {
  constexpr std::size_t kAtOnce = 8;  // once, but for large families; what is written too much the next one overwrites
  const hn::CappedTag<std::uint32_t, kAtOnce> du;
  const F df;
  const auto count = hn::Iota(du, 0);
  for (std::uint32_t k = 0; k < family.count; k += kAtOnce) {
    hwy::Prefetch(all.families.data() + family.begin + k);  // wanted once these nodes are visited
    std::uint32_t* HWY_RESTRICT id = to.id.data() + to.size + k;
    for (std::size_t j = 0; j < kAtOnce; j += hn::Lanes(du)) {
      hn::StoreU(hn::Add(count, hn::Set(du, family.begin + k + static_cast<std::uint32_t>(j))), du, id + j);
    }
    const float* HWY_RESTRICT from = &all.nodes[family.begin + k].x;
    float* HWY_RESTRICT out = &to.node[to.size + k].x;
    for (std::size_t j = 0; j < 4 * kAtOnce; j += hn::Lanes(df)) hn::StoreU(hn::LoadU(df, from + j), df, out + j);
  }
  to.size += family.count;
}

void append_family(Family family, const Hierarchy& all, Frontier& to) { append_one(family, all, to); }

/// Writes the ids of nodes whose clearance is not more than limit(node), side by side. Returns how many there are.
template <class Limit>
HWY_INLINE std::size_t pick(const Cleared& nodes, Limit limit, std::uint32_t* HWY_RESTRICT out) {
  std::size_t size = 0;
#if HWY_TARGET <= HWY_AVX3
  const F d;
  const U du;
  for (std::size_t i = 0; i < nodes.count; i += hn::Lanes(d)) {
    const auto clear = hn::Gt(hn::LoadU(d, nodes.clear + i), limit(d, i));
    const auto picked = hn::And(hn::Not(clear), hn::FirstN(d, nodes.count - i));
    hn::StoreU(hn::Compress(hn::LoadU(du, nodes.id + i), hn::RebindMask(du, picked)), du, out + size);
    size += hn::CountTrue(d, picked);
  }
#else  // without an instruction for it, Highway copies a table each time
  const hn::CappedTag<float, 1> d;
  for (std::size_t i = 0; i < nodes.count; ++i) {
    out[size] = nodes.id[i];
    size += nodes.clear[i] > hn::GetLane(limit(d, i)) ? 0 : 1;
  }
#endif
  return size;
}

void part_nodes(const Cleared& nodes, float slack, Candidates& candidates) {
  const auto limit = [&](auto d, std::size_t) { return hn::Set(d, slack); };
  candidates.size += pick(nodes, limit, candidates.id.data() + candidates.size);
}

void descend_nodes(const Cleared& nodes, const Hierarchy& all, Frontier& next) {
  std::uint32_t open[kChunk + kBeyond];
  const auto limit = [&](auto d, std::size_t i) { return hn::LoadU(d, nodes.needed + i); };
  const std::size_t count = pick(nodes, limit, open);
  for (std::size_t k = 0; k < count; ++k) {
    if (open[k] < all.families.size()) append_one(all.families[open[k]], all, next);
  }
}

HWY_INLINE V dot(const V* a, const V* b) { return hn::MulAdd(a[0], b[0], hn::MulAdd(a[1], b[1], hn::Mul(a[2], b[2]))); }

HWY_INLINE void put(const double (&from)[3][kChunk], std::size_t i, Vec3& to) {
  const D d;
  hn::StoreInterleaved3(hn::Load(d, from[0] + i), hn::Load(d, from[1] + i), hn::Load(d, from[2] + i), d, to.data());
}

HWY_INLINE Vec3 one(const double (&from)[3][kChunk], std::size_t k) { return {from[0][k], from[1][k], from[2][k]}; }

Emitted emit_chunk(const Sampled& s, std::size_t count, ContactBuffer& contacts) {
  static_assert(ContactBuffer::kBeyond >= hn::MaxLanes(D()));
  const D d;
  std::size_t n = contacts.size;
  V deepest = hn::Zero(d);
  Emitted out{0, 0};
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
    const std::size_t here = std::min(hn::Lanes(d), count - i);
    const V value = hn::Load(d, s.value + i);
    const auto inside = hn::And(hn::Lt(value, hn::Zero(d)), hn::FirstN(d, here));
    const V depth = hn::IfThenElseZero(inside, hn::Neg(value));
    deepest = hn::Max(deepest, depth);
    V N[3], g[3];
    for (int a = 0; a < 3; ++a) N[a] = hn::Load(d, s.N[a] + i), g[a] = hn::Load(d, s.g[a] + i);
    const auto past = hn::Lt(dot(g, N), hn::Mul(hn::Set(d, -0.5), hn::Sqrt(dot(g, g))));
    std::uint8_t past_bits[8] = {};
    hn::StoreMaskBits(d, past, past_bits);
    const auto flags_of = [&](std::size_t k) {
      const std::uint32_t in_field = s.in_field[i + k];
      std::uint32_t flags = ((past_bits[0] >> k) & 1u) * bit(Status::past_mid_surface);
      flags |= (in_field & DistanceField::kInBand) == 0 ? bit(Status::beyond_band) : 0;
      flags |= (in_field & DistanceField::kDoubtful) != 0 ? bit(Status::sign_doubtful) : 0;
      return flags;
    };
    if (hn::CountTrue(d, inside) == here) {  // nearly always: culling is exact to rounding
      put(s.r, i, contacts.r[n]);
      put(s.N, i, contacts.N[n]);
      put(s.g, i, contacts.g[n]);
      hn::StoreU(depth, d, contacts.depth_m.data() + n);
      for (std::size_t k = 0; k < here; ++k) {
        contacts.point_id[n + k] = s.id[i + k];
        out.flags |= contacts.flags[n + k] = flags_of(k);
      }
      n += here;
      continue;
    }
    for (std::size_t k = 0; k < here; ++k) {
      if (!(s.value[i + k] < 0)) continue;
      contacts.r[n] = one(s.r, i + k);
      contacts.N[n] = one(s.N, i + k);
      contacts.g[n] = one(s.g, i + k);
      contacts.depth_m[n] = -s.value[i + k];
      contacts.point_id[n] = s.id[i + k];
      out.flags |= contacts.flags[n] = flags_of(k);
      ++n;
    }
  }
  contacts.size = n;
  out.deepest_m = hn::GetLane(hn::MaxOfLanes(d, deepest));
  return out;
}

}  // namespace tact::contact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tact::contact {

HWY_EXPORT(append_family);
HWY_EXPORT(part_nodes);
HWY_EXPORT(descend_nodes);
HWY_EXPORT(emit_chunk);

void append(Family family, const Hierarchy& all, Frontier& to) noexcept {
  HWY_DYNAMIC_DISPATCH(append_family)(family, all, to);
}

void part(const Cleared& nodes, float slack, Candidates& candidates) noexcept {
  HWY_DYNAMIC_DISPATCH(part_nodes)(nodes, slack, candidates);
}

void descend(const Cleared& nodes, const Hierarchy& all, Frontier& next) noexcept {
  HWY_DYNAMIC_DISPATCH(descend_nodes)(nodes, all, next);
}

Emitted emit(const Sampled& candidates, std::size_t count, ContactBuffer& contacts) noexcept {
  return HWY_DYNAMIC_DISPATCH(emit_chunk)(candidates, count, contacts);
}

}  // namespace tact::contact
#endif  // HWY_ONCE
