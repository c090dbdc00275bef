#pragma once
#include "contact/bake/worker/field_quality.hpp"
#include "contact/bake/worker/progress.hpp"
#include "contact/bake/worker/signs.hpp"
#include "contact/bake/worker/split_soup.hpp"
#include "field/field_builder.hpp"

namespace tact::contact {

struct FieldOptions {
  int resolution = 256;  ///< cells along the longest side of the body
  double band_voxels = 4;
  double sheet_thickness_m = 0;  ///< > 0: open parts become plates of this thickness
};

/// What the field is worth.
struct FieldReport {
  int resolution = 0;  ///< cells along the longest side
  double voxel_m = 0;
  std::array<int, 3> cells{0, 0, 0};
  std::size_t blocks_stored = 0, bytes = 0;
  SolidReport solids;
  SignReport signs;
  std::size_t jumping_blocks = 0;  ///< the sign changes there without a surface
  FieldQuality quality;
};

/// Exact distances, then signs. Throws SetupError when the grid is impossible, Cancelled.
FieldParts bake_field(const Soup& soup, const FieldOptions& options, const StageProgress& progress,
                      FieldReport& report);

}  // namespace tact::contact
