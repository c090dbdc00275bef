#include "shapes/solids.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace tact::shapes {
namespace {

using Index = std::uint32_t;

Index add_vertex(Mesh& mesh, double x, double y, double z) {
  mesh.vertices.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  return static_cast<Index>(mesh.vertices.size() - 1);
}

/// Polygon seen from +z anticlockwise; a flat, not a corner, faces +x.
Index add_ring(Mesh& mesh, int sides, double circumradius, double z) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (int i = 0; i < sides; ++i) {
    const double angle = (2 * i - 1) * std::numbers::pi / sides;
    add_vertex(mesh, circumradius * std::cos(angle), circumradius * std::sin(angle), z);
  }
  return first;
}

/// Band between two rings; outward is to the right of lower -> upper seen along the rings' direction.
void add_band(Mesh& mesh, int sides, Index lower, Index upper) {
  for (int i = 0; i < sides; ++i) {
    const auto a = static_cast<Index>(i), b = static_cast<Index>((i + 1) % sides);
    mesh.triangles.push_back({lower + a, lower + b, upper + b});
    mesh.triangles.push_back({lower + a, upper + b, upper + a});
  }
}

/// Disc that closes a ring; `up`: its outside is +z.
void add_disc(Mesh& mesh, int sides, Index ring, double z, bool up) {
  const Index centre = add_vertex(mesh, 0, 0, z);
  for (int i = 0; i < sides; ++i) {
    const auto a = ring + static_cast<Index>(i), b = ring + static_cast<Index>((i + 1) % sides);
    if (up) {
      mesh.triangles.push_back({centre, a, b});
    } else {
      mesh.triangles.push_back({centre, b, a});
    }
  }
}

Index add_points(Mesh& mesh, const std::vector<Vec3>& points) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (const Vec3& p : points) mesh.vertices.push_back(p.cast<float>());
  return first;
}

void add_fan(Mesh& mesh, const std::vector<Vec3>& points, Index ring, bool forward) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : points) sum += p;
  const Index centre = add_points(mesh, {sum / static_cast<double>(points.size())});
  const auto n = static_cast<Index>(points.size());
  for (Index i = 0; i < n; ++i) {
    const Index a = ring + i, b = ring + (i + 1) % n;
    mesh.triangles.push_back(forward ? std::array{centre, a, b} : std::array{centre, b, a});
  }
}

double circumradius(int sides, double width) { return width / 2 / std::cos(std::numbers::pi / sides); }

}  // namespace

void add_box(Mesh& mesh, const Vec3& lowest, const Vec3& highest) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (int corner = 0; corner < 8; ++corner) {
    add_vertex(mesh, (corner & 1 ? highest : lowest).x(), (corner & 2 ? highest : lowest).y(),
               (corner & 4 ? highest : lowest).z());
  }
  constexpr Index kTriangles[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                       {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (const auto& t : kTriangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

void append(Mesh& mesh, const Mesh& part, const Pose& X_MP) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  for (const auto& v : part.vertices) mesh.vertices.push_back((X_MP * v.cast<double>()).cast<float>());
  for (const auto& t : part.triangles) mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

Vec3 any_perpendicular(const Vec3& v) {
  int least = 0;
  v.cwiseAbs().minCoeff(&least);
  return v.cross(Vec3::Unit(least)).normalized();
}

Pose frame(const Vec3& origin, const Vec3& z, const Vec3& x) {
  Mat3 R;
  R.col(2) = z.normalized();
  R.col(0) = (x - x.dot(R.col(2)) * R.col(2)).normalized();
  R.col(1) = R.col(2).cross(R.col(0));
  return {origin, Quat(R)};
}

Pose frame(const Vec3& origin, const Vec3& z) { return frame(origin, z, any_perpendicular(z)); }

Mesh prism(int sides, double width, double height) {
  Mesh mesh;
  const Index bottom = add_ring(mesh, sides, circumradius(sides, width), 0);
  const Index top = add_ring(mesh, sides, circumradius(sides, width), height);
  add_band(mesh, sides, bottom, top);
  add_disc(mesh, sides, bottom, 0, false);
  add_disc(mesh, sides, top, height, true);
  return mesh;
}

Mesh cone(int sides, double radius, double height) {
  Mesh mesh;
  const Index base = add_ring(mesh, sides, radius, 0);
  add_disc(mesh, sides, base, 0, false);
  add_disc(mesh, sides, base, height, true);  // a disc with its centre lifted
  return mesh;
}

Mesh socket(int sides, double hole_width, double block_width, double depth, double floor) {
  Mesh mesh;
  const Index bottom = add_ring(mesh, sides, circumradius(sides, block_width), -floor);
  const Index rim = add_ring(mesh, sides, circumradius(sides, block_width), depth);
  const Index mouth = add_ring(mesh, sides, circumradius(sides, hole_width), depth);
  const Index hole = add_ring(mesh, sides, circumradius(sides, hole_width), 0);
  add_disc(mesh, sides, bottom, -floor, false);
  add_band(mesh, sides, bottom, rim);
  add_band(mesh, sides, rim, mouth);
  add_band(mesh, sides, mouth, hole);
  add_disc(mesh, sides, hole, 0, true);
  return mesh;
}

Mesh plate(const Outline& outline, const std::vector<Outline>& holes, double low, double high) {
  Mesh mesh;
  const auto add_level = [&](double z) {
    for (const Vec2& p : outline) add_vertex(mesh, p.x(), p.y(), z);
    for (const Outline& hole : holes) {
      for (const Vec2& p : hole) add_vertex(mesh, p.x(), p.y(), z);
    }
  };
  add_level(low);
  const auto up = static_cast<Index>(mesh.vertices.size());
  add_level(high);
  for (const auto& t : triangulate(outline, holes)) {
    mesh.triangles.push_back({t[0], t[2], t[1]});
    mesh.triangles.push_back({up + t[0], up + t[1], up + t[2]});
  }
  Index first = 0;
  const auto add_wall = [&](std::size_t size, bool outer) {
    const auto n = static_cast<Index>(size);
    for (Index i = 0; i < n; ++i) {
      const Index a = first + (outer ? i : (i + 1) % n), b = first + (outer ? (i + 1) % n : i);
      mesh.triangles.push_back({a, b, b + up});
      mesh.triangles.push_back({a, b + up, a + up});
    }
    first += n;
  };
  add_wall(outline.size(), true);
  for (const Outline& hole : holes) add_wall(hole.size(), false);
  return mesh;
}

Mesh lathe(const Outline& profile, int sides) {
  Mesh mesh;
  double twice_area = 0;
  std::vector<Index> first;  // of each corner's ring
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vec2 &p = profile[i], &q = profile[(i + 1) % profile.size()];
    twice_area += p.x() * q.y() - p.y() * q.x();
    first.push_back(static_cast<Index>(mesh.vertices.size()));
    if (p.x() == 0) {
      add_vertex(mesh, 0, 0, p.y());
      continue;
    }
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      add_vertex(mesh, p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  }
  const auto n = static_cast<Index>(sides);
  const auto add = [&](Index a, Index b, Index c) {
    mesh.triangles.push_back(twice_area > 0 ? std::array{a, b, c} : std::array{a, c, b});
  };
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const std::size_t j = (i + 1) % profile.size();
    const bool from_axis = profile[i].x() == 0, to_axis = profile[j].x() == 0;
    for (Index k = 0; k < n; ++k) {
      const Index next = (k + 1) % n;
      if (!from_axis) add(first[i] + k, first[i] + next, to_axis ? first[j] : first[j] + next);
      if (!to_axis) add(from_axis ? first[i] : first[i] + k, first[j] + next, first[j] + k);
    }
  }
  return mesh;
}

Mesh loft(const std::vector<std::vector<Vec3>>& rings) {
  Mesh mesh;
  const auto sides = static_cast<int>(rings.front().size());
  std::vector<Index> first;
  for (const auto& ring : rings) first.push_back(add_points(mesh, ring));
  for (std::size_t i = 1; i < rings.size(); ++i) add_band(mesh, sides, first[i - 1], first[i]);
  add_fan(mesh, rings.front(), first.front(), false);
  add_fan(mesh, rings.back(), first.back(), true);
  return mesh;
}

Mesh bevelled(const Outline& outline, double height, double bevel) {
  std::vector<std::vector<Vec3>> rings(4);
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 &p = outline[i], in = (p - outline[(i + n - 1) % n]).normalized(),
               to = (outline[(i + 1) % n] - p).normalized();
    const Vec2 mean(-(in + to).y(), (in + to).x());  // inward, of length 2 cos(half the turn)
    const Vec2 inner = p + 2 * bevel * mean / mean.squaredNorm();
    rings[0].emplace_back(inner.x(), inner.y(), 0);
    rings[1].emplace_back(p.x(), p.y(), bevel);
    rings[2].emplace_back(p.x(), p.y(), height - bevel);
    rings[3].emplace_back(inner.x(), inner.y(), height);
  }
  return loft(rings);
}

}  // namespace tact::shapes
