#pragma once
#include <memory>

#include "contact/bake/baked_scene.hpp"
#include "contact/model/pointshell.hpp"
#include "field/distance_field.hpp"
#include "session/session.hpp"

namespace tact::lockstep {

/// What meets: the obstacle's field and the tool's points.
struct Bodies {
  DistanceField field;
  std::shared_ptr<const contact::Pointshell> shell;
};

/// Maps what contact::ensure_baked found or made. Throws SetupError.
Bodies open_bodies(const contact::BakedScene& baked);

/// A scene whose bodies have closed forms: no bake, some milliseconds to make. Its spec holds where the tool starts and
/// defaults otherwise; its hand presses along -z for 10 N and more.
struct AnalyticScene {
  SceneSpec spec;
  Bodies bodies;
  HandMotion motion_WM;
};

/// A square foot of `points` points at equal distances, 40 mm wide, on the half-space z < 0. A voxel is 1 mm.
AnalyticScene flat_face(int points);
/// The lower part of a ball of 20 mm radius on the half-space: no contact has a lever, so none makes a torque.
AnalyticScene ball_on_plane(int points);
/// A flat foot across three parallel wires, each two voxels thick.
AnalyticScene foot_on_wires(int points);

}  // namespace tact::lockstep
