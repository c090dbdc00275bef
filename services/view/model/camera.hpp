#pragma once
#include "math/pose.hpp"

namespace tact::view {

/// Perspective camera that orbits a target; the world's z axis stays up.
/// Eye frame E: x right, y up in the picture, z towards the viewer. Pictures: x to the right, y down, in pixels.
struct Camera {
  Vec3 target_W = Vec3::Zero();
  double yaw_rad = -0.9, pitch_rad = 0.45;  ///< of the eye about the target; pitch 0: level with it
  double distance_m = 1;
  double fov_y_rad = 0.6;

  Pose X_WE() const;

  /// Height in metres of what fills the picture at the depth of p_W.
  double picture_height_m(const Vec3& p_W) const;

  /// Pixel of a point, or a point far outside the picture when it lies behind the eye.
  Eigen::Vector2d project(const Vec3& p_W, int width, int height) const;

  /// A quarter of a turn is pi/2; pitch stays within +-85 degrees. zoom > 1 comes closer.
  void orbit(double dyaw_rad, double dpitch_rad, double zoom);
};

/// A camera that sees a whole ball.
Camera frame_ball(const Vec3& centre_W, double radius_m);

}  // namespace tact::view
