#pragma once
#include "contact/bake/worker/inside.hpp"
#include "contact/bake/worker/progress.hpp"
#include "contact/bake/worker/soup.hpp"

namespace tact::contact {

/// What was decided about the parts that bound a volume.
struct SolidReport {
  std::size_t solids = 0, cavities = 0;  ///< closed parts
  std::size_t inverted_parts = 0;        ///< solids that faced inward in the file
  std::size_t swallowed_parts = 0;       ///< wholly inside another and facing as it does: taken as solid
  std::size_t guessed_cavities = 0;      ///< wholly inside another and of no trusted orientation: taken as a cavity
  std::size_t overlaps = 0;              ///< pairs of closed parts that interpenetrate: their union is the body
  std::size_t self_crossing_parts = 0;   ///< closed parts that touch or pass through themselves
  std::size_t crossing_triangles = 0;    ///< that others pass through
  std::size_t buried_triangles = 0;      ///< dropped, whole or in part: inside the union
  std::size_t parity_triangles = 0;      ///< in no closed part: inside and outside by the parity of crossings
};

/// The part of a soup that bounds a volume, and the part that is plates of a stated thickness.
struct SplitSoup {
  Surface solid;   ///< the boundary alone: without the walls that interpenetrating solids leave inside their union
  Inside inside;   ///< of the solid
  Surface sheets;  ///< plates' middle surfaces
  double half_thickness_m = 0;
  SolidReport report;

  /// Signed distance by definition: exact distances, majority vote. Slow; the reference for the field.
  double signed_distance(const Vec3& p) const;
};

/// With a thickness, open parts are plates. Throws Cancelled.
SplitSoup split_soup(const Soup& soup, double sheet_thickness_m, const StageProgress& progress = {});

}  // namespace tact::contact
