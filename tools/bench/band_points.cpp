#include "bench/band_points.hpp"

#include <random>

namespace tact::bench {

std::vector<Vec3> points_near(const Mesh& mesh, double reach_m, std::size_t count, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto corner = [&](std::size_t triangle, std::size_t k) -> Vec3 {
    return mesh.vertices[mesh.triangles[triangle][k]].cast<double>();
  };
  std::vector<double> area;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Vec3 a = corner(t, 0);
    area.push_back((corner(t, 1) - a).cross(corner(t, 2) - a).norm());
  }
  std::discrete_distribution<std::size_t> any_triangle(area.begin(), area.end());
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t = any_triangle(rng);
    double u = unit(rng), v = unit(rng);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 a = corner(t, 0);
    const Vec3 off = reach_m * Vec3(2 * unit(rng) - 1, 2 * unit(rng) - 1, 2 * unit(rng) - 1);
    points.push_back(a + u * (corner(t, 1) - a) + v * (corner(t, 2) - a) + off);
  }
  return points;
}

}  // namespace tact::bench
