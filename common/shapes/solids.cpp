#include "shapes/solids.hpp"

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

}  // namespace tact::shapes
