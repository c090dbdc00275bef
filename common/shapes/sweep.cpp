#include "shapes/sweep.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapes/solids.hpp"

namespace tact::shapes {
namespace {

/// Points about every `step` along the polyline, its ends included, corners not.
Path evenly(const Path& line, double step) {
  const double total = length(line);
  const int n = std::max(1, static_cast<int>(std::lround(total / step)));
  Path out{line.front()};
  std::size_t piece = 1;
  double before = 0;  // length up to the piece's beginning
  for (int i = 1; i < n; ++i) {
    const double s = total * i / n;
    double size = (line[piece] - line[piece - 1]).norm();
    while (before + size < s && piece + 1 < line.size()) {
      before += size;
      ++piece;
      size = (line[piece] - line[piece - 1]).norm();
    }
    out.emplace_back(line[piece - 1] + (s - before) / size * (line[piece] - line[piece - 1]));
  }
  out.push_back(line.back());
  return out;
}

Vec3 tangent(const Path& path, std::size_t i) {
  const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, path.size() - 1);
  Vec3 sum = Vec3::Zero();
  if (before != i) sum += (path[i] - path[before]).normalized();
  if (after != i) sum += (path[after] - path[i]).normalized();
  return sum.normalized();
}

/// Across directions that turn with the path, never about it.
std::vector<Vec3> carried_normals(const Path& path) {
  std::vector<Vec3> normals;
  Vec3 n = any_perpendicular(tangent(path, 0));
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3 t = tangent(path, i);
    n = (n - n.dot(t) * t).normalized();
    normals.push_back(n);
  }
  return normals;
}

}  // namespace

double length(const Path& path) {
  double sum = 0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

Path pipe_path(const Path& corners, double bend_radius, double step) {
  Path line{corners.front()};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3 before = corners[i] - corners[i - 1], after = corners[i + 1] - corners[i];
    const Vec3 in = before.normalized(), to = after.normalized();
    const double turn = std::acos(std::clamp(in.dot(to), -1.0, 1.0));
    if (turn < 1e-6) continue;
    const double half_tan = std::tan(turn / 2);
    const double r = std::min(bend_radius, 0.499 * std::min(before.norm(), after.norm()) / half_tan);
    const Vec3 across = (to - to.dot(in) * in).normalized();
    const Vec3 begin = corners[i] - r * half_tan * in, centre = begin + r * across;
    const int n = std::max(2, static_cast<int>(std::ceil(16 * turn)));  // fine: evenly() decides what is kept
    for (int k = 0; k <= n; ++k) {
      const double a = turn * k / n;
      line.emplace_back(centre + r * (std::sin(a) * in - std::cos(a) * across));
    }
  }
  line.push_back(corners.back());
  return evenly(line, step);
}

Path cable_path(const Path& points, double step) {
  Path p{2 * points.front() - points[1]};
  p.insert(p.end(), points.begin(), points.end());
  p.emplace_back(2 * points.back() - points[points.size() - 2]);
  Path line{points.front()};
  for (std::size_t i = 1; i + 2 < p.size(); ++i) {
    double t[4] = {0, 0, 0, 0};
    for (std::size_t k = 1; k < 4; ++k) t[k] = t[k - 1] + std::sqrt((p[i + k - 1] - p[i + k - 2]).norm());
    const auto blend = [&](const Vec3& a, double ta, const Vec3& b, double tb, double at) -> Vec3 {
      return ((tb - at) * a + (at - ta) * b) / (tb - ta);
    };
    const int n = std::max(2, static_cast<int>(std::ceil(2 * (p[i + 1] - p[i]).norm() / step)));
    for (int k = 1; k <= n; ++k) {
      const double at = t[1] + (t[2] - t[1]) * k / n;
      const Vec3 a1 = blend(p[i - 1], t[0], p[i], t[1], at), a2 = blend(p[i], t[1], p[i + 1], t[2], at),
                 a3 = blend(p[i + 1], t[2], p[i + 2], t[3], at);
      line.push_back(blend(blend(a1, t[0], a2, t[2], at), t[1], blend(a2, t[1], a3, t[3], at), t[2], at));
    }
  }
  return evenly(line, step);
}

Path strand(const Path& path, double radius, double angle, double twist_per_m) {
  const std::vector<Vec3> normals = carried_normals(path);
  Path out;
  double s = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) s += (path[i] - path[i - 1]).norm();
    const double a = angle + twist_per_m * s;
    out.emplace_back(path[i] + radius * (std::cos(a) * normals[i] + std::sin(a) * tangent(path, i).cross(normals[i])));
  }
  return out;
}

Mesh tube(const Path& path, double radius, int sides) {
  return tube(
      path, [radius](double) { return radius; }, sides);
}

Mesh tube(const Path& path, const std::function<double(double)>& radius_at, int sides) {
  const std::vector<Vec3> normals = carried_normals(path);
  std::vector<std::vector<Vec3>> rings;
  double s = 0;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (i > 0) s += (path[i] - path[i - 1]).norm();
    const Vec3 across = tangent(path, i).cross(normals[i]);
    std::vector<Vec3> ring;
    for (int k = 0; k < sides; ++k) {
      const double a = 2 * std::numbers::pi * k / sides;
      ring.emplace_back(path[i] + radius_at(s) * (std::cos(a) * normals[i] + std::sin(a) * across));
    }
    rings.push_back(std::move(ring));
  }
  return loft(rings);
}

}  // namespace tact::shapes
