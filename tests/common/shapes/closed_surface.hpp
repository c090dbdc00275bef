#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace tact {

/// Each directed edge occurs once and its reverse once: closed and consistently oriented.
inline void expect_closed(const Mesh& mesh, const std::string& name) {
  std::vector<std::array<std::uint32_t, 2>> forward, backward;
  for (const auto& t : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      forward.push_back({t[i], t[(i + 1) % 3]});
      backward.push_back({t[(i + 1) % 3], t[i]});
    }
  }
  std::sort(forward.begin(), forward.end());
  std::sort(backward.begin(), backward.end());
  EXPECT_EQ(std::adjacent_find(forward.begin(), forward.end()), forward.end()) << name;
  EXPECT_TRUE(forward == backward) << name;
}

/// By the divergence theorem; positive when oriented outward.
inline double volume(const Mesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]].cast<double>(), b = mesh.vertices[t[1]].cast<double>(),
               c = mesh.vertices[t[2]].cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

}  // namespace tact
