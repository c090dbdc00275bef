#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "math/pose.hpp"

namespace tact::shapes {

using Vec2 = Eigen::Vector2d;
/// A closed polygon in a plane, anticlockwise, no corner twice.
using Outline = std::vector<Vec2>;

Outline circle(double radius, int sides, const Vec2& centre = Vec2::Zero());
Outline rectangle(const Vec2& lowest, const Vec2& highest);

/// Corners (either way) replaced by arcs of `radius` in chords of about `edge`; a radius that two corners of a side
/// cannot both have is made smaller there.
Outline rounded(const Outline& corners, double radius, double edge);

/// As rounded(), but what lies on the axis x = 0 stays: for the profile of a lathe.
Outline rounded_profile(const Outline& corners, double radius, double edge);

Outline convex_hull(Outline points);

/// Convex hull of two circles: a link, a lug, a flange with two ears.
Outline link(const Vec2& a, double radius_a, const Vec2& b, double radius_b, double edge);

/// Spur gear: teeth trapezoidal, half of the pitch at mid height.
Outline gear(int teeth, double root_radius, double tip_radius);

/// Triangles, anticlockwise, of the area inside `outline` and outside the holes (anticlockwise too, apart from each
/// other and within). Indices count the corners of the outline, then those of the holes in order. Ear clipping: O(n^2).
std::vector<std::array<std::uint32_t, 3>> triangulate(const Outline& outline, const std::vector<Outline>& holes);

}  // namespace tact::shapes
