#include "contact/bake/worker/crossings.hpp"

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <span>

#include "contact/bake/worker/edges.hpp"
#include "contact/bake/worker/parallel.hpp"
#include "contact/bake/worker/union_find.hpp"

namespace tact::contact {
namespace {

bool share_a_corner(const Index3& a, const Index3& b) {
  for (const std::uint32_t i : a) {
    if (i == b[0] || i == b[1] || i == b[2]) return true;
  }
  return false;
}

using Polygon = std::vector<Vec3>;  ///< convex, flat

struct Plane {
  Vec3 normal;  ///< unit
  double offset;
  double height(const Vec3& p) const { return normal.dot(p) - offset; }
};

Plane plane_of(const std::array<Vec3, 3>& t) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
  return {n, n.dot(t[0])};
}

/// The part of a polygon above (side = 1) or below (-1) a plane; empty when nothing but a hair is.
Polygon half(const Polygon& polygon, const Plane& plane, double side, double hair) {
  Polygon kept;
  bool any = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double ha = side * plane.height(a), hb = side * plane.height(b);
    if (ha >= 0) kept.push_back(a);
    if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) kept.push_back(a + (b - a) * (ha / (ha - hb)));
    any = any || ha > hair;
  }
  if (!any || kept.size() < 3) kept.clear();
  return kept;
}

/// Where a triangle meets a plane: a segment.
std::optional<std::array<Vec3, 2>> segment_in_plane(const std::array<Vec3, 3>& t, const Plane& plane, double hair) {
  std::array<double, 3> h;
  for (std::size_t k = 0; k < 3; ++k) h[k] = plane.height(t[k]);
  if (std::min({h[0], h[1], h[2]}) > hair || std::max({h[0], h[1], h[2]}) < -hair) return std::nullopt;
  std::vector<Vec3> ends;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t n = (k + 1) % 3;
    if (std::fabs(h[k]) <= hair) ends.push_back(t[k]);
    if ((h[k] > hair && h[n] < -hair) || (h[k] < -hair && h[n] > hair)) {
      ends.push_back(t[k] + (t[n] - t[k]) * (h[k] / (h[k] - h[n])));
    }
  }
  if (ends.size() < 2) return std::nullopt;  // touches with a corner
  return std::array{ends[0], ends[1]};
}

/// Whether a segment in the polygon's plane runs through the polygon, edges included.
bool runs_through(const std::array<Vec3, 2>& s, const Polygon& polygon, const Vec3& normal, double hair) {
  double from = 0, to = 1;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const double length = (b - a).norm();
    if (!(length > 0)) continue;
    const Vec3 inward = normal.cross(b - a) / length;
    const double h0 = inward.dot(s[0] - a) + hair, h1 = inward.dot(s[1] - a) + hair;
    if (h0 < 0 && h1 < 0) return false;
    if (h0 < 0) from = std::max(from, h0 / (h0 - h1));
    if (h1 < 0) to = std::min(to, h0 / (h0 - h1));
  }
  return from <= to;
}

constexpr std::size_t kMostFragments = 4096;  ///< of one triangle; what is left uncut then stays whole

/// Cuts polygons (in the plane of `own`) so that none is crossed by the triangle `other`.
void cut(std::vector<Polygon>& polygons, const Plane& own, const std::array<Vec3, 3>& other, double hair) {
  const Plane plane = plane_of(other);
  std::vector<Polygon> pieces;
  const auto add = [&](Polygon p) {
    if (!p.empty()) pieces.push_back(std::move(p));
  };
  const bool coplanar =
      std::all_of(other.begin(), other.end(), [&](const Vec3& p) { return std::fabs(own.height(p)) <= hair; });
  const auto segment = coplanar ? std::nullopt : segment_in_plane(other, own, hair);
  for (Polygon& polygon : polygons) {
    if (coplanar) {
      for (std::size_t k = 0; k < 3 && !polygon.empty(); ++k) {
        const Vec3 out = (other[(k + 1) % 3] - other[k]).cross(plane.normal).normalized();
        const Plane side{out, out.dot(other[k])};
        add(half(polygon, side, 1, hair));
        polygon = half(polygon, side, -1, hair);
      }
      add(std::move(polygon));
    } else if (segment && runs_through(*segment, polygon, own.normal, hair)) {
      add(half(polygon, plane, 1, hair));
      add(half(polygon, plane, -1, hair));
    } else {
      add(std::move(polygon));
    }
  }
  polygons = std::move(pieces);
}

class Trimmer {
 public:
  Trimmer(const Mesh& mesh, const TrianglePairs& crossings, const Inside& inside, const StageProgress& progress)
      : mesh_(mesh), crossings_(crossings), inside_(inside), progress_(progress), size_(inside.surface().size()) {}

  Trimmed run() {
    const std::size_t n = mesh_.triangles.size();
    crossers_.resize(n);
    for (std::size_t i = 0; i < crossings_.size();) {
      std::size_t j = i;
      while (j < crossings_.size() && crossings_[j].first == crossings_[i].first) ++j;
      crossers_[crossings_[i].first] = std::span(crossings_).subspan(i, j - i);
      i = j;
    }
    fates_.assign(n, Fate::keep);
    decide_patches();
    std::vector<std::uint32_t> crossed;
    for (std::uint32_t t = 0; t < n; ++t) {
      if (!crossers_[t].empty()) crossed.push_back(t);
    }
    std::vector<std::vector<Polygon>> left(crossed.size());
    parallel_stage("cutting", crossed.size(), progress_, [&](std::size_t i) { cut_one(crossed[i], left[i]); });

    Trimmed trimmed;
    trimmed.mesh.vertices = mesh_.vertices;
    for (std::size_t t = 0; t < n; ++t) {
      if (fates_[t] == Fate::keep) trimmed.mesh.triangles.push_back(mesh_.triangles[t]);
      if (fates_[t] != Fate::keep) ++trimmed.buried;
    }
    for (const std::vector<Polygon>& polygons : left) {
      for (const Polygon& p : polygons) add_polygon(p, trimmed.mesh);
    }
    return trimmed;
  }

 private:
  enum class Fate : std::uint8_t { keep, drop, in_pieces };

  std::array<Vec3, 3> corners(std::uint32_t t) const {
    const auto& i = mesh_.triangles[t];
    return {mesh_.vertices[i[0]].cast<double>(), mesh_.vertices[i[1]].cast<double>(),
            mesh_.vertices[i[2]].cast<double>()};
  }
  bool buried(const Vec3& p, const Vec3& normal) const {
    const double step = 2e-5 * size_;  // beyond the rounding of float32 rays
    return inside_.vote(p + step * normal).inside && inside_.vote(p - step * normal).inside;
  }
  /// Every place asked must be buried: near the tip of a crescent gap the gap is narrower than the step.
  bool buried(const Polygon& polygon, const Vec3& normal) const {
    Vec3 middle = Vec3::Zero();
    for (const Vec3& v : polygon) middle += v / static_cast<double>(polygon.size());
    return buried(middle, normal) && std::all_of(polygon.begin(), polygon.end(), [&](const Vec3& v) {
             return buried(v + 0.05 * (middle - v), normal);
           });
  }
  bool buried(std::uint32_t t) const {
    const auto c = corners(t);
    return buried(Polygon(c.begin(), c.end()), plane_of(c).normal);
  }

  /// Triangles joined by edges of two, none of them crossed, are all buried or all exposed.
  void decide_patches() {
    UnionFind sets(mesh_.triangles.size());
    for_each_edge(edges_of(mesh_.triangles), [&](const Edge* first, const Edge* last) {
      if (last - first != 2) return;
      const std::uint32_t a = first[0].triangle, b = first[1].triangle;
      if (crossers_[a].empty() && crossers_[b].empty()) sets.join(a, b);
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_patch;
    for (std::uint32_t t = 0; t < mesh_.triangles.size(); ++t) {
      if (crossers_[t].empty()) by_patch.emplace_back(sets.find(t), t);
    }
    std::sort(by_patch.begin(), by_patch.end());
    std::vector<std::span<const std::pair<std::uint32_t, std::uint32_t>>> patches;
    for (std::size_t i = 0; i < by_patch.size();) {
      std::size_t j = i;
      while (j < by_patch.size() && by_patch[j].first == by_patch[i].first) ++j;
      patches.push_back(std::span(by_patch).subspan(i, j - i));
      i = j;
    }
    parallel_stage("buried parts", patches.size(), progress_, [&](std::size_t k) {
      const auto& patch = patches[k];
      constexpr std::size_t kProbes = 16;
      std::size_t probes = 0, yes = 0;
      for (std::size_t i = 0; i < std::min(kProbes, patch.size()); ++i) {
        ++probes;
        yes += buried(patch[i * patch.size() / std::min(kProbes, patch.size())].second) ? 1 : 0;
      }
      if (yes == 0) return;
      for (const auto& [root, t] : patch) {  // a crossing that was missed: each for itself
        if (yes == probes || buried(t)) fates_[t] = Fate::drop;
      }
    });
  }

  void cut_one(std::uint32_t t, std::vector<Polygon>& left) {
    const auto c = corners(t);
    const Plane own = plane_of(c);
    const double hair = 1e-7 * size_;
    std::vector<Polygon> polygons{{c[0], c[1], c[2]}};
    for (const auto& [self, other] : crossers_[t]) {
      if (polygons.size() > kMostFragments) break;
      cut(polygons, own, corners(other), hair);
    }
    std::size_t gone = 0;
    for (Polygon& p : polygons) {
      if (buried(p, own.normal)) {
        ++gone;
      } else {
        left.push_back(std::move(p));
      }
    }
    if (gone == 0) {
      left.clear();
    } else {
      fates_[t] = left.empty() ? Fate::drop : Fate::in_pieces;
    }
  }

  static void add_polygon(const Polygon& p, Mesh& mesh) {
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Vec3& v : p) mesh.vertices.push_back(v.cast<float>());
    for (std::uint32_t k = 1; k + 1 < p.size(); ++k) mesh.triangles.push_back({base, base + k, base + k + 1});
  }

  const Mesh& mesh_;
  const TrianglePairs& crossings_;
  const Inside& inside_;
  const StageProgress& progress_;
  double size_;
  std::vector<std::span<const std::pair<std::uint32_t, std::uint32_t>>> crossers_;  ///< by triangle
  std::vector<Fate> fates_;
};

/// Whether the segment from a to b comes within a hair of the triangle. The distance to a convex body is convex along a
/// line, so thirds close in on its minimum, and it changes no faster than the place.
bool touches(const Triangle& t, const Vec3& a, const Vec3& b, double hair) {
  const double length = (b - a).norm();
  const auto distance = [&](double along) { return std::sqrt(t.square_distance(a + (along / length) * (b - a))); };
  for (double low = 0, high = length; high - low > 0.1 * hair;) {
    const double third = (high - low) / 3, left = distance(low + third), right = distance(high - third);
    if (std::min(left, right) <= hair) return true;
    if (std::min(left, right) > hair + third) return false;
    if (left < right) {
      high -= third;
    } else {
      low += third;
    }
  }
  return false;
}

}  // namespace

TrianglePairs find_crossings(const Mesh& mesh, const std::vector<std::uint32_t>& part, const Surface& surface,
                             const StageProgress& progress) {
  const std::vector<Edge> edges = edges_of(mesh.triangles);
  std::vector<std::size_t> first;  // of the sides of each edge
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (i == 0 || edges[i].a != edges[i - 1].a || edges[i].b != edges[i - 1].b) first.push_back(i);
  }
  const double hair = 1e-6 * surface.size();
  TrianglePairs pairs;
  std::mutex mutex;
  parallel_stage("intersections", first.size(), progress, [&](std::size_t k) {
    thread_local std::vector<Crossing> found;
    found.clear();
    const Edge& edge = edges[first[k]];
    const Vec3 a = mesh.vertices[edge.a].cast<double>(), b = mesh.vertices[edge.b].cast<double>();
    const double length = (b - a).norm();
    if (!(length > 0)) return;
    const Vec3 along = (b - a) / length;
    surface.cross(a - hair * along, along, length + 2 * hair, found);
    for (const Crossing& c : found) {
      const std::size_t end = k + 1 < first.size() ? first[k + 1] : edges.size();
      for (std::size_t i = first[k]; i < end; ++i) {
        const std::uint32_t t = edges[i].triangle;
        if (part[t] == part[c.triangle] && share_a_corner(mesh.triangles[t], mesh.triangles[c.triangle])) continue;
        // Single precision takes an edge in the plane of a triangle for one that meets it, however far away.
        if (!touches(surface.triangle(c.triangle), a - surface.middle(), b - surface.middle(), hair)) break;
        const std::lock_guard lock(mutex);
        pairs.emplace_back(t, c.triangle);
        pairs.emplace_back(c.triangle, t);
      }
    }
  });
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

Trimmed drop_buried(const Mesh& mesh, const TrianglePairs& crossings, const Inside& inside,
                    const StageProgress& progress) {
  return Trimmer(mesh, crossings, inside, progress).run();
}

}  // namespace tact::contact
