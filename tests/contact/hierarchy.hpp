#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "contact/contact_set.hpp"
#include "contact/model/pointshell.hpp"

namespace tact::contact::test {

/// A nested shell over any points: level l takes the next 4^l * roots points, each under its nearest node above.
inline Pointshell make_hierarchy(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, std::size_t roots,
                                 std::size_t levels) {
  Pointshell s;
  std::vector<std::uint32_t> parent;
  std::size_t taken = 0, wanted = roots;
  s.level_begin.push_back(0);
  for (std::size_t level = 0; level < levels && taken < points.size(); ++level, wanted *= 4) {
    const std::size_t count = level + 1 == levels ? points.size() - taken : std::min(wanted, points.size() - taken);
    std::vector<std::size_t> order(count);
    std::vector<std::uint32_t> under(count, 0);
    std::iota(order.begin(), order.end(), 0u);
    if (level > 0) {
      for (std::size_t k = 0; k < count; ++k) {
        double nearest = 1e300;
        for (std::uint32_t j = s.level_begin[level - 1]; j < s.level_begin[level]; ++j) {
          const double d = (s.position_T[j].cast<double>() - points[taken + k]).norm();
          if (d < nearest) nearest = d, under[k] = j;
        }
      }
      std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return under[a] < under[b]; });
    }
    for (const std::size_t k : order) {
      s.position_T.push_back(points[taken + k].cast<float>());
      s.normal_T.push_back(normals[taken + k].normalized().cast<float>());
      parent.push_back(under[k]);
    }
    taken += count;
    s.level_begin.push_back(static_cast<std::uint32_t>(taken));
  }
  s.radius_m.assign(taken, 0.f);
  s.area_m2.assign(taken, 1e-6f);
  s.child_begin.assign(taken, 0);
  s.child_end.assign(taken, 0);
  for (std::size_t level = s.level_begin.size() - 2; level > 0; --level) {
    for (std::uint32_t i = s.level_begin[level]; i < s.level_begin[level + 1]; ++i) {
      const std::uint32_t p = parent[i];
      if (s.child_end[p] == 0) s.child_begin[p] = i;
      s.child_end[p] = i + 1;
      std::uint32_t ancestor = i;
      for (std::size_t up = level; up > 0; --up) {
        ancestor = parent[ancestor];
        const float d = (s.position_T[i] - s.position_T[ancestor]).norm();
        s.radius_m[ancestor] = std::max(s.radius_m[ancestor], d * (1 + 1e-6f));
      }
    }
  }
  for (const auto& p : s.position_T) s.bounding_radius_m = std::max(s.bounding_radius_m, static_cast<double>(p.norm()));
  return s;
}

/// Points on a sphere about To, normals inward.
inline Pointshell sphere_shell(std::mt19937& rng, std::size_t n, double radius, std::size_t levels = 6) {
  std::vector<Vec3> points, normals;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 u = random_unit(rng);
    points.push_back(radius * u);
    normals.push_back(-u);
  }
  return make_hierarchy(points, normals, 6, levels);
}

/// Points on the faces of a cube about To, normals inward.
inline Pointshell cube_shell(std::mt19937& rng, std::size_t n, double half, std::size_t levels = 6) {
  std::vector<Vec3> points, normals;
  for (std::size_t i = 0; i < n; ++i) {
    const auto axis = static_cast<Eigen::Index>(i % 3);
    const double sign = (i / 3) % 2 == 0 ? 1 : -1;
    Vec3 p(uniform(rng, -half, half), uniform(rng, -half, half), uniform(rng, -half, half));
    p[axis] = sign * half;
    points.push_back(p);
    normals.push_back(-sign * Vec3::Unit(axis));
  }
  return make_hierarchy(points, normals, 6, levels);
}

}  // namespace tact::contact::test
