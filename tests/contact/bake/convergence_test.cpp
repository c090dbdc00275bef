#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/triangle.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

using Distance = std::function<double(const Vec3&)>;

struct Rms {
  double value_m = 0, normal = 0;
};

/// Errors in a layer of fixed width about the surface, at the same places whatever the voxel.
Rms rms_error(const Mesh& mesh, int resolution, double layer_m, const Distance& distance) {
  FieldReport report;
  const DistanceField field = make_field(bake_field(clean_soup(mesh), {resolution, 4, 0}, {}, report));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::AlignedBox3f box;
  for (const auto& v : mesh.vertices) box.extend(v);
  const Vec3 low = box.min().cast<double>() - Vec3::Constant(layer_m),
             size = box.sizes().cast<double>() + Vec3::Constant(2 * layer_m);
  Rms rms;
  int samples = 0;
  while (samples < 4000) {
    const Vec3 p = low + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(size);
    const double exact = distance(p);
    if (std::fabs(exact) > layer_m) continue;
    const double e = 1e-6;
    Vec3 n;
    for (int k = 0; k < 3; ++k) n[k] = (distance(p + e * Vec3::Unit(k)) - distance(p - e * Vec3::Unit(k))) / (2 * e);
    const auto s = field.sample(p);
    rms.value_m += (s.value_m - exact) * (s.value_m - exact);
    rms.normal += (s.gradient - n).squaredNorm();
    ++samples;
  }
  return {std::sqrt(rms.value_m / samples), std::sqrt(rms.normal / samples)};
}

struct Orders {
  double value, normal;
};

Orders orders(const Mesh& mesh, int coarse, const Distance& distance, double layer_m) {
  const Rms a = rms_error(mesh, coarse, layer_m, distance), b = rms_error(mesh, 2 * coarse, layer_m, distance);
  const Orders o{std::log2(a.value_m / b.value_m), std::log2(a.normal / b.normal)};
  ::testing::Test::RecordProperty("value_order", std::to_string(o.value));
  ::testing::Test::RecordProperty("normal_order", std::to_string(o.normal));
  std::printf("order of the value %.2f, of the normal %.2f\n", o.value, o.normal);
  return o;
}

TEST(Convergence, SmoothBodiesAreOfSecondOrderAndTheirNormalsOfFirst) {
  const Orders sphere = orders(
      test::sphere_mesh(Vec3(0.001, 0.002, 0.003), 0.02, 200), 24,
      [](const Vec3& p) { return (p - Vec3(0.001, 0.002, 0.003)).norm() - 0.02; }, 0.002);
  EXPECT_GT(sphere.value, 1.7);
  EXPECT_GT(sphere.normal, 0.9);
  const Orders torus = orders(
      test::torus_mesh(0.04, 0.015, 300, 150), 40, [](const Vec3& p) { return test::torus_distance(p, 0.04, 0.015); },
      0.004);
  EXPECT_GT(torus.value, 1.7);
  EXPECT_GT(torus.normal, 0.9);
}

/// Sharp edges are rounded within a voxel: the share of such places, too, falls with it.
TEST(Convergence, BodiesWithEdgesAreOfMoreThanFirstOrder) {
  const Vec3 low(-0.0103, -0.0207, 0.0051), high(0.0401, 0.0099, 0.0303);
  const Orders box = orders(
      test::box_mesh(low, high), 32, [&](const Vec3& p) { return test::box_distance(p, low, high); }, 0.003);
  EXPECT_GT(box.value, 1.3);
  EXPECT_GT(box.normal, 0.3);
  const Orders cylinder = orders(
      test::cylinder_mesh(0.02, 0.03, 720), 32, [](const Vec3& p) { return test::cylinder_distance(p, 0.02, 0.03); },
      0.003);
  EXPECT_GT(cylinder.value, 1.3);
  EXPECT_GT(cylinder.normal, 0.3);
}

/// Two tetrahedra on either side of a common face, one leaning over: not convex.
TEST(Convergence, TwoTetrahedraAsAgainstBruteForce) {
  const Vec3 v[5] = {{0, 0, 0}, {0.04, 0.003, 0}, {0.012, 0.035, 0.002}, {0.05, 0.04, 0.03}, {0.01, 0.012, -0.03}};
  Mesh mesh;
  for (const Vec3& p : v) test::add(mesh, p);
  mesh.triangles = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
  std::vector<Triangle> triangles;
  for (const auto& t : mesh.triangles) {
    triangles.emplace_back(mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(),
                           mesh.vertices[t[2]].cast<double>());
  }
  const auto in_tetrahedron = [&](const Vec3& p, int apex) {
    const int corners[4] = {0, 1, 2, apex};
    for (int i = 0; i < 4; ++i) {
      const Vec3 &a = v[corners[(i + 1) % 4]], &b = v[corners[(i + 2) % 4]], &c = v[corners[(i + 3) % 4]];
      const Vec3 n = (b - a).cross(c - a);
      if (n.dot(p - a) * n.dot(v[corners[i]] - a) < 0) return false;
    }
    return true;
  };
  const auto distance = [&](const Vec3& p) {
    double square = 1;
    for (const Triangle& t : triangles) square = std::min(square, t.square_distance(p));
    return in_tetrahedron(p, 3) || in_tetrahedron(p, 4) ? -std::sqrt(square) : std::sqrt(square);
  };
  const Orders o = orders(mesh, 40, distance, 0.002);
  EXPECT_GT(o.value, 1.0);
  EXPECT_GT(o.normal, 0.2);
}

}  // namespace
}  // namespace tact::contact
