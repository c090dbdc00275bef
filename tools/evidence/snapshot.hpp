#pragma once
#include "bench/scene.hpp"
#include "lockstep/lockstep.hpp"
#include "view/model/view_scene.hpp"
#include "view/render/image.hpp"

namespace tact::evidence {

/// What the view would show of the rig's last tick: scene, contact normals, Gauss map, slice of the field.
view::ViewScene view_of(const bench::LoadedScene& scene, const std::string& law, lockstep::Lockstep& rig);

/// Draws it, by the product's own view, into a JPEG: the scene at the left, Gauss map and slice at its right. The
/// camera looks at the tool from `yaw_rad`, `pitch_rad`, `radii` tool radii away.
struct Look {
  double yaw_rad = -0.9, pitch_rad = 0.45, radii = 2.5;
};
void snapshot(const view::ViewScene& scene, const Look& look, const std::filesystem::path& jpeg);

}  // namespace tact::evidence
