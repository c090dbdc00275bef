#pragma once
#include <string>
#include <vector>

#include "session/session.hpp"

namespace tact::scenes {

/// Where the tool's mesh frame M is held at a time: a point of the tool lies on a point of the world, turned by q_WM.
/// A tool that turns about something it holds moves along an arc; the point of it that is held moves along a line.
struct KeyPose {
  double time_s;
  Vec3 p_W;  ///< the point in the world...
  Vec3 p_M;  ///< ...and the point of the tool that lies there
  Quat q_WM = Quat::Identity();

  Pose X_WM() const { return {p_W - q_WM * p_M, q_WM}; }
};

/// From rest to rest between keys, each stretch with the minimum-jerk profile 10 u^3 - 15 u^4 + 6 u^5 in both points
/// and the angle (shortest way). Sampled `rate_hz` times a second. Largest speed: 15/8 of the mean.
HandMotion minimum_jerk(const std::vector<KeyPose>& keys, double rate_hz);

/// As load_hand_motion reads it: 1 um, 1e-7.
std::string to_csv(const HandMotion& motion);

}  // namespace tact::scenes
