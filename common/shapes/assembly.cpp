#include "shapes/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tact::shapes {
namespace {

/// Radius of a regular hexagon of `across` flats in the direction of an angle.
double hexagon(double across, double angle) {
  const double sixth = std::numbers::pi / 3;
  return across / 2 / std::cos(angle - sixth * std::round(angle / sixth));
}

}  // namespace

int Assembly::sides(double radius) const {
  return std::clamp(static_cast<int>(std::ceil(2 * std::numbers::pi * radius / edge_)), 8, 720);
}

void Assembly::turned(const Outline& profile, const Pose& X, double corner_radius) {
  double widest = 0;
  for (const Vec2& p : profile) widest = std::max(widest, p.x());
  add(lathe(corner_radius > 0 ? rounded_profile(profile, corner_radius, edge_) : profile, sides(widest)), X);
}

void Assembly::bar(const Vec3& from, const Vec3& to, double radius) {
  const double end = (to - from).norm(), bevel = std::min({1.0, 0.2 * radius, 0.2 * end});
  turned({{0, 0}, {radius - bevel, 0}, {radius, bevel}, {radius, end - bevel}, {radius - bevel, end}, {0, end}},
         frame(from, to - from));
}

void Assembly::block(const Vec3& lowest, const Vec3& highest, int axis, double radius, double bevel) {
  const Vec3 size = highest - lowest, middle = (lowest + highest) / 2;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const Vec2 half(size[u] / 2, size[v] / 2);
  Vec3 origin = middle;
  origin[axis] = lowest[axis];
  add(bevelled(rounded(rectangle(-half, half), radius, edge_), size[axis], bevel),
      frame(origin, Vec3::Unit(axis), Vec3::Unit(u)));
}

void Assembly::pipe(const Path& corners, double bend_radius, double radius) {
  add(tube(pipe_path(corners, bend_radius, edge_), radius, sides(radius)));
}

void Assembly::bellows(const Path& corners, double bend_radius, double radius, double rib, double pitch) {
  const Path path = pipe_path(corners, bend_radius, pitch / 6);
  add(tube(
      path, [&](double s) { return radius + rib * (0.5 - 0.5 * std::cos(2 * std::numbers::pi * s / pitch)); },
      sides(radius)));
}

void Assembly::cable(const Path& points, double radius) { add(tube(cable_path(points, edge_), radius, sides(radius))); }

void Assembly::bundle(const Path& points, double radius, int count, double twist_per_mm) {
  const Path path = cable_path(points, edge_);
  const double apart = 2.35 * radius;  // twisted strands are nearer than they look in a section
  add(tube(path, radius, sides(radius)));
  for (int ring = 1, done = 1; done < count; ++ring) {
    const int here = std::min(6 * ring, count - done);
    for (int i = 0; i < here; ++i) {
      add(tube(strand(path, apart * ring, 2 * std::numbers::pi * i / (6 * ring), twist_per_mm), radius, sides(radius)));
    }
    done += here;
  }
}

void Assembly::bolt(const Vec3& at, const Vec3& out, double size, bool stud) {
  constexpr int kSides = 24;
  const double across = 1.6 * size, washer = 1.05 * size, thick = 0.2 * size, head = 0.7 * size;
  std::vector<std::vector<Vec3>> rings;
  const auto add_ring = [&](double z, double circle, bool hexagonal) {
    std::vector<Vec3> ring;
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      const double r = hexagonal ? std::min(circle, hexagon(across, angle)) : circle;
      ring.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    }
    rings.push_back(std::move(ring));
  };
  add_ring(0, washer, false);
  add_ring(thick, washer, false);
  add_ring(thick, 0.95 * washer, true);
  add_ring(thick + 0.85 * head, 0.95 * washer, true);
  add_ring(thick + head, 0.46 * across, false);
  if (stud) {
    add_ring(thick + head, 0.5 * size, false);
    add_ring(thick + 1.6 * head, 0.5 * size, false);
    add_ring(thick + 1.7 * head, 0.42 * size, false);
  }
  add(loft(rings), frame(at + kSeam_mm * out.normalized(), out));
}

void Assembly::plug(const Vec3& at, const Vec3& out, double radius, double height) {
  Outline profile{{0, 0}, {0.8 * radius, 0}, {radius, 0.15 * height}};
  for (int i = 0; i < 3; ++i) {
    const double z = (0.25 + 0.15 * i) * height;
    profile.insert(profile.end(), {{radius, z},
                                   {0.88 * radius, z + 0.03 * height},
                                   {0.88 * radius, z + 0.1 * height},
                                   {radius, z + 0.13 * height}});
  }
  profile.insert(profile.end(), {{0.7 * radius, 0.8 * height}, {0.5 * radius, height}, {0, height}});
  turned(profile, frame(at + kSeam_mm * out.normalized(), out));
}

Mesh Assembly::take() {
  for (auto& v : mesh_.vertices) v *= 1e-3f;
  return std::move(mesh_);
}

}  // namespace tact::shapes
