#include "contact/pipeline/side_memory.hpp"

#include <algorithm>
#include <cmath>

namespace tact::contact {
namespace {

constexpr double kClear2 = 0.25;        // |g|^2 from which a gradient tells a side: in the middle of a wall it vanishes
constexpr double kLeast_voxels = 1e-9;  // contacts have a depth

/// Whether the field ends within its band from p along N.
bool surface_along(const DistanceField& field, const Vec3& p_O, const Vec3& N) noexcept {
  for (double s = field.voxel_m(); s <= field.band_m(); s += field.voxel_m()) {
    if (field.sample(p_O + s * N).value_m >= 0) return true;
  }
  return false;
}

}  // namespace

double SideMemory::hold(const DistanceField& field, const Vec3& p_To_O, ContactBuffer& contacts) noexcept {
  ++tick_;
  double deepest = 0;
  for (std::size_t i = 0; i < contacts.size; ++i) {
    Memory& m = memory_[contacts.point_id[i]];
    const Vec3 &N = contacts.N[i], &g = contacts.g[i], p = p_To_O + contacts.r[i];
    const double length2 = g.squaredNorm();
    const bool faces = N.dot(g) >= 0;
    if (m.tick + 1 != tick_) {
      m.held = false;
      m.faced = faces;
      m.direction_O = length2 > 0 ? Vec3(g / std::sqrt(length2)) : N;
    }
    m.tick = tick_;
    if (!m.held) {
      const bool turned = g.dot(m.direction_O) < 0;
      m.held = turned || (m.faced && !faces && surface_along(field, p, N));
      m.faced = faces;
      if (!m.held) {
        if (length2 > kClear2) m.direction_O = g / std::sqrt(length2);
        continue;
      }
      if (!turned) m.direction_O = N;
      m.p_O = p;
      m.depth_m = contacts.depth_m[i];
    }
    const double depth = m.depth_m - m.direction_O.dot(p - m.p_O);
    if (m.direction_O.dot(g) >= 0 && depth >= contacts.depth_m[i]) {
      m.held = false;
      m.faced = faces;
      continue;
    }
    contacts.depth_m[i] = std::max(depth, kLeast_voxels * field.voxel_m());
    contacts.g[i] = m.direction_O;
    deepest = std::max(deepest, contacts.depth_m[i]);
  }
  return deepest;
}

}  // namespace tact::contact
