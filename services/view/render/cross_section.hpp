#pragma once
#include <vector>

#include "mesh/mesh.hpp"
#include "view/model/slice_plane.hpp"

namespace tact::view {

/// A straight piece in the window of a slice: metres along u and v from its centre.
struct Segment {
  Eigen::Vector2f a, b;
};

/// Where the triangles of a mesh cut the plane, inside the window. O(triangles).
std::vector<Segment> cut(const Mesh& mesh_M, const Pose& X_OM, const SlicePlane& plane);

}  // namespace tact::view
