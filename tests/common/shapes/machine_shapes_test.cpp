#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "shapes/engine.hpp"
#include "shapes/landing_gear.hpp"
#include "shapes/shapes.hpp"

namespace tact {
namespace {

double longest_side(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& v : mesh.vertices) box.extend(v);
  return static_cast<double>(box.sizes().maxCoeff());
}

/// Along rays on a grid across `axis` the surface is entered and left in turns: how often that fails, beyond rounding.
/// It fails where two closed parts overlap, and where one is inside out.
int overlaps(const Mesh& mesh, int axis, int grid) {
  struct Crossing {
    float at;
    int in;  // 1: into the body, -1: out of it
  };
  Eigen::AlignedBox3d box;
  for (const auto& v : mesh.vertices) box.extend(v.cast<double>());
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const double du = box.sizes()[u] / grid, dv = box.sizes()[v] / grid;
  const auto at_u = [&](int i) { return box.min()[u] + (i + 0.5137) * du; };  // odd: no ray along an edge of the parts
  const auto at_v = [&](int j) { return box.min()[v] + (j + 0.5291) * dv; };
  std::vector<std::vector<Crossing>> rays(static_cast<std::size_t>(grid) * static_cast<std::size_t>(grid));
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
               c = mesh.vertices[t[2]].cast<double>();
    const double twice = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    if (twice == 0) continue;
    const auto first = [grid](double lowest, double from, double step) {
      return std::clamp(static_cast<int>((lowest - from) / step) - 1, 0, grid);
    };
    const auto last = [grid](double highest, double from, double step) {
      return std::clamp(static_cast<int>((highest - from) / step) + 1, 0, grid);
    };
    const int i1 = last(std::max({a[u], b[u], c[u]}), box.min()[u], du),
              j1 = last(std::max({a[v], b[v], c[v]}), box.min()[v], dv);
    for (int i = first(std::min({a[u], b[u], c[u]}), box.min()[u], du); i < i1; ++i) {
      for (int j = first(std::min({a[v], b[v], c[v]}), box.min()[v], dv); j < j1; ++j) {
        const double x = at_u(i) - a[u], y = at_v(j) - a[v];
        const double p = (x * (c[v] - a[v]) - y * (c[u] - a[u])) / twice,
                     q = ((b[u] - a[u]) * y - (b[v] - a[v]) * x) / twice;
        if (p < 0 || q < 0 || p + q > 1) continue;
        rays[static_cast<std::size_t>(i) * static_cast<std::size_t>(grid) + static_cast<std::size_t>(j)].push_back(
            {static_cast<float>(a[axis] + p * (b[axis] - a[axis]) + q * (c[axis] - a[axis])), twice > 0 ? -1 : 1});
      }
    }
  }
  int found = 0;
  for (auto& ray : rays) {
    std::sort(ray.begin(), ray.end(), [](const Crossing& a, const Crossing& b) { return a.at < b.at; });
    int depth = 0;
    for (std::size_t k = 0; k < ray.size(); ++k) {
      depth += ray[k].in;
      const bool lasts = k + 1 == ray.size() || ray[k + 1].at - ray[k].at > 2e-5f;
      found += lasts && (depth < 0 || depth > 1) ? 1 : 0;
    }
  }
  return found;
}

struct Machine {
  const char* name;
  std::size_t triangles;  ///< of the paper's model
  double longest_m;       ///< 0: not stated there
};
constexpr Machine kMachines[] = {
    {"engine-bay", 505276, 0.92}, {"starter", 18580, 0}, {"landing-gear", 1789551, 2.87}, {"actuator", 25191, 0}};

TEST(MachineShapes, HaveTheSizeOfThePapersModels) {
  for (const Machine& m : kMachines) {
    const Mesh mesh = make_shape(m.name, {});
    const double triangles = static_cast<double>(m.triangles);
    EXPECT_NEAR(static_cast<double>(mesh.triangles.size()), triangles, 0.02 * triangles) << m.name;
    if (m.longest_m > 0) {
      EXPECT_NEAR(longest_side(mesh), m.longest_m, 1e-3) << m.name;
    }
  }
}

TEST(MachineShapes, AreMadeOfPartsThatDoNotOverlap) {
  for (const Machine& m : kMachines) {
    const Mesh mesh = make_shape(m.name, {});
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(overlaps(mesh, axis, 400), 0) << m.name << " axis " << axis;
  }
}

TEST(MachineShapes, OverlappingPartsWouldBeFound) {
  Mesh two = make_shape("box", {});
  const auto n = static_cast<std::uint32_t>(two.vertices.size());
  for (const auto& v : make_shape("box", {}).vertices) two.vertices.push_back(v + Eigen::Vector3f(0.04f, 0, 0));
  for (const auto& t : make_shape("box", {}).triangles) two.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  EXPECT_GT(overlaps(two, 1, 50), 0);
  EXPECT_EQ(overlaps(make_shape("box", {}), 1, 50), 0);
}

TEST(MachineShapes, ActuatorFitsBetweenTheLugs) {
  const Vec3 upper = shapes::LandingGear::upper_pin(), lower = shapes::LandingGear::lower_pin();
  EXPECT_NEAR(shapes::Actuator::length_m(), (lower - upper).norm(), 1e-12);
  EXPECT_NEAR(shapes::LandingGear::approach().dot(lower - upper), 0, 1e-12);
}

}  // namespace
}  // namespace tact
