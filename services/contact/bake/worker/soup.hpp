#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "contact/bake/worker/closed_parts.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {

/// What was found in a triangle soup, after welding vertices nearer than a millionth of its size.
struct SoupReport {
  std::size_t triangles_read = 0, triangles_kept = 0;
  std::size_t degenerate = 0;           ///< without area: dropped
  std::size_t duplicates_same = 0;      ///< coincident copies of equal orientation: dropped
  std::size_t duplicates_opposite = 0;  ///< coincident copies of opposite orientation (doubly faced): dropped
  std::size_t inner_walls = 0;          ///< faces two touching solids share: both sides dropped
  std::size_t seam_vertices = 0;        ///< on open edges, merged with others up to 5e-5 of the size away
  std::size_t boundary_edges = 0;       ///< with one triangle, after cleaning
  std::size_t non_manifold_edges = 0;   ///< with three or more
  std::size_t flipped_edges = 0;        ///< whose two triangles disagree about the orientation
  std::size_t components = 0;           ///< connected parts
  std::size_t open_components = 0;      ///< with a boundary edge, holes too large to cap
  std::size_t sheet_triangles = 0;      ///< of open components
  std::size_t closed_parts = 0;         ///< components that are closed and of one orientation
  std::size_t capped_holes = 0;         ///< small holes of closed parts
  std::size_t turned_triangles = 0;     ///< of closed parts, turned over to agree with the rest of their part
};

struct Soup {
  Mesh mesh;                             ///< cleaned, vertices welded
  std::vector<std::uint8_t> open;        ///< per triangle: part of an open component
  std::vector<std::uint32_t> component;  ///< per triangle: names its connected component
  ClosedParts closed;                    ///< orientation repaired
  SoupReport report;
};

/// Welds, drops triangles without area and coincident duplicates (of both orientations), and looks at what is left.
/// Coincident pairs of opposite orientation are either a doubly faced surface (one stays) or the wall between two
/// touching solids (none stays): decided by whether the surface around them closes without them.
Soup clean_soup(const Mesh& mesh);

}  // namespace tact::contact
