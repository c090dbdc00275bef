#pragma once
#include "view/model/camera.hpp"
#include "view/model/view_scene.hpp"
#include "view/render/image.hpp"

namespace tact::view {

/// The Gauss map of the contacts ([P] fig. 5): each contact's force direction N_i as a red dot and its torque direction
/// unit(r_i x N_i), r_i from To, as a blue dot on the unit sphere; bigger where more force acts. The sphere is seen as
/// the camera sees the scene (orthographic), so right is right; dots on the far side are hollow.
Image draw_gauss_map(const ViewScene& scene, const Camera& camera, int size);

/// Pixel of a unit direction in a map of that size. `far_side`: the dot is behind the sphere.
Eigen::Vector2d gauss_map_pixel(const Vec3& direction_W, const Camera& camera, int size, bool& far_side);

}  // namespace tact::view
