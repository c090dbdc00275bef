#include "contact/bake/worker/crossings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "test_meshes.hpp"

namespace tact::contact {
namespace {

TrianglePairs crossings_of(const Mesh& mesh) {
  return find_crossings(mesh, std::vector<std::uint32_t>(mesh.triangles.size(), 1), Surface(mesh), {});
}

Mesh turned(Mesh mesh, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond R =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
  const Vec3 p(normal(random), normal(random), normal(random));
  for (auto& v : mesh.vertices) v = (R * (v.cast<double>() + p)).cast<float>();
  return mesh;
}

/// A straight pipe about z, of rings `pitch` apart.
Mesh pipe_mesh(double radius, std::uint32_t rings, double pitch) {
  constexpr std::uint32_t kAround = 16;
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const double a = 2 * M_PI * j / kAround;
      test::add(mesh, Vec3(radius * std::cos(a), radius * std::sin(a), pitch * i));
    }
  }
  for (std::uint32_t i = 0; i + 1 < rings; ++i) {
    for (std::uint32_t j = 0; j < kAround; ++j) {
      const std::uint32_t a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      mesh.triangles.push_back({a, b, b + kAround});
      mesh.triangles.push_back({a, b + kAround, a + kAround});
    }
  }
  return mesh;
}

bool sides_differ(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& q) {
  const Vec3 n = (b - a).cross(c - a);
  return (n.dot(p - a) > 0) != (n.dot(q - a) > 0);
}

/// In general position: the ends are on two sides of the plane, and the line winds round the three sides alike.
bool pierces(const std::array<Vec3, 3>& t, const Vec3& p, const Vec3& q) {
  if (!sides_differ(t[0], t[1], t[2], p, q)) return false;
  const auto winds = [&](std::size_t k) { return (q - p).dot((t[k] - p).cross(t[(k + 1) % 3] - p)) > 0; };
  return winds(0) == winds(1) && winds(1) == winds(2);
}

TEST(FindCrossings, AnEdgeInThePlaneOfAFarTriangleDoesNotMeetIt) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) EXPECT_TRUE(crossings_of(turned(pipe_mesh(0.01, 40, 0.03), random)).empty());
}

TEST(FindCrossings, RandomTrianglesCrossWhereBruteForceSaysSo) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  Mesh mesh;
  for (int i = 0; i < 500; ++i) {
    const Vec3 middle = point();
    const std::uint32_t first = test::add(mesh, middle + 0.2 * point());
    test::add(mesh, middle + 0.2 * point());
    test::add(mesh, middle + 0.2 * point());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const auto corners = [&](const auto& t) {
    return std::array<Vec3, 3>{mesh.vertices[t[0]].template cast<double>(), mesh.vertices[t[1]].template cast<double>(),
                               mesh.vertices[t[2]].template cast<double>()};
  };
  TrianglePairs expected;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t j = 0; j < mesh.triangles.size(); ++j) {
      const auto a = corners(mesh.triangles[i]), b = corners(mesh.triangles[j]);
      bool cross = false;
      for (std::size_t k = 0; k < 3; ++k) {
        cross = cross || pierces(a, b[k], b[(k + 1) % 3]) || pierces(b, a[k], a[(k + 1) % 3]);
      }
      if (i != j && cross) expected.emplace_back(i, j);
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(crossings_of(mesh), expected);
}

TEST(FindCrossings, ATriangleTouchedByACornerIsFoundAndOneMissedByAThousandthIsNot) {
  std::mt19937 random(3);
  for (const double gap : {0.0, 1e-3}) {
    Mesh mesh;
    for (const Vec3& p : {Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(0, 1, 0)}) test::add(mesh, p);
    for (const Vec3& p : {Vec3(0, 0, gap), Vec3(-0.5, 0.1, 1), Vec3(0.5, 0.1, 1)}) test::add(mesh, p);
    mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
    for (int i = 0; i < 100; ++i) EXPECT_EQ(crossings_of(turned(mesh, random)).size(), gap > 0 ? 0u : 2u);
  }
}

}  // namespace
}  // namespace tact::contact
