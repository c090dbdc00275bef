#pragma once
#include <limits>

#include "contact/bake/worker/surface.hpp"

namespace tact::contact {

/// How thick a wall is, or how wide a gap: from p, on a surface, along the unit normal `direction` to the first face
/// met, when that face looks back within 25 degrees (so the edge of a wedge is no wall). Infinite when it does not, or
/// when nothing is met within `reach_m`. Thinner than 2e-5 of the size is not seen.
double opposite_face_m(const Surface& surface, const Vec3& p, const Vec3& direction,
                       double reach_m = std::numeric_limits<double>::infinity());

}  // namespace tact::contact
