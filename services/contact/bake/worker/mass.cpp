#include <cmath>

#include "contact/bake/worker/parallel.hpp"
#include "contact/bake/worker/shell_bake.hpp"

namespace tact::contact {
namespace {

/// Inertia of unit mass about the mean of the points, each a small cube of side `cell` (0: a dot).
MassProperties of_points(const std::vector<Vec3>& points, double cell) {
  MassProperties mass;
  for (const Vec3& p : points) mass.centre_M += p;
  const auto n = static_cast<double>(points.size());
  mass.centre_M /= n;
  Mat3 second = Mat3::Zero();
  for (const Vec3& p : points) second += (p - mass.centre_M) * (p - mass.centre_M).transpose();
  second = second / n + cell * cell / 12 * Mat3::Identity();
  mass.inertia_shape_m2 = second.trace() * Mat3::Identity() - second;
  mass.volume_m3 = n * cell * cell * cell;
  return mass;
}

}  // namespace

MassProperties mass_properties(const Soup& soup, const SplitSoup& split, const SurfaceSamples& samples,
                               const StageProgress& progress) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const auto& v : soup.mesh.vertices) {
    low = low.cwiseMin(v.cast<double>());
    high = high.cwiseMax(v.cast<double>());
  }
  low -= Vec3::Constant(split.half_thickness_m);
  high += Vec3::Constant(split.half_thickness_m);
  constexpr double kCellsOnLongestSide = 64;
  const double cell = (high - low).maxCoeff() / kCellsOnLongestSide;
  Eigen::Vector3i n;
  Vec3 first;
  for (int i = 0; i < 3; ++i) {  // centred, so that a symmetric body gets a symmetric answer
    n[i] = std::max(1, static_cast<int>(std::ceil((high[i] - low[i]) / cell - 1e-6)));
    first[i] = 0.5 * (low[i] + high[i]) - 0.5 * (n[i] - 1) * cell;
  }
  const auto at = [&](std::size_t i) {
    const auto k = static_cast<int>(i);
    return Vec3(first + cell * Vec3(k % n.x(), k / n.x() % n.y(), k / (n.x() * n.y())));
  };
  const auto count = static_cast<std::size_t>(n.prod());
  std::vector<std::uint8_t> inside(count, 0);
  parallel_stage("mass", count, progress, [&](std::size_t i) {
    const Vec3 p = at(i);
    inside[i] = split.inside.vote(p).inside ||
                (!split.sheets.empty() && split.sheets.distance(p, split.half_thickness_m) < split.half_thickness_m);
  });
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    if (inside[i]) points.push_back(at(i));
  }
  if (points.size() >= 50) return of_points(points, cell);
  const auto by_area = samples.position.begin() + static_cast<std::ptrdiff_t>(samples.by_area);
  const std::vector<Vec3> surface(samples.position.begin(), by_area);
  return of_points(surface.empty() ? samples.position : surface, 0);
}

}  // namespace tact::contact
