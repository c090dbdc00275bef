#include "contact/bake/worker/shell_bake.hpp"

#include <cmath>

#include "contact/bake/worker/point_grid.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {
constexpr std::size_t kCandidatesPerPoint = 8;
}

Pointshell bake_shell(const Soup& soup, const ShellOptions& options, const StageProgress& progress,
                      ShellReport& report) {
  const SplitSoup split = split_soup(soup, options.sheet_thickness_m, progress);
  report.solids = split.report;
  const auto wanted = static_cast<std::size_t>(options.points);
  const double spacing = packing_spacing(area_of(soup.mesh), wanted);
  SurfaceSamples samples = sample_surface(soup, split, kCandidatesPerPoint * wanted, spacing, progress);
  const auto features = static_cast<std::size_t>(std::count(samples.on_feature.begin(), samples.on_feature.end(), 1));
  report.samples = kCandidatesPerPoint * wanted;
  report.buried_samples = samples.buried;
  report.samples_without_inside = samples.no_inside;
  report.area_m2 = samples.area_m2;
  if (samples.position.empty()) throw SetupError("no part of the surface lies on the outside of the body");
  // Too many edges for the points asked for: edges no longer come first, they compete.
  if (2 * features > wanted) std::fill(samples.on_feature.begin(), samples.on_feature.end(), std::uint8_t{0});

  const MassProperties mass = mass_properties(soup, split, samples, progress);
  const std::vector<std::uint32_t> order =
      spread_order(samples.position, samples.on_feature, wanted, samples.area_m2, progress);
  std::vector<Vec3> positions, normals;
  for (const std::uint32_t i : order) {
    positions.push_back(samples.position[i] - mass.centre_M);
    normals.push_back(samples.normal[i]);
    report.feature_points += samples.on_feature[i];
  }

  // Every sample belongs to its nearest point: areas and the largest gap.
  const PointGrid grid(positions, spacing);
  std::vector<double> areas(positions.size(), 0);
  const double share = samples.area_m2 / static_cast<double>(report.samples - samples.buried);
  double gap = 0;
  for (std::size_t i = 0; i + features < samples.position.size(); ++i) {
    const Vec3 p = samples.position[i] - mass.centre_M;
    const std::uint32_t k = grid.nearest(p);
    areas[k] += share;
    gap = std::max(gap, (positions[k] - p).norm());
  }

  Pointshell shell;
  build_hierarchy(positions, normals, areas, options.levels, shell);
  shell.X_TM.p = -mass.centre_M;
  shell.inertia_shape_m2 = mass.inertia_shape_m2;
  shell.gyration_radius_m = std::sqrt(mass.inertia_shape_m2.trace() / 3);
  for (const Vec3& p : positions) shell.bounding_radius_m = std::max(shell.bounding_radius_m, p.norm() * (1 + 1e-6));
  shell.spacing_m = gap;

  report.points = positions.size();
  report.volume_m3 = mass.volume_m3;
  report.mean_spacing_m = packing_spacing(samples.area_m2, positions.size());
  report.largest_gap_m = gap;
  for (std::size_t l = 0; l + 1 < shell.level_begin.size(); ++l) {
    report.level_sizes.push_back(shell.level_begin[l + 1] - shell.level_begin[l]);
  }
  return shell;
}

}  // namespace tact::contact
