#include "contact/bake/worker/triangle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "contact/bake/worker/block_distances.hpp"
#include "field/field_builder.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

/// Least squares by brute force over barycentric coordinates, refined.
double reference(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) {
  double best = 1e300, bu = 0, bv = 0, width = 1;
  for (int round = 0; round < 12; ++round) {
    const double u0 = bu, v0 = bv;
    for (int i = -20; i <= 20; ++i) {
      for (int j = -20; j <= 20; ++j) {
        const double u = std::clamp(u0 + width * i / 20, 0.0, 1.0);
        const double v = std::clamp(v0 + width * j / 20, 0.0, 1.0 - u);
        const double d = (a + u * (b - a) + v * (c - a) - p).squaredNorm();
        if (d < best) {
          best = d;
          bu = u;
          bv = v;
        }
      }
    }
    width *= 0.2;
  }
  return std::sqrt(best);
}

TEST(Triangle, DistanceIsThatOfBruteForce) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const auto point = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = point(), b = point(), c = i % 3 == 0 ? Vec3(a + 1e-4 * point()) : point(), p = 2 * point();
    EXPECT_NEAR(std::sqrt(Triangle(a, b, c).square_distance(p)), reference(a, b, c, p), 1e-5);
  }
}

TEST(Triangle, WithoutAreaItIsItsEdges) {
  const Vec3 a(0, 0, 0), b(1, 0, 0), c(0.4, 0, 0);
  EXPECT_NEAR(Triangle(a, b, c).square_distance(Vec3(0.5, 2, 0)), 4, 1e-12);
  EXPECT_NEAR(Triangle(a, a, a).square_distance(Vec3(3, 4, 0)), 25, 1e-12);
}

TEST(Triangle, ManyPointsAtOnceGiveTheSame) {
  const Triangle t(Vec3(0, 0, 0), Vec3(1, 0.2, 0), Vec3(0.3, 1, 0.5));
  const Vec3 base(0.7, -0.4, 0.2);
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  std::vector<float> x(101), y(101), z(101), best(101, 1e9f);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = normal(random), y[i] = normal(random), z[i] = normal(random);
  best[7] = 0;
  lower_square_distances(SmallTriangle(t), base, x.data(), y.data(), z.data(), x.size(), best.data());
  EXPECT_EQ(best[7], 0);
  for (std::size_t i = 8; i < x.size(); ++i) {
    const double square = t.square_distance(base + Eigen::Vector3f(x[i], y[i], z[i]).cast<double>());
    EXPECT_NEAR(static_cast<double>(best[i]), square, 1e-6 * (1 + square));
  }
}

TEST(Triangle, BallsBoundTheDistances) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<float> x, y, z, radius, low(50);
  for (int i = 0; i < 50; ++i) {
    x.push_back(normal(random));
    y.push_back(normal(random));
    z.push_back(normal(random));
    radius.push_back(0.1f);
  }
  const float p[3] = {0.1f, 0.2f, 0.3f};
  const float least = bound_distances(x.data(), y.data(), z.data(), radius.data(), 50, p, low.data());
  float wanted = 1e9f;
  for (std::size_t i = 0; i < 50; ++i) {
    const float d = (Eigen::Vector3f(x[i], y[i], z[i]) - Eigen::Vector3f(p[0], p[1], p[2])).norm();
    EXPECT_NEAR(low[i], d - 0.1f, 1e-6f);
    wanted = std::min(wanted, d);
  }
  EXPECT_NEAR(least, wanted, 1e-6f);
}

TEST(BlockDistances, EqualTheMinimumOverAllTriangles) {
  const Mesh mesh = test::torus_mesh(0.04, 0.015, 60, 30);
  const Surface surface(mesh);
  const FieldGrid grid = make_grid(Vec3(-0.055, -0.055, -0.015), Vec3(0.055, 0.055, 0.015), 0.002);
  BlockDistances blocks(surface, grid);
  std::array<float, kBlockValues> values;
  const double limit = 0.012;
  for (const auto& b : {std::array{0, 0, 0}, {4, 2, 1}, {5, 4, 2}, {7, 4, 1}}) {
    blocks.compute(b[0], b[1], b[2], limit, values);
    for (int i = 0; i < kBlockValues; i += 5) {
      const Vec3 p = grid.corner_O(8 * b[0] + i % 9, 8 * b[1] + i / 9 % 9, 8 * b[2] + i / 81) - surface.middle();
      double square = limit * limit;
      for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        square = std::min(square, surface.triangle(t).square_distance(p));
      }
      EXPECT_NEAR(values[static_cast<std::size_t>(i)], std::sqrt(square), 2e-8);  // 1e-7 of the size
    }
  }
}

}  // namespace
}  // namespace tact::contact
