#include "contact/bake/worker/closed_parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <utility>

namespace tact::contact {
namespace {

/// The triangle across an edge that two triangles share.
struct Neighbour {
  std::uint32_t triangle;
  bool agrees;  ///< runs along the edge the other way, as it should
};

struct Neighbours {
  std::array<Neighbour, 3> across;
  std::uint8_t count = 0;
};

/// Which triangles to turn so that neighbours agree; of each patch (joined by edges of two triangles) the fewer ones.
/// Patches that cannot agree (Moebius strips) are found out later, edge by edge.
std::vector<std::uint8_t> turns(const std::vector<Edge>& edges, std::size_t triangles) {
  std::vector<Neighbours> neighbours(triangles);
  for_each_edge(edges, [&](const Edge* first, const Edge* last) {
    if (last - first != 2) return;
    const bool agrees = first[0].forward != first[1].forward;
    for (int k = 0; k < 2; ++k) {
      Neighbours& n = neighbours[first[k].triangle];
      n.across[n.count++] = {first[1 - k].triangle, agrees};
    }
  });
  std::vector<std::uint8_t> turn(triangles, 0), seen(triangles, 0);
  std::vector<std::uint32_t> patch;
  for (std::uint32_t start = 0; start < triangles; ++start) {
    if (seen[start]) continue;
    seen[start] = 1;
    patch.assign(1, start);
    std::size_t turned = 0;
    for (std::size_t i = 0; i < patch.size(); ++i) {
      const std::uint32_t t = patch[i];
      turned += turn[t];
      for (std::size_t k = 0; k < neighbours[t].count; ++k) {
        const Neighbour& n = neighbours[t].across[k];
        if (seen[n.triangle]) continue;
        seen[n.triangle] = 1;
        turn[n.triangle] = n.agrees ? turn[t] : !turn[t];
        patch.push_back(n.triangle);
      }
    }
    if (2 * turned > patch.size()) {
      for (const std::uint32_t t : patch) turn[t] = !turn[t];
    }
  }
  return turn;
}

Vec3 normal_of(const std::vector<Eigen::Vector3f>& vertices, const Index3& t) {
  const Vec3 a = vertices[t[0]].cast<double>();
  return (vertices[t[1]].cast<double>() - a).cross(vertices[t[2]].cast<double>() - a);
}

double area_of(const std::vector<Eigen::Vector3f>& vertices, const Index3& t) {
  return 0.5 * normal_of(vertices, t).norm();
}

/// Along a rim, in the direction of its caps.
struct Step {
  std::uint32_t from, to;
  Vec3 normal;  ///< of the triangle beside it, as it faces once turned; any length
};

struct Caps {
  std::vector<Index3> triangles;
  std::vector<Hole> holes;
  double area = 0, largest = 0;  ///< of all, of one hole
};

/// Covers a simple loop with triangles of the least area, so that they neither fold nor leave a flat loop.
/// Of a long one by a fan: that takes the cube of its corners.
void fill(const std::vector<Eigen::Vector3f>& vertices, std::span<const Step> loop, Caps& caps) {
  constexpr std::size_t kLongest = 64;
  const std::size_t n = loop.size();
  if (n < 3) return;  // two triangles that share two edges
  const auto triangle = [&](std::size_t i, std::size_t k, std::size_t j) {
    return Index3{loop[i].from, loop[k].from, loop[j].from};
  };
  struct Best {
    double area = 0;
    std::size_t middle = 0;
  };
  std::vector<Best> best(n <= kLongest ? n * n : 0);  // of the corners from i to j
  for (std::size_t length = 2; length < n && n <= kLongest; ++length) {
    for (std::size_t i = 0, j = length; j < n; ++i, ++j) {
      Best& here = best[i * n + j];
      here.area = std::numeric_limits<double>::infinity();
      for (std::size_t k = i + 1; k < j; ++k) {
        const double area = best[i * n + k].area + best[k * n + j].area + area_of(vertices, triangle(i, k, j));
        if (area < here.area) here = {area, k};
      }
    }
  }
  const auto first = static_cast<std::uint32_t>(caps.triangles.size());
  double area = 0, rim = 0, smoothest = 1;  // cosine of the sharpest angle that a cap makes with what is beside it
  std::vector<std::pair<std::size_t, std::size_t>> left{{0, n - 1}};
  while (!left.empty()) {
    const auto [i, j] = left.back();
    left.pop_back();
    const std::size_t k = n <= kLongest ? best[i * n + j].middle : i + 1;
    caps.triangles.push_back(triangle(i, k, j));
    const Vec3 normal = normal_of(vertices, caps.triangles.back());
    area += 0.5 * normal.norm();
    const auto beside = [&](std::size_t from, std::size_t to) {
      if (to != (from + 1) % n) {
        left.emplace_back(std::min(from, to), std::max(from, to));
      } else if (normal.norm() > 0 && loop[from].normal.norm() > 0) {
        smoothest = std::min(smoothest, normal.normalized().dot(loop[from].normal.normalized()));
      }
    };
    beside(i, k);
    beside(k, j);
    if (i == 0 && j == n - 1) beside(j, i);
  }
  for (const Step& step : loop) rim += static_cast<double>((vertices[step.to] - vertices[step.from]).norm());
  const double tangent = smoothest > 0.5 ? std::sqrt(1 - smoothest * smoothest) / smoothest : 1;
  caps.holes.push_back(
      {first, static_cast<std::uint32_t>(caps.triangles.size()) - first, 2 * area / rim * std::min(1.0, tangent)});
  caps.area += area;
  caps.largest = std::max(caps.largest, area);
}

/// Covers the loops of a rim, in the direction of its steps. As many steps enter a corner as leave it.
Caps cap(const std::vector<Eigen::Vector3f>& vertices, std::vector<Step>& rim) {
  std::sort(rim.begin(), rim.end(), [](const Step& x, const Step& y) { return x.from < y.from; });
  std::vector<std::uint8_t> used(rim.size(), 0);
  Caps caps;
  std::vector<Step> path;                      // behind us
  std::map<std::uint32_t, std::size_t> place;  // of the corners it began at
  for (std::size_t start = 0; start < rim.size(); ++start) {
    if (used[start]) continue;
    path.clear();
    place.clear();
    for (std::size_t step = start;;) {
      used[step] = 1;
      place[rim[step].from] = path.size();
      path.push_back(rim[step]);
      const std::uint32_t at = rim[step].to;
      const auto before = place.find(at);
      if (before != place.end()) {  // a loop is closed: go on from there
        const std::size_t from = before->second;
        fill(vertices, std::span(path).subspan(from), caps);
        for (; path.size() > from; path.pop_back()) place.erase(path.back().from);
      }
      auto next =
          std::lower_bound(rim.begin(), rim.end(), at, [](const Step& s, std::uint32_t v) { return s.from < v; });
      while (next != rim.end() && next->from == at && used[static_cast<std::size_t>(next - rim.begin())]) ++next;
      if (next == rim.end() || next->from != at) break;
      step = static_cast<std::size_t>(next - rim.begin());
    }
  }
  return caps;
}

}  // namespace

ClosedParts orient_closed_parts(const std::vector<Eigen::Vector3f>& vertices, std::vector<Index3>& triangles,
                                const std::vector<Edge>& edges, const std::vector<std::uint32_t>& component,
                                const std::vector<std::uint8_t>& doubled) {
  const std::vector<std::uint8_t> turn = turns(edges, triangles.size());
  std::vector<std::uint8_t> broken(triangles.size(), 0);  // by component
  std::map<std::uint32_t, std::vector<Step>> rims;        // by component
  for_each_edge(edges, [&](const Edge* first, const Edge* last) {
    int balance = 0;
    for (const Edge* e = first; e != last; ++e) balance += e->forward != (turn[e->triangle] != 0) ? 1 : -1;
    const std::uint32_t c = component[first->triangle];
    if (last - first == 1) {  // a cap runs the other way
      const std::uint32_t t = first->triangle;
      const Vec3 normal = (turn[t] ? -1 : 1) * normal_of(vertices, triangles[t]);
      rims[c].push_back(balance > 0 ? Step{first->b, first->a, normal} : Step{first->a, first->b, normal});
    } else if (balance != 0) {
      broken[c] = 1;
    }
  });
  std::vector<double> area(rims.empty() ? 0 : triangles.size(), 0);  // by component
  for (std::size_t t = 0; t < triangles.size() && !rims.empty(); ++t) {
    area[component[t]] += area_of(vertices, triangles[t]);
  }
  std::map<std::uint32_t, Caps> caps;  // by component
  for (auto& [c, rim] : rims) {
    if (broken[c]) continue;
    Caps made = cap(vertices, rim);
    constexpr double kLargestCap = 0.02, kMostCaps = 0.2;
    if (made.largest <= kLargestCap * area[c] && made.area <= kMostCaps * area[c]) {
      caps[c] = std::move(made);
    } else {
      broken[c] = 1;
    }
  }

  ClosedParts closed;
  closed.of.assign(triangles.size(), 0);
  std::vector<std::uint32_t> part_of(triangles.size(), 0);  // by component
  std::vector<std::size_t> size, twice;
  std::vector<Vec3> from;  // volumes are sums of tetrahedra; from a point of the part, so that a far one loses nothing
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    if (broken[component[t]]) continue;
    std::uint32_t& part = part_of[component[t]];
    if (part == 0) {
      closed.parts.emplace_back();
      part = static_cast<std::uint32_t>(closed.parts.size());
      size.push_back(0);
      twice.push_back(0);
      from.push_back(vertices[triangles[t][0]].cast<double>());
    }
    closed.of[t] = part;
    ClosedPart& p = closed.parts[part - 1];
    ++size[part - 1];
    twice[part - 1] += doubled[t];
    if (turn[t]) {
      std::swap(triangles[t][1], triangles[t][2]);
      ++p.turned;
    }
    const auto corner = [&](std::size_t k) { return Vec3(vertices[triangles[t][k]].cast<double>() - from[part - 1]); };
    p.volume_m3 += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  for (const auto& [c, made] : caps) {
    for (const Hole& hole : made.holes) {
      closed.holes.push_back({hole.first + static_cast<std::uint32_t>(closed.caps.size()), hole.count, hole.error_m});
    }
    closed.caps.insert(closed.caps.end(), made.triangles.begin(), made.triangles.end());
    closed.cap_of.resize(closed.caps.size(), part_of[c]);
  }
  for (std::size_t i = 0; i < closed.parts.size(); ++i) {
    closed.parts[i].trusted = 100 * closed.parts[i].turned <= size[i] && twice[i] == 0;
  }
  return closed;
}

}  // namespace tact::contact
