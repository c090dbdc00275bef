#include "view/render/field_slice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "view/render/canvas.hpp"

namespace tact::view {
namespace {

const cv::Vec3d kOutsideNear(250, 236, 222), kOutsideFar(214, 160, 104), kInsideNear(212, 240, 218),
    kInsideFar(96, 168, 92);
const cv::Scalar kTool{52, 52, 200};

class Slice {
 public:
  Slice(const SlicePlane& plane, int size)
      : plane_(plane),
        size_(size),
        px_per_m_(size / (2 * plane.half_side_m)),
        image_(size, size),
        mat_(as_mat(image_)) {}

  Eigen::Vector2d pixel(double u_m, double v_m) const {
    return {0.5 * size_ + px_per_m_ * u_m, 0.5 * size_ - px_per_m_ * v_m};
  }

  void field(const FieldFunction& field, double voxel_m) {
    const int n = (size_ - 1) / 2 + 2;  // one sample every second pixel, on pixel corners, and one beyond the last
    cv::Mat values(n, n, CV_32F);
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) {
        const double u = (2.0 * column - 0.5 * size_) / px_per_m_, v = (0.5 * size_ - 2.0 * row) / px_per_m_;
        values.at<float>(row, column) = static_cast<float>(field(plane_.centre_O + u * plane_.u_O + v * plane_.v_O));
      }
    }
    // Colour saturates at four voxels: there the eye needs the difference.
    const double range = 4 * voxel_m, px_m = 1 / px_per_m_;
    for (int y = 0; y < size_; ++y) {
      for (int x = 0; x < size_; ++x) {
        const float* a = values.ptr<float>(y / 2) + x / 2;
        const float* b = values.ptr<float>(y / 2 + 1) + x / 2;
        const float fx = y_odd(x), fy = y_odd(y);
        const double d = (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
        const double s = std::min(std::abs(d) / range, 1.0);
        cv::Vec3d colour = d < 0 ? (1 - s) * kInsideNear + s * kInsideFar : (1 - s) * kOutsideNear + s * kOutsideFar;
        const double to_voxel_line = std::abs(std::remainder(d, voxel_m));
        if (std::abs(d) < range) colour *= 1 - 0.10 * std::clamp(1.2 - to_voxel_line / px_m, 0.0, 1.0);
        const double zero = std::clamp(1.8 - std::abs(d) / px_m, 0.0, 1.0);
        colour = (1 - zero) * colour + zero * cv::Vec3d(90, 62, 44);
        mat_.at<cv::Vec3b>(y, x) = colour;
      }
    }
  }

  void outline(std::span<const Segment> segments) {
    for (const Segment& s : segments) {
      const Eigen::Vector2d a = pixel(s.a.x(), s.a.y()), b = pixel(s.b.x(), s.b.y());
      cv::line(mat_, subpixel(a.x(), a.y()), subpixel(b.x(), b.y()), kTool, line(1.6), cv::LINE_AA, kShift);
    }
  }

  void contacts(const ViewScene& scene) {
    const ContactSet& set = scene.contact_set;
    const Pose X_OW = set.X_WO.inverse();
    const Vec3 n_O = plane_.u_O.cross(plane_.v_O);
    for (const Contact& contact : set.contacts) {
      const Vec3 p = X_OW * contact.p_W - plane_.centre_O;
      if (std::abs(n_O.dot(p)) > scene.info.voxel_m) continue;
      const Vec3 N = X_OW.q * contact.N_W;
      const Eigen::Vector2d from = pixel(plane_.u_O.dot(p), plane_.v_O.dot(p));
      const Eigen::Vector2d to = from + 0.06 * size_ * Eigen::Vector2d(plane_.u_O.dot(N), -plane_.v_O.dot(N));
      cv::line(mat_, subpixel(from.x(), from.y()), subpixel(to.x(), to.y()), ink::kForce, line(1), cv::LINE_AA, kShift);
      cv::circle(mat_, subpixel(from.x(), from.y()), subpixel(0.009 * size_, 0).x, ink::kForce, cv::FILLED, cv::LINE_AA,
                 kShift);
    }
  }

  void scale_bar() {
    double length_m = std::pow(10.0, std::floor(std::log10(0.6 * plane_.half_side_m)));
    for (const double step : {5.0, 2.0}) {
      if (step * length_m <= 0.6 * plane_.half_side_m) {
        length_m *= step;
        break;
      }
    }
    const double x = 0.05 * size_, y = 0.95 * size_;
    cv::line(mat_, subpixel(x, y), subpixel(x + length_m * px_per_m_, y), ink::kText, line(2), cv::LINE_AA, kShift);
    text(mat_, short_number(1e3 * length_m) + " mm", x, y - 0.025 * size_, 0.038 * size_, ink::kText);
  }

  void frame_names() {
    const char* names[] = {"x", "y", "z"};
    const auto name = [&](const Vec3& axis) {
      Eigen::Index i = 0;
      axis.cwiseAbs().maxCoeff(&i);
      return std::string(axis[i] < 0 ? "-" : "+") + names[i];
    };
    text(mat_, name(plane_.u_O), 0.97 * size_, 0.52 * size_, 0.038 * size_, ink::kText, Align::right);
    text(mat_, name(plane_.v_O), 0.5 * size_, 0.06 * size_, 0.038 * size_, ink::kText, Align::centre);
  }

  Image take() { return std::move(image_); }

 private:
  static float y_odd(int i) { return i % 2 == 0 ? 0.25f : 0.75f; }  // pixel centres between the sampled corners
  int line(double width) const { return std::max(1, static_cast<int>(std::lround(width * size_ / 300.0))); }

  SlicePlane plane_;
  int size_;
  double px_per_m_;
  Image image_;
  cv::Mat mat_;
};

}  // namespace

Image draw_field_slice(const FieldFunction& field, const SlicePlane& plane, std::span<const Segment> tool,
                       const ViewScene& scene, int size) {
  Slice slice(plane, size);
  slice.field(field, scene.info.voxel_m);
  slice.outline(tool);
  slice.contacts(scene);
  slice.frame_names();
  slice.scale_bar();
  return slice.take();
}

}  // namespace tact::view
