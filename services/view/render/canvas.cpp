#include "view/render/canvas.hpp"

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace tact::view {

cv::Mat as_mat(Image& image) { return {image.height, image.width, CV_8UC3, image.bgr.data()}; }
const cv::Mat as_mat(const Image& image) {
  return {image.height, image.width, CV_8UC3, const_cast<std::uint8_t*>(image.bgr.data())};
}

cv::Point subpixel(double x, double y) {
  const auto fix = [](double v) { return static_cast<int>(std::lround(std::clamp(v, -1e5, 1e5) * (1 << kShift))); };
  return {fix(x), fix(y)};
}

void text(cv::Mat& mat, const std::string& words, double x, double y, double size, const cv::Scalar& colour,
          Align align) {
  constexpr double kCapital = 21;  // height of a capital letter of this font at scale 1
  const double scale = size / kCapital;
  const int thickness = size > 15.5 ? 2 : 1;
  if (align != Align::left) {
    int baseline = 0;
    const double width = cv::getTextSize(words, cv::FONT_HERSHEY_DUPLEX, scale, thickness, &baseline).width;
    x -= align == Align::right ? width : width / 2;
  }
  cv::putText(mat, words, cv::Point(static_cast<int>(std::lround(x)), static_cast<int>(std::lround(y))),
              cv::FONT_HERSHEY_DUPLEX, scale, colour, thickness, cv::LINE_AA);
}

std::string short_number(double value) {
  char text[32];
  if (std::abs(value) >= 1e3) {
    std::snprintf(text, sizeof text, "%.3gk", value / 1e3);
  } else {
    std::snprintf(text, sizeof text, "%.3g", value);
  }
  return text;
}

}  // namespace tact::view
