#include "view/model/slice_plane.hpp"

#include <algorithm>
#include <cmath>

namespace tact::view {
namespace {

constexpr double kHalfSideVoxels = 14;
constexpr double kSticky = 1.4;  // another plane must be this much better

// The coordinate axis of O nearest to `direction` among those not parallel to `normal_axis`, with its sign.
Vec3 nearest_axis(const Vec3& direction, int normal_axis) {
  Vec3 d = direction;
  d[normal_axis] = 0;
  Eigen::Index i = 0;
  d.cwiseAbs().maxCoeff(&i);
  if (i == normal_axis) i = (normal_axis + 1) % 3;
  Vec3 axis = Vec3::Zero();
  axis[i] = d[i] < 0 ? -1 : 1;
  return axis;
}

}  // namespace

SlicePlane SlicePlaneChooser::choose(const ViewScene& scene, const Vec3& view_O, const Vec3& up_O) {
  const ContactSet& set = scene.contact_set;
  const auto deepest = std::max_element(set.contacts.begin(), set.contacts.end(),
                                        [](const Contact& a, const Contact& b) { return a.depth_m < b.depth_m; });
  const Pose X_OW = set.X_WO.inverse();
  Vec3 N_O = Vec3::Zero();
  if (deepest != set.contacts.end()) {
    centre_O_ = X_OW * deepest->p_W;
    N_O = X_OW.q * deepest->N_W;
    seen_contact_ = true;
  } else if (!seen_contact_) {
    centre_O_ = scene.info.X_WO.inverse() * scene.device.X_WT.p;
  }
  const auto score = [&](int axis) { return (0.1 + std::abs(view_O[axis])) * (1.02 - std::abs(N_O[axis])); };
  for (int axis = 0; axis < 3; ++axis) {
    if (score(axis) > kSticky * score(axis_)) axis_ = axis;
  }
  SlicePlane plane;
  plane.centre_O = centre_O_;
  plane.v_O = nearest_axis(up_O, axis_);
  // Right-handed as seen from the viewer's side: u x v points towards the viewer.
  Vec3 towards = Vec3::Zero();
  towards[axis_] = view_O[axis_] < 0 ? -1 : 1;
  plane.u_O = plane.v_O.cross(towards);
  plane.half_side_m = kHalfSideVoxels * scene.info.voxel_m;
  return plane;
}

}  // namespace tact::view
