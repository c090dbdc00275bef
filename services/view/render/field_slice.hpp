#pragma once
#include <functional>
#include <span>

#include "view/model/slice_plane.hpp"
#include "view/render/cross_section.hpp"
#include "view/render/image.hpp"

namespace tact::view {

/// Signed distance at a point of O, metres, negative inside.
using FieldFunction = std::function<double(const Vec3& p_O)>;

/// The field in the window: outside blue, inside green, paler near the surface; the surface (value 0) as a dark line; a
/// fine line every voxel. Over it the tool's cross-section in red, and the contacts near the plane as dots with
/// their normals. A bar gives the scale.
Image draw_field_slice(const FieldFunction& field, const SlicePlane& plane, std::span<const Segment> tool,
                       const ViewScene& scene, int size);

}  // namespace tact::view
