#include "contact/bake/worker/triangle.hpp"

#include <cmath>
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

SmallTriangle::SmallTriangle(const Triangle& t) {
  for (int i = 0; i < 3; ++i) {
    first[i] = t.corner[0][i];
    inverse_square[i] = static_cast<float>(t.inverse_square[i]);
    normal[i] = static_cast<float>(t.normal[i]);
    for (int k = 0; k < 3; ++k) {
      edge[i][k] = static_cast<float>(t.edge[i][k]);
      side[i][k] = static_cast<float>(t.side[i][k]);
    }
  }
  inverse_normal = static_cast<float>(t.inverse_normal);
}

__attribute__((target_clones("avx2", "default"))) void lower_square_distances(const SmallTriangle& triangle,
                                                                              const Vec3& base, const float* x,
                                                                              const float* y, const float* z,
                                                                              std::size_t count, float* best) {
  const SmallTriangle t = triangle;  // so that the stores to best cannot alias it
  const auto ox = static_cast<float>(base.x() - t.first[0]), oy = static_cast<float>(base.y() - t.first[1]),
             oz = static_cast<float>(base.z() - t.first[2]);
  for (std::size_t i = 0; i < count; ++i) {
    float px = x[i] + ox, py = y[i] + oy, pz = z[i] + oz;
    const float height = px * t.normal[0] + py * t.normal[1] + pz * t.normal[2];
    const float plane = height * height * t.inverse_normal;
    float nearest_edge = std::numeric_limits<float>::max(), outermost = -std::numeric_limits<float>::max();
    for (int k = 0; k < 3; ++k) {
      float s = (px * t.edge[k][0] + py * t.edge[k][1] + pz * t.edge[k][2]) * t.inverse_square[k];
      s = s < 0 ? 0 : s;
      s = s > 1 ? 1 : s;
      const float dx = px - s * t.edge[k][0], dy = py - s * t.edge[k][1], dz = pz - s * t.edge[k][2];
      const float square = dx * dx + dy * dy + dz * dz;
      nearest_edge = square < nearest_edge ? square : nearest_edge;
      const float out = px * t.side[k][0] + py * t.side[k][1] + pz * t.side[k][2];
      outermost = out > outermost ? out : outermost;
      px -= t.edge[k][0];
      py -= t.edge[k][1];
      pz -= t.edge[k][2];
    }
    const bool over = (outermost <= 0) & (t.inverse_normal > 0) & (plane < nearest_edge);
    const float square = over ? plane : nearest_edge;
    best[i] = square < best[i] ? square : best[i];
  }
}

__attribute__((target_clones("avx2", "default"))) float bound_distances(const float* x, const float* y, const float* z,
                                                                        const float* radius, std::size_t count,
                                                                        const float* p, float* low) {
  const float px = p[0], py = p[1], pz = p[2];
  float least = std::numeric_limits<float>::max();
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - px, dy = y[i] - py, dz = z[i] - pz;
    const float d = std::sqrt(dx * dx + dy * dy + dz * dz);
    low[i] = d - radius[i];
    least = d < least ? d : least;
  }
  return least;
}

}  // namespace tact::contact
