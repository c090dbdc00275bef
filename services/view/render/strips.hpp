#pragma once
#include "view/model/view_scene.hpp"
#include "view/render/image.hpp"

namespace tact::view {

/// The last `window_s` seconds of force, torque, contacts, penetration and tick time, one strip under the other, newest
/// at the right edge. Each scale runs from 0 to a round number above the largest value shown; penetration carries a
/// line at x_max (where the coupling saturates), force one at k x_max.
Image draw_strips(const ViewScene& scene, int width, int height, double window_s = 20);

/// 1, 2 or 5 times a power of ten, not below `value`; 1e-3 for nothing.
double round_scale(double value);

}  // namespace tact::view
