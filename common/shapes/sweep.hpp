#pragma once
#include <functional>
#include <vector>

#include "mesh/mesh.hpp"

namespace tact::shapes {

/// Points along a line in space, none twice in a row.
using Path = std::vector<Vec3>;

/// Straight pieces between `corners`, joined by arcs of `bend_radius` (less where a piece is too short for two), with a
/// point about every `step`.
Path pipe_path(const Path& corners, double bend_radius, double step);

/// A cable's way: a smooth curve through `points` (centripetal Catmull-Rom), with a point about every `step`.
Path cable_path(const Path& points, double step);

/// One strand of a bundle: beside `path` at (radius, angle) in a frame that turns with the path as little as it can,
/// and by `twist_per_m` about it.
Path strand(const Path& path, double radius, double angle, double twist_per_m);

double length(const Path& path);

/// A round rod along the path with flat ends: rings of `sides` corners on every point. `radius_at` (the length from the
/// beginning) makes bellows and ribbed hoses.
Mesh tube(const Path& path, double radius, int sides);
Mesh tube(const Path& path, const std::function<double(double)>& radius_at, int sides);

}  // namespace tact::shapes
