#pragma once
#include <cstdint>
#include <vector>

#include "contact/bake/worker/edges.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {

/// A connected part that is closed, but for small holes that are capped, and whose triangles could be made to agree
/// about the orientation: as many triangles run along each of its edges one way as the other, so the number of times it
/// winds round a point is whole.
struct ClosedPart {
  double volume_m3 = 0;    ///< negative: faces inward, by the majority of the file's triangles
  std::size_t turned = 0;  ///< triangles that disagreed with the majority and were turned over
  bool trusted = false;    ///< the file's orientation means something: few turned, none doubly faced
};

/// A hole that was capped.
struct Hole {
  std::uint32_t first, count;  ///< its caps
  /// How far what was there may lie from the caps: the hole's width (twice its area over its rim) by the tangent of the
  /// sharpest angle between a cap and the triangle beside it, 1 at most. Smooth surfaces go on as they are.
  double error_m;
};

struct ClosedParts {
  std::vector<std::uint32_t> of;  ///< per triangle: 1 + its part; 0: in none
  std::vector<ClosedPart> parts;
  std::vector<Index3> caps;           ///< over small holes
  std::vector<std::uint32_t> cap_of;  ///< per cap: 1 + its part
  std::vector<Hole> holes;
};

/// Finds the closed parts (caps of at most 2 % of a part's area each, and 20 % together, allowed) and turns those of
/// their triangles that disagree with the majority. `edges` are those of `triangles`, `component` names each triangle's
/// connected component, `doubled` marks what was there both ways round.
ClosedParts orient_closed_parts(const std::vector<Eigen::Vector3f>& vertices, std::vector<Index3>& triangles,
                                const std::vector<Edge>& edges, const std::vector<std::uint32_t>& component,
                                const std::vector<std::uint8_t>& doubled);

}  // namespace tact::contact
