#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "contact/bake/worker/split_soup.hpp"
#include "field/field_builder.hpp"

namespace tact::contact {

/// A region of the grid where inside and outside are doubtful: blocks that touch each other.
struct DoubtfulPlace {
  Vec3 low_O = Vec3::Zero(), high_O = Vec3::Zero();
  std::size_t blocks = 0;
};

/// What a field is worth, by asking it.
struct FieldQuality {
  std::size_t error_samples = 0;                ///< random points in the band, outside doubtful blocks
  double error_largest_m = 0, error_rms_m = 0;  ///< interpolated against exact signed distance, of those
  std::size_t sign_mismatches = 0;     ///< samples more than a voxel wrong, with the other sign: not error samples
  double surface_without_inside = 0;   ///< fraction of the surface with no inside within 1.5 voxels: sheets, thin walls
  double surface_without_outside = 0;  ///< likewise no outside: gaps too narrow
  /// Of the body itself, by rays from samples of its surface to the face that looks back (opposite_face_m); nothing
  /// when no two faces look at each other.
  std::optional<double> thinnest_wall_m, narrowest_gap_m;
  std::vector<DoubtfulPlace> doubtful_places;  ///< the largest first, at most twenty
};

/// The thinnest wall of which a field of voxels h always shows an inside, and the narrowest gap of which it always
/// shows an outside: h. (The worst is a slab square to the grid, its middle half-way between corners: there trilinear
/// values are h/2 - t/2. A slab askew does better.) Down to 2 h the depth shown in its middle is at least half the true
/// one.
inline double honoured_m(double voxel_m) { return voxel_m; }

FieldQuality judge_field(const FieldParts& parts, const SplitSoup& split, const StageProgress& progress);

}  // namespace tact::contact
