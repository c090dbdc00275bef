#pragma once
#include "contact/bake/worker/samples.hpp"
#include "contact/model/pointshell.hpp"

namespace tact::contact {

struct ShellOptions {
  int points = 10000;
  int levels = 7;
  double sheet_thickness_m = 0;
  double spacing_m = 0;  ///< > 0: as many points as lie this far apart on average (100 to 1000000), instead of `points`
};

struct ShellReport {
  std::size_t points = 0, feature_points = 0, thin_part_samples = 0;
  double area_m2 = 0, volume_m3 = 0;
  double mean_spacing_m = 0;  ///< of ideal packing
  double largest_gap_m = 0;   ///< from any place of the exposed surface to the nearest point on its side
  std::size_t buried_samples = 0, samples_without_inside = 0, samples = 0;
  std::vector<std::size_t> level_sizes;
  SolidReport solids;
};

/// Blue-noise points with inward normals, mass properties of the uniform solid, and the hierarchy (README). The content
/// hash is left 0. Throws SetupError, naming nothing but what is wrong, when no surface is exposed; Cancelled.
Pointshell bake_shell(const Soup& soup, const ShellOptions& options, const StageProgress& progress,
                      ShellReport& report);

/// Arranges points (in an order whose every beginning is well spread) as a hierarchy: fills position_T, normal_T,
/// area_m2 in breadth-first order, radius_m, child_begin, child_end, level_begin.
void build_hierarchy(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                     const std::vector<double>& areas, int levels, Pointshell& shell);

struct MassProperties {
  Vec3 centre_M = Vec3::Zero();
  double volume_m3 = 0;
  Mat3 inertia_shape_m2 = Mat3::Identity();  ///< of unit mass about the centre
};

/// Of the uniform solid, from a grid of points and their signs; of the surface when nothing is inside.
MassProperties mass_properties(const Soup& soup, const SplitSoup& split, const SurfaceSamples& samples,
                               const StageProgress& progress);

}  // namespace tact::contact
