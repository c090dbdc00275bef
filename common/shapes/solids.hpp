#pragma once
#include <vector>

#include "mesh/mesh.hpp"
#include "shapes/outline.hpp"

namespace tact::shapes {

/// Adds the box of opposite corners `lowest` and `highest`: 12 triangles.
void add_box(Mesh& mesh, const Vec3& lowest, const Vec3& highest);

/// Adds a part made in its own frame P: p_M = X_MP p_P.
void append(Mesh& mesh, const Mesh& part, const Pose& X_MP = {});

/// A frame at `origin` whose z axis is along `z`, and whose x axis is as near to `x` as it can be.
Pose frame(const Vec3& origin, const Vec3& z, const Vec3& x);
Pose frame(const Vec3& origin, const Vec3& z);  ///< x: any_perpendicular(z)

/// A unit vector perpendicular to v, the same every time.
Vec3 any_perpendicular(const Vec3& v);

/// Prism with a regular polygon of `sides` sides, `width` across flats (a side faces +x; sides = 4: axis-aligned),
/// standing on z = 0, axis z.
Mesh prism(int sides, double width, double height);

/// Pyramid over a regular polygon inscribed in the circle of `radius`: base in z = 0, tip at z = height.
Mesh cone(int sides, double radius, double height);

/// Prism with a coaxial blind hole from the top: the hole's bottom is z = 0, its mouth z = depth, the block reaches
/// down to z = -floor. Widths across flats.
Mesh socket(int sides, double hole_width, double block_width, double depth, double floor);

/// The plate of an outline with holes, from z = low to z = high.
Mesh plate(const Outline& outline, const std::vector<Outline>& holes, double low, double high);

/// Solid of revolution about z. `profile`: corners (r, z) of the half section, closed by itself, r >= 0; where two
/// corners in a row lie on the axis the solid is full, else it is a ring. Either direction.
Mesh lathe(const Outline& profile, int sides);

/// A closed skin over rings of equally many corners each (anticlockwise seen against the way from ring to ring), ends
/// closed by fans round their middles: they are star-shaped.
Mesh loft(const std::vector<std::vector<Vec3>>& rings);

/// A block standing on z = 0 with its convex outline drawn in by `bevel` at both ends.
Mesh bevelled(const Outline& outline, double height, double bevel);

}  // namespace tact::shapes
