#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "mesh/mesh.hpp"

/// Bodies with closed forms, and ways to spoil them as CAD exporters do.
namespace tact::test {

inline std::uint32_t add(Mesh& mesh, const Vec3& p) {
  mesh.vertices.push_back(p.cast<float>());
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

inline void append(Mesh& to, const Mesh& from) {
  const auto base = static_cast<std::uint32_t>(to.vertices.size());
  to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
  for (const auto& t : from.triangles) to.triangles.push_back({base + t[0], base + t[1], base + t[2]});
}

/// Twelve triangles, outward.
inline Mesh box_mesh(const Vec3& low, const Vec3& high) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i) {
    add(mesh, Vec3((i & 1) ? high.x() : low.x(), (i & 2) ? high.y() : low.y(), (i & 4) ? high.z() : low.z()));
  }
  for (const auto& q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    const auto v = [&](int i) { return static_cast<std::uint32_t>(q[static_cast<std::size_t>(i)]); };
    mesh.triangles.push_back({v(0), v(1), v(2)});
    mesh.triangles.push_back({v(0), v(2), v(3)});
  }
  return mesh;
}

/// A closed surface over (u, v), both periodic in [0, n) x [0, m).
template <class F>
Mesh periodic_mesh(std::uint32_t n, std::uint32_t m, F&& point) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) add(mesh, point(i, j));
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < m; ++j) {
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return (a % n) * m + b % m; };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// Torus about z.
inline Mesh torus_mesh(double ring, double tube, std::uint32_t n, std::uint32_t m) {
  return periodic_mesh(n, m, [&](std::uint32_t i, std::uint32_t j) {
    const double u = 2 * M_PI * i / n, v = 2 * M_PI * j / m;
    const double r = ring + tube * std::cos(v);
    return Vec3(r * std::cos(u), r * std::sin(u), tube * std::sin(v));
  });
}

/// Sphere from poles and rings.
inline Mesh sphere_mesh(const Vec3& centre, double radius, std::uint32_t rings) {
  Mesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double a = M_PI * i / rings, b = 2 * M_PI * j / around;
      add(mesh, centre + radius * Vec3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
    }
  }
  const std::uint32_t top = add(mesh, centre + radius * Vec3::UnitZ()),
                      bottom = add(mesh, centre - radius * Vec3::UnitZ());
  for (std::uint32_t j = 0; j < around; ++j) {
    const std::uint32_t k = (j + 1) % around;
    mesh.triangles.push_back({top, j, k});
    for (std::uint32_t i = 0; i + 2 < rings; ++i) {
      const std::uint32_t a = i * around, b = a + around;
      mesh.triangles.push_back({a + j, b + j, b + k});
      mesh.triangles.push_back({a + j, b + k, a + k});
    }
    const std::uint32_t last = (rings - 2) * around;
    mesh.triangles.push_back({bottom, last + k, last + j});
  }
  return mesh;
}

/// Cylinder about z from -half_height to half_height.
inline Mesh cylinder_mesh(double radius, double half_height, std::uint32_t n) {
  Mesh mesh;
  for (std::uint32_t j = 0; j < n; ++j) {
    const double a = 2 * M_PI * j / n;
    add(mesh, Vec3(radius * std::cos(a), radius * std::sin(a), -half_height));
    add(mesh, Vec3(radius * std::cos(a), radius * std::sin(a), half_height));
  }
  const std::uint32_t bottom = add(mesh, Vec3(0, 0, -half_height)), top = add(mesh, Vec3(0, 0, half_height));
  for (std::uint32_t j = 0; j < n; ++j) {
    const std::uint32_t a = 2 * j, b = 2 * ((j + 1) % n);
    mesh.triangles.push_back({a, b, b + 1});
    mesh.triangles.push_back({a, b + 1, a + 1});
    mesh.triangles.push_back({bottom, b, a});
    mesh.triangles.push_back({top, a + 1, b + 1});
  }
  return mesh;
}

/// Every triangle gets corners of its own.
inline Mesh unwelded(const Mesh& mesh) {
  Mesh soup;
  for (const auto& t : mesh.triangles) {
    const auto base = static_cast<std::uint32_t>(soup.vertices.size());
    for (const auto i : t) soup.vertices.push_back(mesh.vertices[i]);
    soup.triangles.push_back({base, base + 1, base + 2});
  }
  return soup;
}

/// Every triangle a second time, the other way round.
inline Mesh doubly_faced(const Mesh& mesh) {
  Mesh both = mesh;
  for (const auto& t : mesh.triangles) both.triangles.push_back({t[2], t[1], t[0]});
  return both;
}

/// One triangle in `k` missing, anywhere.
inline Mesh torn(const Mesh& mesh, int k, unsigned seed) {
  Mesh rest = mesh;
  std::mt19937 random(seed);
  std::erase_if(rest.triangles, [&](const auto&) { return random() % static_cast<unsigned>(k) == 0; });
  return rest;
}

/// Every k-th triangle the other way round.
inline Mesh flipped(const Mesh& mesh, std::size_t k) {
  Mesh mixed = mesh;
  for (std::size_t i = 0; i < mixed.triangles.size(); i += k) std::swap(mixed.triangles[i][0], mixed.triangles[i][1]);
  return mixed;
}

inline double box_distance(const Vec3& p, const Vec3& low, const Vec3& high) {
  const Vec3 q = (p - 0.5 * (low + high)).cwiseAbs() - 0.5 * (high - low);
  return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff());
}
inline double torus_distance(const Vec3& p, double ring, double tube) {
  return std::hypot(std::hypot(p.x(), p.y()) - ring, p.z()) - tube;
}
inline double cylinder_distance(const Vec3& p, double radius, double half_height) {
  const Eigen::Vector2d q(std::hypot(p.x(), p.y()) - radius, std::fabs(p.z()) - half_height);
  return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff());
}

}  // namespace tact::test
