#include "tools/scenes/mesh_distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tact {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double segment_distance(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b) {
  // Least |p + s u - a - t v| with s, t in [0, 1]: one clamped, the other solved, the first solved again.
  const Vec3 u = q - p, v = b - a, w = p - a;
  const double uu = u.dot(u), vv = v.dot(v), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-12 * uu * vv ? std::clamp((uv * vw - vv * uw) / det, 0.0, 1.0) : 0.0;
  const double t = std::clamp((uv * s + vw) / vv, 0.0, 1.0);
  s = std::clamp((uv * t - uw) / uu, 0.0, 1.0);
  return (w + s * u - t * v).norm();
}

}  // namespace

PlacedMesh::PlacedMesh(const Mesh& mesh, const Pose& X_W) {
  for (const auto& t : mesh.triangles) {
    Triangle placed;
    for (std::size_t i = 0; i < 3; ++i) placed.corner[i] = X_W * Vec3(mesh.vertices[t[i]].cast<double>());
    placed.centre = (placed.corner[0] + placed.corner[1] + placed.corner[2]) / 3;
    placed.radius = 0;
    for (const auto& c : placed.corner) placed.radius = std::max(placed.radius, (c - placed.centre).norm());
    triangles.push_back(placed);
  }
}

double distance(const Vec3& p, const PlacedMesh::Triangle& t) {
  const Vec3 n = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
  bool above = true;  // p projects into the triangle
  double edges = kInfinity;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = t.corner[i], &b = t.corner[(i + 1) % 3];
    above = above && n.dot((b - a).cross(p - a)) >= 0;
    const Vec3 v = b - a;
    edges = std::min(edges, (p - a - std::clamp((p - a).dot(v) / v.dot(v), 0.0, 1.0) * v).norm());
  }
  return above ? std::abs(n.dot(p - t.corner[0])) / n.norm() : edges;
}

double distance(const PlacedMesh::Triangle& a, const PlacedMesh::Triangle& b) {
  double best = kInfinity;
  for (int i = 0; i < 3; ++i) {
    best = std::min({best, distance(a.corner[i], b), distance(b.corner[i], a)});
    for (int j = 0; j < 3; ++j) {
      best = std::min(best, segment_distance(a.corner[i], a.corner[(i + 1) % 3], b.corner[j], b.corner[(j + 1) % 3]));
    }
  }
  return best;
}

double distance(const Vec3& p, const PlacedMesh& mesh) {
  double best = kInfinity;
  for (const auto& t : mesh.triangles) {
    if ((p - t.centre).norm() - t.radius < best) best = std::min(best, distance(p, t));
  }
  return best;
}

double distance(const PlacedMesh& a, const PlacedMesh& b, double cap) {
  double best = cap;
  for (const auto& s : a.triangles) {
    for (const auto& t : b.triangles) {
      const double reach = best + s.radius + t.radius;
      if ((s.centre - t.centre).squaredNorm() < reach * reach) best = std::min(best, distance(s, t));
    }
  }
  return best;
}

double winding_number(const Vec3& p, const PlacedMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = t.corner[0] - p, b = t.corner[1] - p, c = t.corner[2] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

}  // namespace tact
