#pragma once
#include <map>
#include <string>
#include <vector>

#include "mesh/mesh.hpp"

namespace tact::shapes {

/// The alpha of the classic puzzle: one tube, crossing itself, its two ends free. Formulas and a drawing: README.md.
/// Mesh frame M: origin between the strands at the crossing, loop along +x, legs along -x, the strand that runs to +y
/// in the loop above (z > 0), the other below. Turning by 180 degrees about x changes nothing.
struct Alpha {
  double diameter_m;         ///< D, of the tube (across corners of its polygon)
  double gap_m;              ///< between the strands' surfaces at the crossing: 2 h - D
  double crossing_half_rad;  ///< a: strands run at +-a to the x axis
  double tip_half_rad;       ///< g: flanks meet at the tip at 2 g
  double strand_m;           ///< straight, from the crossing to the side bend
  double leg_m;              ///< straight, from the crossing to the free end
  double side_radius_m;      ///< bend between strand and flank
  double tip_radius_m;       ///< bend at the tip
  double pinch_m;            ///< strands rise by this much away from the crossing...
  double pinch_length_m;     ///< ...within this distance of it, as a raised cosine
  int sides;                 ///< of the tube's polygon

  double h() const { return (gap_m + diameter_m) / 2; }  ///< height of a strand's centre line at the crossing
  Vec3 strand_direction() const;                         ///< of the upper strand, towards the loop
  Vec3 virtual_tip() const;                              ///< where the flanks' lines meet, beyond the round tip
  double flank_m() const;                                ///< straight length of a flank; at most 0: no such alpha

  /// 42 points from one leg's end to the other's.
  std::vector<Vec3> centre_line() const;

  /// Mitred tube round the centre line with flat ends: 2 * sides * 42 triangles (1008 with 12 sides).
  Mesh mesh() const;
};

/// The alpha that make_shape("alpha", params) is the mesh of: for who needs its lines and angles. Throws as make_shape.
Alpha alpha_from(const std::map<std::string, double>& params);

}  // namespace tact::shapes
