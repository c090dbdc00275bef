#include "contact/bake/worker/soup.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <unordered_map>

#include "contact/bake/worker/edges.hpp"
#include "contact/bake/worker/union_find.hpp"

namespace tact::contact {
namespace {

constexpr double kSeam = 5e-5;  ///< of the size: a twentieth of a voxel of the finest usual grid

/// Merges vertices nearer than `tolerance`: maps each to the first of its kind.
std::vector<std::uint32_t> weld(const std::vector<Eigen::Vector3f>& vertices, double tolerance) {
  const auto cell = [&](const Eigen::Vector3f& p, int axis, double offset) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(p[axis]) / (2 * tolerance) + offset));
  };
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ull ^
           static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4Full ^
           static_cast<std::uint64_t>(z) * 0x165667B19E3779F9ull;
  };
  std::unordered_multimap<std::uint64_t, std::uint32_t> kept;
  kept.reserve(vertices.size());
  std::vector<std::uint32_t> first(vertices.size());
  const auto limit = static_cast<float>(tolerance * tolerance);
  for (std::uint32_t i = 0; i < vertices.size(); ++i) {
    first[i] = i;
    bool found = false;
    // Cells are two tolerances wide: whatever is in reach lies in the eight cells around the nearest cell corner.
    for (int k = 0; k < 8 && !found; ++k) {
      const auto h = key(cell(vertices[i], 0, (k & 1) ? 0.5 : -0.5), cell(vertices[i], 1, (k & 2) ? 0.5 : -0.5),
                         cell(vertices[i], 2, (k & 4) ? 0.5 : -0.5));
      const auto [begin, end] = kept.equal_range(h);
      for (auto it = begin; it != end; ++it) {
        if ((vertices[it->second] - vertices[i]).squaredNorm() <= limit) {
          first[i] = it->second;
          found = true;
          break;
        }
      }
    }
    if (!found) kept.emplace(key(cell(vertices[i], 0, 0), cell(vertices[i], 1, 0), cell(vertices[i], 2, 0)), i);
  }
  return first;
}

bool even(const Index3& t) {  ///< orientation, relative to the sorted corners
  return (t[0] < t[1]) == ((t[1] < t[2]) == (t[0] < t[2]));
}

/// Exporters that round coordinates tear parts open along their seams. Corners on open edges are merged with others of
/// their kind at a wider tolerance than the rest, where nothing but a seam can be that narrow.
std::size_t close_seams(const std::vector<Eigen::Vector3f>& vertices, double tolerance,
                        std::vector<Index3>& triangles) {
  std::vector<std::uint32_t> rim;
  for_each_edge(edges_of(triangles), [&](const Edge* first, const Edge* last) {
    if (last - first != 1) return;
    rim.push_back(first->a);
    rim.push_back(first->b);
  });
  std::sort(rim.begin(), rim.end());
  rim.erase(std::unique(rim.begin(), rim.end()), rim.end());
  std::vector<Eigen::Vector3f> places;
  for (const std::uint32_t v : rim) places.push_back(vertices[v]);
  const std::vector<std::uint32_t> first = weld(places, tolerance);
  std::vector<std::uint32_t> to(vertices.size());
  std::iota(to.begin(), to.end(), 0u);
  std::size_t merged = 0;
  for (std::size_t i = 0; i < rim.size(); ++i) {
    to[rim[i]] = rim[first[i]];
    merged += first[i] != i ? 1 : 0;
  }
  if (merged == 0) return 0;
  std::erase_if(triangles, [&](Index3& t) {
    for (std::uint32_t& v : t) v = to[v];
    return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];  // narrower than the seam
  });
  return merged;
}

/// Drops coincident copies; marks in `doubled` those that were there in both orientations.
std::vector<Index3> drop_duplicates(const std::vector<Index3>& triangles, SoupReport& report,
                                    std::vector<std::uint8_t>& doubled) {
  struct Keyed {
    Index3 sorted;
    std::uint32_t index;
  };
  std::vector<Keyed> keyed(triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    keyed[i] = {triangles[i], i};
    std::sort(keyed[i].sorted.begin(), keyed[i].sorted.end());
  }
  std::sort(keyed.begin(), keyed.end(),
            [](const Keyed& x, const Keyed& y) { return std::tie(x.sorted, x.index) < std::tie(y.sorted, y.index); });
  std::vector<std::uint8_t> keep(triangles.size(), 0), both(triangles.size(), 0);
  for (std::size_t i = 0; i < keyed.size();) {
    const std::uint32_t first = keyed[i].index;
    keep[first] = 1;
    std::size_t j = i + 1;
    for (; j < keyed.size() && keyed[j].sorted == keyed[i].sorted; ++j) {
      const bool opposite = even(triangles[keyed[j].index]) != even(triangles[first]);
      ++(opposite ? report.duplicates_opposite : report.duplicates_same);
      if (opposite) both[first] = 1;
    }
    i = j;
  }
  std::vector<Index3> kept;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (!keep[i]) continue;
    kept.push_back(triangles[i]);
    doubled.push_back(both[i]);
  }
  return kept;
}

/// Drops those groups of doubled faces whose rim closes without them: walls between touching solids.
void drop_inner_walls(std::vector<Index3>& triangles, std::vector<std::uint8_t>& doubled, SoupReport& report) {
  if (std::find(doubled.begin(), doubled.end(), std::uint8_t{1}) == doubled.end()) return;
  const std::vector<Edge> edges = edges_of(triangles);
  UnionFind groups(triangles.size());
  for_each_edge(edges, [&](const Edge* first, const Edge* last) {
    const Edge* previous = nullptr;
    for (const Edge* e = first; e != last; ++e) {
      if (!doubled[e->triangle]) continue;
      if (previous != nullptr) groups.join(previous->triangle, e->triangle);
      previous = e;
    }
  });
  std::map<std::uint32_t, std::array<std::size_t, 2>> rims;  // group: rim edges that close without it, that do not
  for_each_edge(edges, [&](const Edge* first, const Edge* last) {
    const auto inside = std::count_if(first, last, [&](const Edge& e) { return doubled[e.triangle] != 0; });
    if (inside % 2 == 0) return;
    const auto others = (last - first) - inside;
    const auto member = std::find_if(first, last, [&](const Edge& e) { return doubled[e.triangle] != 0; });
    ++rims[groups.find(member->triangle)][others > 0 && others % 2 == 0 ? 0 : 1];
  });
  std::size_t kept = 0;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (doubled[i]) {
      const auto rim = rims.find(groups.find(i));
      if (rim != rims.end() && rim->second[0] > rim->second[1]) {
        ++report.inner_walls;
        continue;
      }
    }
    triangles[kept] = triangles[i];
    doubled[kept++] = doubled[i];
  }
  triangles.resize(kept);
  doubled.resize(kept);
}

/// Triangles without area fill T-junctions: what hangs together is known by now, so they can go.
void drop_slivers(const std::vector<Eigen::Vector3f>& vertices, double size, std::vector<Index3>& triangles,
                  Soup& soup) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vec3 a = vertices[triangles[t][0]].cast<double>(), b = vertices[triangles[t][1]].cast<double>(),
               c = vertices[triangles[t][2]].cast<double>();
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    if (!((b - a).cross(c - a).norm() > 1e-7 * size * longest)) {
      ++soup.report.degenerate;
      continue;
    }
    triangles[kept] = triangles[t];
    soup.open[kept] = soup.open[t];
    soup.component[kept] = soup.component[t];
    soup.closed.of[kept++] = soup.closed.of[t];
  }
  triangles.resize(kept);
  soup.open.resize(kept);
  soup.component.resize(kept);
  soup.closed.of.resize(kept);
}

}  // namespace

Soup clean_soup(const Mesh& mesh) {
  Soup soup;
  SoupReport& report = soup.report;
  report.triangles_read = mesh.triangles.size();
  Eigen::Vector3f low = mesh.vertices.at(mesh.triangles.at(0)[0]), high = low;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) {
      low = low.cwiseMin(mesh.vertices[i]);
      high = high.cwiseMax(mesh.vertices[i]);
    }
  }
  const double size = static_cast<double>((high - low).maxCoeff());
  const std::vector<std::uint32_t> first = weld(mesh.vertices, 1e-6 * size);

  std::vector<Index3> triangles;
  for (const auto& t : mesh.triangles) {
    const Index3 w{first[t[0]], first[t[1]], first[t[2]]};
    if (w[0] == w[1] || w[1] == w[2] || w[2] == w[0]) {
      ++report.degenerate;
    } else {
      triangles.push_back(w);
    }
  }
  report.seam_vertices = close_seams(mesh.vertices, kSeam * size, triangles);
  std::vector<std::uint8_t> doubled;
  triangles = drop_duplicates(triangles, report, doubled);
  drop_inner_walls(triangles, doubled, report);
  const std::vector<Edge> edges = edges_of(triangles);
  UnionFind parts(triangles.size());
  std::vector<std::uint8_t> rim(triangles.size(), 0);
  for_each_edge(edges, [&](const Edge* from, const Edge* to) {
    for (const Edge* e = from + 1; e != to; ++e) parts.join(from->triangle, e->triangle);
    if (to - from == 1) {
      ++report.boundary_edges;
      rim[from->triangle] = 1;
    } else if (to - from == 2) {
      report.flipped_edges += from[0].forward == from[1].forward ? 1 : 0;
    } else {
      ++report.non_manifold_edges;
    }
  });
  std::vector<std::uint8_t> open(triangles.size(), 0);
  std::vector<std::uint32_t>& component = soup.component;
  component.resize(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    component[t] = parts.find(t);
    open[component[t]] |= rim[t];
  }
  soup.closed = orient_closed_parts(mesh.vertices, triangles, edges, component, doubled);
  report.closed_parts = soup.closed.parts.size();
  report.capped_holes = soup.closed.holes.size();
  for (const ClosedPart& part : soup.closed.parts) report.turned_triangles += part.turned;
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const std::uint32_t root = component[t];
    if (soup.closed.of[t] != 0) open[root] = 0;  // closed, if need be by caps
    if (root == t) {
      ++report.components;
      report.open_components += open[t];
    }
    soup.open.push_back(open[root]);
    report.sheet_triangles += open[root];
  }

  drop_slivers(mesh.vertices, size, triangles, soup);
  report.triangles_kept = triangles.size();

  // Only the vertices in use, in the order of first use.
  std::vector<std::uint32_t> to(mesh.vertices.size(), ~0u);
  const auto renumber = [&](Index3& t) {
    for (std::uint32_t& i : t) {
      if (to[i] == ~0u) {
        to[i] = static_cast<std::uint32_t>(soup.mesh.vertices.size());
        soup.mesh.vertices.push_back(mesh.vertices[i]);
      }
      i = to[i];
    }
  };
  std::for_each(triangles.begin(), triangles.end(), renumber);
  std::for_each(soup.closed.caps.begin(), soup.closed.caps.end(), renumber);
  soup.mesh.triangles = std::move(triangles);
  return soup;
}

}  // namespace tact::contact
