#include "contact/bake/worker/samples.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "contact/bake/worker/opposite_face.hpp"
#include "contact/bake/worker/parallel.hpp"
#include "contact/bake/worker/point_grid.hpp"

namespace tact::contact {
namespace {

struct Corners {
  Vec3 a, b, c;
  Vec3 normal() const { return (b - a).cross(c - a).normalized(); }
};

Corners corners_of(const Mesh& mesh, std::size_t t) {
  const auto& i = mesh.triangles[t];
  return {mesh.vertices[i[0]].cast<double>(), mesh.vertices[i[1]].cast<double>(), mesh.vertices[i[2]].cast<double>()};
}

/// Which side of a small piece of surface is inside.
enum class Side { along_normal, against_normal, buried, neither };

Side side_of(const SplitSoup& split, const Vec3& p, const Vec3& normal) {
  const double step = 2e-5 * split.inside.surface().size();  // beyond the rounding of float32 rays
  const bool along = split.inside.vote(p + step * normal).inside, against = split.inside.vote(p - step * normal).inside;
  if (along && against) return Side::buried;
  if (along) return Side::along_normal;
  return against ? Side::against_normal : Side::neither;
}

/// A line from a to b with the triangles round it.
struct SharpEdge {
  std::uint32_t a, b;
  std::vector<std::uint32_t> triangles;
};

bool is_sharp(const Mesh& mesh, const SharpEdge& e) {
  if (e.triangles.size() != 2) return true;
  const Vec3 a = mesh.vertices[e.a].cast<double>(), along = (mesh.vertices[e.b].cast<double>() - a).normalized();
  Vec3 out[2];  // in each triangle's plane, away from the edge: orientation plays no part
  for (std::size_t k = 0; k < 2; ++k) {
    for (const std::uint32_t v : mesh.triangles[e.triangles[k]]) {
      if (v == e.a || v == e.b) continue;
      const Vec3 to = mesh.vertices[v].cast<double>() - a;
      out[k] = (to - to.dot(along) * along).normalized();
    }
  }
  static const double kFlat = -std::cos(30 * M_PI / 180);
  return out[0].dot(out[1]) > kFlat;
}

std::vector<SharpEdge> sharp_edges(const Soup& soup, bool skip_open) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::uint32_t>> around;
  for (std::uint32_t t = 0; t < soup.mesh.triangles.size(); ++t) {
    if (skip_open && soup.open[t]) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = soup.mesh.triangles[t][k], b = soup.mesh.triangles[t][(k + 1) % 3];
      around[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  }
  std::vector<SharpEdge> sharp;
  for (auto& [ends, triangles] : around) {
    SharpEdge edge{ends.first, ends.second, std::move(triangles)};
    if (is_sharp(soup.mesh, edge)) sharp.push_back(std::move(edge));
  }
  return sharp;
}

/// A place on a sharp edge, or its end, with the triangles that meet there.
struct FeaturePlace {
  Vec3 position;
  std::vector<std::uint32_t> triangles;
};

/// The angle a triangle fills at p: a flat side counts the same however many triangles it is cut into.
double angle_at(const Corners& c, const Vec3& p) {
  const Vec3 corner[3] = {c.a, c.b, c.c};
  for (int k = 0; k < 3; ++k) {
    if (corner[k] != p) continue;
    const Vec3 u = corner[(k + 1) % 3] - p, v = corner[(k + 2) % 3] - p;
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }
  return M_PI;
}

/// The mean inward normal of the triangles that meet at a place; false when they are all buried.
bool orient_feature(const Mesh& mesh, const SplitSoup& split, const FeaturePlace& place, Vec3& normal) {
  Vec3 sum = Vec3::Zero();
  for (const std::uint32_t t : place.triangles) {
    const Corners c = corners_of(mesh, t);
    const Vec3 n = c.normal(), to_middle = (c.a + c.b + c.c) / 3 - place.position;
    const double inset = std::min(0.05, 1e-3 * split.inside.surface().size() / to_middle.norm());
    const Side side = side_of(split, place.position + inset * to_middle, n);
    const double weight = angle_at(c, place.position);
    if (side == Side::along_normal) sum += weight * n;
    if (side == Side::against_normal || side == Side::neither) sum -= weight * n;
  }
  if (!(sum.norm() > 1e-3)) return false;
  normal = sum.normalized();
  return true;
}

/// Places every `spacing` along the sharp edges, ends included once.
std::vector<FeaturePlace> feature_places(const Soup& soup, bool skip_open, double spacing) {
  const Mesh& mesh = soup.mesh;
  const std::vector<SharpEdge> edges = sharp_edges(soup, skip_open);
  std::vector<std::uint8_t> is_end(mesh.vertices.size(), 0);
  std::vector<FeaturePlace> places;
  for (const SharpEdge& e : edges) {
    is_end[e.a] = is_end[e.b] = 1;
    const Vec3 a = mesh.vertices[e.a].cast<double>(), b = mesh.vertices[e.b].cast<double>();
    const int pieces = static_cast<int>(std::ceil((b - a).norm() / spacing));
    for (int k = 1; k < pieces; ++k) places.push_back({a + (b - a) * (static_cast<double>(k) / pieces), e.triangles});
  }
  std::map<std::uint32_t, FeaturePlace> ends;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (skip_open && soup.open[t]) continue;
    for (const std::uint32_t v : mesh.triangles[t]) {
      if (!is_end[v]) continue;
      FeaturePlace& end = ends[v];
      end.position = mesh.vertices[v].cast<double>();
      end.triangles.push_back(t);
    }
  }
  for (auto& [v, end] : ends) places.push_back(std::move(end));
  return places;
}

/// A place on a part `thickness_m` thick, moved outward until the part would be `spacing_m` thick.
Vec3 moved_apart(const Vec3& p, const Vec3& inward, double thickness_m, double spacing_m) {
  return p - 0.5 * std::max(0.0, spacing_m - thickness_m) * inward;
}

/// A wire has hardly any area, so samples by area may miss it, or one side of it: asks along each triangle's length,
/// and adds a sample wherever the part is thinner than the spacing and none lies within half of it, both sides moved
/// apart.
void add_thin_parts(const Soup& soup, const SplitSoup& split, double spacing_m, const StageProgress& progress,
                    SurfaceSamples& samples) {
  struct Place {
    Vec3 p, n, apart = Vec3::Zero();
    bool good = false;
  };
  std::vector<Place> places;
  for (std::size_t t = 0; t < soup.mesh.triangles.size(); ++t) {
    if (soup.open[t]) continue;  // of a sheet, which has area
    const Corners c = corners_of(soup.mesh, t);
    const Vec3 corner[3] = {c.a, c.b, c.c};
    int tip = 0;  // across from the shortest side
    const auto side = [&](int k) { return (corner[(k + 1) % 3] - corner[(k + 2) % 3]).squaredNorm(); };
    for (int k = 1; k < 3; ++k) tip = side(k) < side(tip) ? k : tip;
    const Vec3 foot = 0.5 * (corner[(tip + 1) % 3] + corner[(tip + 2) % 3]), along = corner[tip] - foot;
    if (side(tip) > spacing_m * spacing_m) continue;  // wide enough to have samples by area
    const int pieces = static_cast<int>(std::min(1e6, std::ceil(along.norm() / (0.5 * spacing_m))));
    for (int k = 0; k < pieces; ++k) places.push_back({foot + (k + 0.5) / pieces * along, c.normal()});
  }
  parallel_stage("thin parts", places.size(), progress, [&](std::size_t i) {
    Place& place = places[i];
    // Thin whichever side is inside? Few are; only they are asked which.
    const double ahead = opposite_face_m(split.solid, place.p, place.n, spacing_m),
                 behind = opposite_face_m(split.solid, place.p, -place.n, spacing_m);
    if (!(std::min(ahead, behind) < spacing_m)) return;
    const Side inside = side_of(split, place.p, place.n);
    if (inside != Side::along_normal && inside != Side::against_normal) return;
    if (inside == Side::against_normal) place.n *= -1;
    const double thickness = inside == Side::along_normal ? ahead : behind;
    place.apart = moved_apart(place.p, place.n, thickness, spacing_m);
    place.good = thickness < spacing_m;
  });
  std::vector<Vec3> apart;
  for (const Place& place : places) {
    if (place.good) apart.push_back(place.apart);
  }
  const double reach = 0.5 * spacing_m;
  const PointGrid sampled(samples.apart, spacing_m), asked(apart, reach);
  std::vector<std::uint8_t> covered(apart.size(), 0);
  std::size_t at = 0;
  std::vector<Vec3> added;
  for (const Place& place : places) {
    if (!place.good) continue;
    const std::size_t i = at++;
    if (covered[i] == 0) sampled.within(place.apart, reach, [&](std::uint32_t, double) { covered[i] = 1; });
    if (covered[i] != 0) continue;
    asked.within(place.apart, reach, [&](std::uint32_t k, double) { covered[k] = 1; });
    added.push_back(place.apart);
    samples.position.push_back(place.p);
    samples.normal.push_back(place.n);
    samples.on_feature.push_back(0);
  }
  samples.on_thin_parts = added.size();
  samples.apart.insert(samples.apart.end(), added.begin(), added.end());
}

}  // namespace

double area_of(const Mesh& mesh) {
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners c = corners_of(mesh, t);
    area += 0.5 * (c.b - c.a).cross(c.c - c.a).norm();
  }
  return area;
}

double packing_spacing(double area_m2, std::size_t count) {
  return std::sqrt(2 * area_m2 / (std::sqrt(3.0) * static_cast<double>(count)));
}

std::size_t packing_count(double area_m2, double spacing_m) {
  const double count = 2 * area_m2 / (std::sqrt(3.0) * spacing_m * spacing_m);
  return static_cast<std::size_t>(std::llround(std::min(count, 1e15)));
}

SurfaceSamples sample_surface(const Soup& soup, const SplitSoup& split, std::size_t count, double spacing_m,
                              const StageProgress& progress) {
  const Mesh& mesh = soup.mesh;
  const bool plates = !split.sheets.empty();
  std::vector<double> area;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners c = corners_of(mesh, t);
    area.push_back((c.b - c.a).cross(c.c - c.a).norm() * (plates && soup.open[t] ? 2 : 1));  // a plate has two faces
  }
  std::discrete_distribution<std::size_t> pick(area.begin(), area.end());
  std::mt19937_64 random(20261122);
  std::uniform_real_distribution<double> unit(0, 1);
  struct Candidate {
    Vec3 p, n, apart = Vec3::Zero();
    bool keep = false, lone = false;
  };
  std::vector<Candidate> candidates(count);
  std::vector<std::uint8_t> on_plate(count, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t t = pick(random);
    const Corners c = corners_of(mesh, t);
    double u = unit(random), v = unit(random);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    candidates[i].p = c.a + u * (c.b - c.a) + v * (c.c - c.a);
    candidates[i].n = c.normal();
    if (plates && soup.open[t]) {
      if (unit(random) < 0.5) candidates[i].n *= -1;
      candidates[i].p -= split.half_thickness_m * candidates[i].n;  // n points into the plate
      on_plate[i] = 1;
    }
  }
  parallel_stage("surface samples", count, progress, [&](std::size_t i) {
    Candidate& c = candidates[i];
    if (on_plate[i]) {
      c.keep = !split.inside.vote(c.p).inside;
      c.apart = moved_apart(c.p, c.n, 2 * split.half_thickness_m, spacing_m);
      return;
    }
    const Side side = side_of(split, c.p, c.n);
    c.keep = side != Side::buried;
    c.lone = side == Side::neither;
    if (side != Side::along_normal) c.n *= -1;
    if (c.keep && plates) {  // hidden in a plate
      const double reach = split.half_thickness_m * (1 - 1e-4);
      c.keep = !(split.sheets.distance(c.p, split.half_thickness_m) < reach);
    }
    if (c.keep)
      c.apart = c.lone ? c.p : moved_apart(c.p, c.n, opposite_face_m(split.solid, c.p, c.n, spacing_m), spacing_m);
  });

  SurfaceSamples samples;
  for (const Candidate& c : candidates) {
    if (!c.keep) {
      ++samples.buried;
      continue;
    }
    samples.no_inside += c.lone ? 1 : 0;
    samples.position.push_back(c.p);
    samples.apart.push_back(c.apart);
    samples.normal.push_back(c.n);
    samples.on_feature.push_back(0);
  }
  samples.by_area = samples.position.size();
  const double total = 0.5 * std::accumulate(area.begin(), area.end(), 0.0);
  samples.area_m2 = total * static_cast<double>(samples.position.size()) / static_cast<double>(count);

  add_thin_parts(soup, split, spacing_m, progress, samples);
  const std::vector<FeaturePlace> places = feature_places(soup, plates, spacing_m);
  std::vector<Vec3> normals(places.size());
  std::vector<std::uint8_t> good(places.size(), 0);
  parallel_stage("sharp edges", places.size(), progress,
                 [&](std::size_t i) { good[i] = orient_feature(mesh, split, places[i], normals[i]); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!good[i]) continue;
    samples.position.push_back(places[i].position);
    samples.apart.push_back(places[i].position);
    samples.normal.push_back(normals[i]);
    samples.on_feature.push_back(1);
  }
  return samples;
}

}  // namespace tact::contact
