#include "contact/bake/worker/samples.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "contact/bake/worker/parallel.hpp"

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

SurfaceSamples sample_surface(const Soup& soup, const SplitSoup& split, std::size_t count, double feature_spacing_m,
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
    Vec3 p, n;
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
  });

  SurfaceSamples samples;
  for (const Candidate& c : candidates) {
    if (!c.keep) {
      ++samples.buried;
      continue;
    }
    samples.no_inside += c.lone ? 1 : 0;
    samples.position.push_back(c.p);
    samples.normal.push_back(c.n);
    samples.on_feature.push_back(0);
  }
  const double total = 0.5 * std::accumulate(area.begin(), area.end(), 0.0);
  samples.area_m2 = total * static_cast<double>(samples.position.size()) / static_cast<double>(count);

  const std::vector<FeaturePlace> places = feature_places(soup, plates, feature_spacing_m);
  std::vector<Vec3> normals(places.size());
  std::vector<std::uint8_t> good(places.size(), 0);
  parallel_stage("sharp edges", places.size(), progress,
                 [&](std::size_t i) { good[i] = orient_feature(mesh, split, places[i], normals[i]); });
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!good[i]) continue;
    samples.position.push_back(places[i].position);
    samples.normal.push_back(normals[i]);
    samples.on_feature.push_back(1);
  }
  return samples;
}

}  // namespace tact::contact
