#pragma once
#include "math/pose.hpp"
#include "view/model/view_scene.hpp"

namespace tact::view {

/// A square window in space: centre, unit axes u (right) and v (up), half side. In O.
struct SlicePlane {
  Vec3 centre_O = Vec3::Zero(), u_O = Vec3::UnitX(), v_O = Vec3::UnitY();
  double half_side_m = 0;
};

/// Chooses the window through the deepest contact (without contacts: where the last one was, at first To): parallel to
/// a coordinate plane of O, the one that shows most of the contact's normal and faces the viewer; the choice is sticky,
/// so that the window does not flip between two nearly equal planes.
class SlicePlaneChooser {
 public:
  /// view_O: unit vector towards the viewer, up_O: up in the picture.
  SlicePlane choose(const ViewScene& scene, const Vec3& view_O, const Vec3& up_O);

 private:
  int axis_ = 2;
  bool seen_contact_ = false;
  Vec3 centre_O_ = Vec3::Zero();
};

}  // namespace tact::view
