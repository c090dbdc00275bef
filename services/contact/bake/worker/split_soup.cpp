#include "contact/bake/worker/split_soup.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>

#include "contact/bake/worker/crossings.hpp"
#include "contact/bake/worker/parallel.hpp"

namespace tact::contact {
namespace {

/// The triangles of the parts that bound a volume, caps included, and to which closed part and component each belongs.
struct Whole {
  Mesh mesh;
  std::vector<std::uint32_t> part, component;
};

/// By part (0: the rest): the parts that hold all of it. Those that interpenetrate hold nothing of each other.
using Containers = std::vector<std::vector<std::uint32_t>>;

Containers find_containers(const Whole& whole, const Inside& inside, std::size_t parts,
                           const std::set<std::pair<std::uint32_t, std::uint32_t>>& overlaps,
                           const StageProgress& progress) {
  constexpr std::size_t kProbes = 3;
  std::vector<std::vector<std::uint32_t>> members(parts + 1);
  for (std::uint32_t t = 0; t < whole.part.size(); ++t) members[whole.part[t]].push_back(t);
  Containers containers(parts + 1);
  parallel_stage("nested parts", parts, progress, [&](std::size_t i) {
    const auto part = static_cast<std::uint32_t>(i + 1);
    if (members[part].empty()) return;  // nothing but slivers
    std::vector<std::uint32_t> all;     // that hold every probe so far; sorted
    for (std::size_t k = 0; k < kProbes; ++k) {
      const auto& t = whole.mesh.triangles[members[part][k * members[part].size() / kProbes]];
      Vec3 middle = Vec3::Zero();
      for (const std::uint32_t v : t) middle += whole.mesh.vertices[v].cast<double>() / 3;
      std::vector<std::uint32_t> around = inside.parts_around(middle), both;
      std::set_intersection(all.begin(), all.end(), around.begin(), around.end(), std::back_inserter(both));
      all = k == 0 ? std::move(around) : std::move(both);
    }
    for (const std::uint32_t p : all) {
      if (p != part && !overlaps.count(std::minmax(p, part))) containers[part].push_back(p);
    }
  });
  return containers;
}

/// Who is solid and who is a cavity. A part inside no other is solid, however it faces. A nested part is what its
/// orientation says, compared with the outermost part that holds it; where orientations mean nothing, solid and cavity
/// alternate.
std::vector<std::int8_t> decide_roles(const std::vector<ClosedPart>& parts, const Containers& containers,
                                      SolidReport& report) {
  std::vector<std::int8_t> role(parts.size() + 1, 1);
  std::vector<std::uint32_t> order(parts.size());
  std::iota(order.begin(), order.end(), 1u);
  const auto size = [&](std::uint32_t p) {
    return p == 0 ? std::numeric_limits<double>::infinity() : std::fabs(parts[p - 1].volume_m3);
  };
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return size(a) != size(b) ? size(a) > size(b) : a < b; });
  for (const std::uint32_t p : order) {  // containers come before what they hold
    const ClosedPart& part = parts[p - 1];
    const bool inward = part.volume_m3 < 0;
    std::uint32_t outer = p, next = p;  // the largest and the smallest that hold it
    for (const std::uint32_t c : containers[p]) {
      if (outer == p || size(c) > size(outer)) outer = c;
      if (next == p || size(c) < size(next)) next = c;
    }
    if (outer == p) {
      report.inverted_parts += inward ? 1 : 0;
    } else {
      const bool outer_inward = outer != 0 && parts[outer - 1].volume_m3 < 0;
      const bool trusted = part.trusted && (outer == 0 || parts[outer - 1].trusted);
      role[p] = trusted ? (inward == outer_inward ? 1 : -1) : static_cast<std::int8_t>(-role[next]);
      report.guessed_cavities += !trusted && role[p] < 0 ? 1 : 0;
      report.swallowed_parts += role[p] > 0 && role[next] > 0 ? 1 : 0;
    }
    ++(role[p] > 0 ? report.solids : report.cavities);
  }
  return role;
}

}  // namespace

double SplitSoup::signed_distance(const Vec3& p) const {
  const double solid_m = solid.distance(p, std::numeric_limits<double>::infinity());
  const double signed_solid = inside.vote(p).inside ? -solid_m : solid_m;
  return std::min(signed_solid, sheets.distance(p, std::numeric_limits<double>::infinity()) - half_thickness_m);
}

SplitSoup split_soup(const Soup& soup, double sheet_thickness_m, const StageProgress& progress) {
  const bool plates = sheet_thickness_m > 0;
  Whole whole{{soup.mesh.vertices, {}}, {}, {}};
  Mesh sheets{soup.mesh.vertices, {}};
  for (std::size_t t = 0; t < soup.mesh.triangles.size(); ++t) {
    if (plates && soup.open[t]) {
      sheets.triangles.push_back(soup.mesh.triangles[t]);
    } else {
      whole.mesh.triangles.push_back(soup.mesh.triangles[t]);
      whole.part.push_back(soup.closed.of[t]);
      whole.component.push_back(soup.component[t]);
    }
  }
  const std::vector<ClosedPart>& parts = soup.closed.parts;
  whole.mesh.triangles.insert(whole.mesh.triangles.end(), soup.closed.caps.begin(), soup.closed.caps.end());
  whole.part.insert(whole.part.end(), soup.closed.cap_of.begin(), soup.closed.cap_of.end());
  whole.component.resize(whole.part.size(), 0);  // asked of open parts only
  const Surface surface(whole.mesh);
  Inside inside(surface, whole.part, whole.component, std::vector<std::int8_t>(parts.size() + 1, 1));
  SolidReport report;
  report.parity_triangles = static_cast<std::size_t>(std::count(whole.part.begin(), whole.part.end(), 0u));
  const double half = sheets.triangles.empty() ? 0 : 0.5 * sheet_thickness_m;
  if (parts.empty()) return {surface, inside, Surface(sheets), half, report};  // parity alone: nothing is buried

  const TrianglePairs crossings = find_crossings(whole.mesh, whole.part, surface, progress);
  std::set<std::pair<std::uint32_t, std::uint32_t>> overlaps;
  std::set<std::uint32_t> self_crossing;
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    const std::uint32_t a = whole.part[crossings[i].first], b = whole.part[crossings[i].second];
    if (i == 0 || crossings[i].first != crossings[i - 1].first) ++report.crossing_triangles;
    if (a != b) overlaps.insert(std::minmax(a, b));
    if (a == b && a != 0) self_crossing.insert(a);
  }
  report.overlaps = overlaps.size();
  report.self_crossing_parts = self_crossing.size();
  const Containers containers = find_containers(whole, inside, parts.size(), overlaps, progress);
  inside = Inside(surface, whole.part, whole.component, decide_roles(parts, containers, report));
  if (crossings.empty() && report.swallowed_parts == 0) return {surface, inside, Surface(sheets), half, report};

  const Trimmed trimmed = drop_buried(whole.mesh, crossings, inside, progress);
  report.buried_triangles = trimmed.buried;
  return {trimmed.buried == 0 ? surface : Surface(trimmed.mesh), inside, Surface(sheets), half, report};
}

}  // namespace tact::contact
