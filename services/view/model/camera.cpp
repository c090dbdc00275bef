#include "view/model/camera.hpp"

#include <algorithm>
#include <cmath>

namespace tact::view {

Pose Camera::X_WE() const {
  const Vec3 z{std::cos(pitch_rad) * std::cos(yaw_rad), std::cos(pitch_rad) * std::sin(yaw_rad), std::sin(pitch_rad)};
  const Vec3 x = Vec3::UnitZ().cross(z).normalized();
  Mat3 R;
  R << x, z.cross(x), z;
  return {target_W + distance_m * z, Quat(R)};
}

double Camera::picture_height_m(const Vec3& p_W) const {
  const Pose X = X_WE();
  const double depth = std::max((X.p - p_W).dot(X.R().col(2)), 1e-3 * distance_m);
  return 2 * depth * std::tan(fov_y_rad / 2);
}

Eigen::Vector2d Camera::project(const Vec3& p_W, int width, int height) const {
  const Vec3 p_E = X_WE().inverse() * p_W;
  if (p_E.z() > -1e-6 * distance_m) return {-1e6, -1e6};
  const double scale = 0.5 * height / std::tan(fov_y_rad / 2) / -p_E.z();
  return {0.5 * width + scale * p_E.x(), 0.5 * height - scale * p_E.y()};
}

void Camera::orbit(double dyaw_rad, double dpitch_rad, double zoom) {
  constexpr double kMaxPitch = 85 * M_PI / 180;
  yaw_rad = std::remainder(yaw_rad + dyaw_rad, 2 * M_PI);
  pitch_rad = std::clamp(pitch_rad + dpitch_rad, -kMaxPitch, kMaxPitch);
  distance_m /= std::clamp(zoom, 0.1, 10.0);
}

Camera frame_ball(const Vec3& centre_W, double radius_m) {
  Camera camera;
  camera.target_W = centre_W;
  camera.distance_m = 1.05 * radius_m / std::sin(camera.fov_y_rad / 2);
  return camera;
}

}  // namespace tact::view
