#pragma once
#include "mesh/mesh.hpp"

namespace tact::shapes {

/// Adds the box of opposite corners `lowest` and `highest`: 12 triangles.
void add_box(Mesh& mesh, const Vec3& lowest, const Vec3& highest);

/// Prism with a regular polygon of `sides` sides, `width` across flats (a side faces +x; sides = 4: axis-aligned),
/// standing on z = 0, axis z.
Mesh prism(int sides, double width, double height);

/// Pyramid over a regular polygon inscribed in the circle of `radius`: base in z = 0, tip at z = height.
Mesh cone(int sides, double radius, double height);

/// Prism with a coaxial blind hole from the top: the hole's bottom is z = 0, its mouth z = depth, the block reaches
/// down to z = -floor. Widths across flats.
Mesh socket(int sides, double hole_width, double block_width, double depth, double floor);

}  // namespace tact::shapes
