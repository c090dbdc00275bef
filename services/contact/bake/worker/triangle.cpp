#include "contact/bake/worker/triangle.hpp"

#include <limits>

namespace tact::contact {
namespace {

inline double square_distance_to(const Triangle& t, double x, double y, double z) {
  double nearest_edge = std::numeric_limits<double>::max();
  double outermost = -1;  // the largest signed side: positive outside the prism
  for (int i = 0; i < 3; ++i) {
    const double px = x - t.corner[i][0], py = y - t.corner[i][1], pz = z - t.corner[i][2];
    double s = (px * t.edge[i][0] + py * t.edge[i][1] + pz * t.edge[i][2]) * t.inverse_square[i];
    s = s < 0 ? 0 : s;
    s = s > 1 ? 1 : s;
    const double dx = px - s * t.edge[i][0], dy = py - s * t.edge[i][1], dz = pz - s * t.edge[i][2];
    const double square = dx * dx + dy * dy + dz * dz;
    nearest_edge = square < nearest_edge ? square : nearest_edge;
    const double out = px * t.side[i][0] + py * t.side[i][1] + pz * t.side[i][2];
    outermost = i == 0 || out > outermost ? out : outermost;
  }
  const double height =
      (x - t.corner[0][0]) * t.normal[0] + (y - t.corner[0][1]) * t.normal[1] + (z - t.corner[0][2]) * t.normal[2];
  const double plane = height * height * t.inverse_normal;
  const bool over = outermost <= 0 && t.inverse_normal > 0;
  return over && plane < nearest_edge ? plane : nearest_edge;
}

}  // namespace

Triangle::Triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 corners[3] = {a, b, c}, edges[3] = {b - a, c - b, a - c};
  const Vec3 n = edges[0].cross(c - a);
  double longest = 0;
  for (const Vec3& e : edges) longest = std::max(longest, e.squaredNorm());
  const bool flat = !(n.squaredNorm() > 1e-24 * longest * longest);
  for (int i = 0; i < 3; ++i) {
    const Vec3 out = edges[i].cross(n);
    const double square = edges[i].squaredNorm();
    inverse_square[i] = square > 0 ? 1 / square : 0;
    for (int k = 0; k < 3; ++k) {
      corner[i][k] = corners[i][k];
      edge[i][k] = edges[i][k];
      side[i][k] = flat ? 0 : out[k];
    }
    normal[i] = n[i];
  }
  inverse_normal = flat ? 0 : 1 / n.squaredNorm();
}

double Triangle::square_distance(const Vec3& p) const { return square_distance_to(*this, p.x(), p.y(), p.z()); }

__attribute__((target_clones("avx2", "default"))) void lower_square_distances(const Triangle& triangle, const double* x,
                                                                              const double* y, const double* z,
                                                                              std::size_t count, double* best) {
  const Triangle t = triangle;  // so that the stores to best cannot alias it
  for (std::size_t i = 0; i < count; ++i) {
    const double square = square_distance_to(t, x[i], y[i], z[i]);
    best[i] = square < best[i] ? square : best[i];
  }
}

}  // namespace tact::contact
