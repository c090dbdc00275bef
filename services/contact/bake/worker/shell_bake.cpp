#include "contact/bake/worker/shell_bake.hpp"

#include <cmath>

#include "contact/bake/worker/point_grid.hpp"
#include "fault/fault.hpp"

namespace tact::contact {
namespace {

constexpr std::size_t kCandidatesPerPoint = 8;

std::size_t count_for(double area_m2, double spacing_m) {
  constexpr std::size_t kFewest = 100, kMost = 1000000;
  const std::size_t count = packing_count(area_m2, spacing_m);
  if (count > kMost) {
    throw SetupError("tool.spacing_voxels asks for points " + std::to_string(1e3 * spacing_m) + " mm apart, which is " +
                     std::to_string(count) + " of them, expected at most " + std::to_string(kMost));
  }
  return std::max(count, kFewest);
}

}  // namespace

Pointshell bake_shell(const Soup& soup, const ShellOptions& options, const StageProgress& progress,
                      ShellReport& report) {
  const SplitSoup split = split_soup(soup, options.sheet_thickness_m, progress);
  report.solids = split.report;
  const double area = area_of(soup.mesh);
  std::size_t wanted = static_cast<std::size_t>(options.points);
  if (options.spacing_m > 0) wanted = count_for(split.sheets.empty() ? area : 2 * area, options.spacing_m);
  const double spacing = options.spacing_m > 0 ? options.spacing_m : packing_spacing(area, wanted);
  SurfaceSamples samples = sample_surface(soup, split, kCandidatesPerPoint * wanted, spacing, progress);
  const auto features = static_cast<std::size_t>(std::count(samples.on_feature.begin(), samples.on_feature.end(), 1));
  report.samples = kCandidatesPerPoint * wanted;
  report.buried_samples = samples.buried;
  report.samples_without_inside = samples.no_inside;
  report.area_m2 = samples.area_m2;
  if (samples.position.empty()) throw SetupError("no part of the surface lies on the outside of the body");
  if (options.spacing_m > 0) wanted = count_for(samples.area_m2, options.spacing_m);  // of the exposed surface
  // Too many edges for the points asked for: edges no longer come first, they compete.
  if (2 * features > wanted) std::fill(samples.on_feature.begin(), samples.on_feature.end(), std::uint8_t{0});

  const MassProperties mass = mass_properties(soup, split, samples, progress);
  const std::vector<std::uint32_t> order =
      spread_order(samples.apart, samples.on_feature, wanted, samples.area_m2, progress);
  std::vector<Vec3> positions, apart, normals;
  for (const std::uint32_t i : order) {
    positions.push_back(samples.position[i] - mass.centre_M);
    apart.push_back(samples.apart[i]);
    normals.push_back(samples.normal[i]);
    report.feature_points += samples.on_feature[i];
  }

  // Every sample belongs to the nearest point on its side: areas and the largest gap.
  const PointGrid grid(apart, spacing);
  std::vector<double> areas(positions.size(), 0);
  const double share = samples.area_m2 / static_cast<double>(samples.by_area);
  double gap = 0;
  for (std::size_t i = 0; i < samples.by_area + samples.on_thin_parts; ++i) {
    const std::uint32_t k = grid.nearest(samples.apart[i]);
    if (i < samples.by_area) areas[k] += share;
    gap = std::max(gap, (apart[k] - samples.apart[i]).norm());
  }

  Pointshell shell;
  build_hierarchy(positions, normals, areas, options.levels, shell);
  shell.X_TM.p = -mass.centre_M;
  shell.inertia_shape_m2 = mass.inertia_shape_m2;
  shell.gyration_radius_m = std::sqrt(mass.inertia_shape_m2.trace() / 3);
  for (const Vec3& p : positions) shell.bounding_radius_m = std::max(shell.bounding_radius_m, p.norm() * (1 + 1e-6));
  shell.spacing_m = gap;

  report.points = positions.size();
  report.thin_part_samples = samples.on_thin_parts;
  report.volume_m3 = mass.volume_m3;
  report.mean_spacing_m = packing_spacing(samples.area_m2, positions.size());
  report.largest_gap_m = gap;
  for (std::size_t l = 0; l + 1 < shell.level_begin.size(); ++l) {
    report.level_sizes.push_back(shell.level_begin[l + 1] - shell.level_begin[l]);
  }
  return shell;
}

}  // namespace tact::contact
