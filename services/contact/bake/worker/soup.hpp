#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh.hpp"

namespace tact::contact {

/// What was found in a triangle soup, after welding vertices nearer than a millionth of its size.
struct SoupReport {
  std::size_t triangles_read = 0, triangles_kept = 0;
  std::size_t degenerate = 0;           ///< without area: dropped
  std::size_t duplicates_same = 0;      ///< coincident copies of equal orientation: dropped
  std::size_t duplicates_opposite = 0;  ///< coincident copies of opposite orientation (doubly faced): dropped
  std::size_t inner_walls = 0;          ///< faces two touching solids share: both sides dropped
  std::size_t boundary_edges = 0;       ///< with one triangle, after cleaning
  std::size_t non_manifold_edges = 0;   ///< with three or more
  std::size_t flipped_edges = 0;        ///< whose two triangles disagree about the orientation
  std::size_t components = 0;           ///< connected parts
  std::size_t open_components = 0;      ///< with a boundary edge
  std::size_t sheet_triangles = 0;      ///< of open components
};

struct Soup {
  Mesh mesh;                       ///< cleaned, vertices welded
  std::vector<std::uint8_t> open;  ///< per triangle: part of an open component
  SoupReport report;
};

/// Welds, drops triangles without area and coincident duplicates (of both orientations), and looks at what is left.
/// Coincident pairs of opposite orientation are either a doubly faced surface (one stays) or the wall between two
/// touching solids (none stays): decided by whether the surface around them closes without them.
Soup clean_soup(const Mesh& mesh);

}  // namespace tact::contact
