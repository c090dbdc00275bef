#include "contact/bake/worker/opposite_face.hpp"

#include <cmath>

namespace tact::contact {

double opposite_face_m(const Surface& surface, const Vec3& p, const Vec3& direction, double reach_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity(), kLooksBack = 0.906;
  thread_local std::vector<Crossing> found;
  found.clear();
  surface.cross(p, direction, reach_m, found);
  double nearest = kInfinity;
  bool looks_back = false;
  for (const Crossing& c : found) {
    const Triangle& t = surface.triangle(c.triangle);
    const Vec3 normal(t.normal), corner(t.corner[0]);
    const double along = normal.dot(direction);
    if (along == 0) continue;
    const double far = (corner + surface.middle() - p).dot(normal) / along;
    if (far < 2e-5 * surface.size() || far >= nearest) continue;
    nearest = far;
    looks_back = std::fabs(along) > kLooksBack * normal.norm();
  }
  return looks_back ? nearest : kInfinity;
}

}  // namespace tact::contact
