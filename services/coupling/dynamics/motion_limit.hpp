#pragma once
#include "coupling/dynamics/tool_integrator.hpp"

namespace tact::coupling {

/// Bounds the motion of every point of the tool, |dp| + |theta| r with r its radius about To: the tool may be no
/// farther than `allowed_m` from the pose the contact server last answered for. With a reply each tick that is the
/// motion of one tick; with late replies several ticks share it, so nothing is passed through unseen.
struct MotionLimit {
  double tool_radius_m = 0;

  double motion_m(const Pose& X_WA, const Pose& X_WB) const noexcept;

  /// `next` was integrated from `X_before`. Cuts it (and its twist, in proportion) if it went too far; true when it
  /// did. Moving back towards X_answered is never cut.
  bool apply(const Pose& X_answered, const Pose& X_before, BodyState& next, double allowed_m) const noexcept;
};

}  // namespace tact::coupling
