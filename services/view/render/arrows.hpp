#pragma once
#include <vector>

#include "view/model/view_scene.hpp"
#include "view/render/image.hpp"

namespace tact::view {

/// A solid arrow or, with head_m = 0, a rod; in W.
struct Arrow {
  Vec3 tail_W, tip_W;
  double radius_m = 0;  ///< of the shaft
  double head_m = 0;    ///< length of the head
  Color color{};
};

/// The contact normals as arrows that start at the contact points, longer where more force acts, the `limit` strongest
/// only; and a line from the tool to the hand's handle where they differ by more than a voxel. `size_m`: length of the
/// longest arrow.
std::vector<Arrow> contact_arrows(const ViewScene& scene, double size_m, std::size_t limit = 200);

}  // namespace tact::view
