#pragma once
#include "contact/bake/worker/progress.hpp"
#include "contact/bake/worker/signs.hpp"
#include "contact/bake/worker/soup.hpp"
#include "field/field_builder.hpp"

namespace tact::contact {

struct FieldOptions {
  int resolution = 256;  ///< cells along the longest side of the body
  double band_voxels = 4;
  double sheet_thickness_m = 0;  ///< > 0: open parts become plates of this thickness
};

/// What the field is worth.
struct FieldReport {
  double voxel_m = 0;
  std::array<int, 3> cells{0, 0, 0};
  std::size_t blocks_stored = 0, bytes = 0;
  SignReport signs;
  std::size_t jumping_blocks = 0;               ///< the sign changes there without a surface
  std::size_t error_samples = 0;                ///< random points in the band, outside doubtful blocks
  double error_largest_m = 0, error_rms_m = 0;  ///< interpolated against exact signed distance
  std::size_t sign_mismatches = 0;    ///< samples farther than a tenth of a voxel from the surface with the other sign
  double surface_without_inside = 0;  ///< fraction of the surface with no inside within 1.5 voxels: sheets, thin walls
};

/// The part of a soup that bounds a volume, and the part that is plates of a stated thickness.
struct SplitSoup {
  Surface solid, sheets;
  double half_thickness_m = 0;

  /// Signed distance by definition: exact distances, majority vote. Slow; the reference for the field.
  double signed_distance(const Vec3& p) const;
};
SplitSoup split_soup(const Soup& soup, double sheet_thickness_m);

/// Exact distances, then signs. Throws SetupError when the grid is impossible, Cancelled.
FieldParts bake_field(const Soup& soup, const FieldOptions& options, const StageProgress& progress,
                      FieldReport& report);

}  // namespace tact::contact
