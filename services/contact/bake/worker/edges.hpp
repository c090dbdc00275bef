#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <tuple>
#include <vector>

namespace tact::contact {

using Index3 = std::array<std::uint32_t, 3>;

/// One side of a triangle.
struct Edge {
  std::uint32_t a, b;  ///< a < b
  std::uint32_t triangle;
  bool forward;  ///< the triangle runs from a to b
};

/// All sides of all triangles, those of one edge side by side.
inline std::vector<Edge> edges_of(const std::vector<Index3>& triangles) {
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, a < b});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) {
    return std::tie(x.a, x.b, x.triangle) < std::tie(y.a, y.b, y.triangle);
  });
  return edges;
}

/// Calls visit(first, last) with the triangles round each edge.
template <class Visit>
void for_each_edge(const std::vector<Edge>& edges, Visit&& visit) {
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t j = i;
    while (j < edges.size() && edges[i].a == edges[j].a && edges[i].b == edges[j].b) ++j;
    visit(edges.data() + i, edges.data() + j);
    i = j;
  }
}

}  // namespace tact::contact
