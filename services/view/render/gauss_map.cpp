#include "view/render/gauss_map.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "view/render/canvas.hpp"

namespace tact::view {
namespace {

constexpr double kRadius = 0.42;  // of the sphere, in picture sizes

class Map {
 public:
  Map(const Camera& camera, int size) : camera_(camera), size_(size), image_(size, size), mat_(as_mat(image_)) {
    mat_ = ink::kPaper;
    const cv::Point centre = subpixel(0.5 * size, 0.5 * size);
    const int radius = subpixel(kRadius * size, 0).x;
    cv::circle(mat_, centre, radius, {246, 241, 236}, cv::FILLED, cv::LINE_AA, kShift);
    graticule();
    cv::circle(mat_, centre, radius, ink::kAxis, line(1.2), cv::LINE_AA, kShift);
  }

  void dot(const Vec3& direction_W, double share, const cv::Scalar& colour, bool draw_far) {
    bool far_side = false;
    const Eigen::Vector2d p = gauss_map_pixel(direction_W, camera_, size_, far_side);
    if (far_side != draw_far) return;
    const int radius = subpixel(size_ * (0.008 + 0.014 * std::sqrt(share)), 0).x;
    if (far_side) {
      cv::circle(mat_, subpixel(p.x(), p.y()), radius, 0.5 * colour + 0.5 * cv::Scalar(246, 241, 236), line(1),
                 cv::LINE_AA, kShift);
    } else {
      cv::circle(mat_, subpixel(p.x(), p.y()), radius, colour, cv::FILLED, cv::LINE_AA, kShift);
    }
  }

  void axes() {
    const char* names[] = {"x", "y", "z"};
    for (int i = 0; i < 3; ++i) {
      bool far_side = false;
      const Eigen::Vector2d centre = Eigen::Vector2d::Constant(0.5 * size_);
      const Eigen::Vector2d tip = gauss_map_pixel(Vec3::Unit(i), camera_, size_, far_side) - centre;
      const cv::Scalar colour = far_side ? cv::Scalar(190, 180, 170) : ink::kText;
      const Eigen::Vector2d from = centre + tip, to = centre + 1.1 * tip, name = centre + 1.165 * tip;
      cv::line(mat_, subpixel(from.x(), from.y()), subpixel(to.x(), to.y()), colour, line(1.5), cv::LINE_AA, kShift);
      text(mat_, names[i], name.x(), name.y() + 0.017 * size_, 0.036 * size_, colour, Align::centre);
    }
  }

  Image take() { return std::move(image_); }
  cv::Mat& mat() { return mat_; }

 private:
  int line(double width) const { return std::max(1, static_cast<int>(std::lround(width * size_ / 300.0))); }

  // Meridians and parallels of the world's z axis, every 30 degrees; the near half only.
  void graticule() {
    constexpr int kSteps = 72;
    for (int k = 0; k < 6; ++k) {
      const double angle = k * M_PI / 6;
      curve(kSteps,
            [&](double t) { return Vec3(std::cos(angle) * std::cos(t), std::sin(angle) * std::cos(t), std::sin(t)); });
    }
    for (int k = -2; k <= 2; ++k) {
      const double angle = k * M_PI / 6;
      curve(kSteps, [&](double t) {
        return Vec3(std::cos(angle) * std::cos(t), std::cos(angle) * std::sin(t), std::sin(angle));
      });
    }
  }

  template <class Curve>
  void curve(int steps, const Curve& direction) {
    for (int i = 0; i < steps; ++i) {
      bool far_a = false, far_b = false;
      const Eigen::Vector2d a = gauss_map_pixel(direction(2 * M_PI * i / steps), camera_, size_, far_a);
      const Eigen::Vector2d b = gauss_map_pixel(direction(2 * M_PI * (i + 1) / steps), camera_, size_, far_b);
      if (far_a || far_b) continue;
      cv::line(mat_, subpixel(a.x(), a.y()), subpixel(b.x(), b.y()), ink::kGrid, line(0.7), cv::LINE_AA, kShift);
    }
  }

  Camera camera_;
  int size_;
  Image image_;
  cv::Mat mat_;
};

}  // namespace

Eigen::Vector2d gauss_map_pixel(const Vec3& direction_W, const Camera& camera, int size, bool& far_side) {
  const Vec3 d_E = camera.X_WE().q.conjugate() * direction_W;
  far_side = d_E.z() < 0;
  return {size * (0.5 + kRadius * d_E.x()), size * (0.5 - kRadius * d_E.y())};
}

Image draw_gauss_map(const ViewScene& scene, const Camera& camera, int size) {
  Map map(camera, size);
  double largest = 0;
  for (const Contact& contact : scene.contact_set.contacts) largest = std::max(largest, contact.force_W.norm());
  for (const bool far_side : {true, false}) {
    for (const Contact& contact : scene.contact_set.contacts) {
      const double share = largest > 0 ? contact.force_W.norm() / largest : 0;
      const Vec3 torque_direction = (contact.p_W - scene.contact_set.X_WT.p).cross(contact.N_W);
      // A normal through To turns nothing: no direction to show.
      if (torque_direction.norm() > 1e-9) map.dot(torque_direction.normalized(), share, ink::kTorque, far_side);
      map.dot(contact.N_W, share, ink::kForce, far_side);
    }
  }
  map.axes();
  return map.take();
}

}  // namespace tact::view
