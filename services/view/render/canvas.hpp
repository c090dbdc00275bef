#pragma once
#include <opencv2/core.hpp>
#include <string>

#include "view/render/image.hpp"

/// OpenCV's view of our pictures. For the .cpp files of this folder only.
namespace tact::view {

/// Shares the pixels of `image`.
cv::Mat as_mat(Image& image);
const cv::Mat as_mat(const Image& image);

/// One hand for all drawings: the same colours mean the same things in the picture, the plots and the page.
namespace ink {
inline const cv::Scalar kPaper{252, 250, 249}, kGrid{226, 220, 215}, kAxis{150, 138, 128}, kText{84, 70, 58},
    kForce{60, 60, 205}, kTorque{205, 110, 40}, kContacts{120, 90, 60}, kDepth{70, 140, 40}, kTick{150, 80, 140},
    kLimit{60, 150, 235};
}  // namespace ink

/// Coordinates in 1/16 pixel for OpenCV's anti-aliased shapes.
constexpr int kShift = 4;
cv::Point subpixel(double x, double y);

enum class Align { left, right, centre };
/// Text whose lower edge is at y; size in pixels of a capital letter.
void text(cv::Mat& mat, const std::string& words, double x, double y, double size, const cv::Scalar& colour,
          Align align = Align::left);

/// "0", "0.25", "12", "1.5k": at most three significant digits.
std::string short_number(double value);

}  // namespace tact::view
