#include "view/render/sheet.hpp"

#include <algorithm>

#include "view/render/canvas.hpp"

namespace tact::view {
namespace {

constexpr int kMargin = 20, kCaption = 30;

void paste(cv::Mat& sheet, const Image& image, int x, int y, const std::string& caption) {
  text(sheet, caption, x, y - 9, 11, ink::kText);
  if (image.width > 0) as_mat(image).copyTo(sheet(cv::Rect(x, y, image.width, image.height)));
}

}  // namespace

Image compose_sheet(const std::string& title, const Image& picture, const Image& gauss_map, const Image& slice,
                    const Image& strips) {
  const int plot = std::max({gauss_map.width, slice.width, 1});
  const int width = 3 * kMargin + std::max(picture.width, 1) + plot;
  const int top = kMargin + 2 * kCaption;
  const int upper = std::max(picture.height, gauss_map.height + kCaption + slice.height);
  const int lower = strips.width > 0 ? kCaption + strips.height : 0;
  Image sheet(std::max(width, 2 * kMargin + strips.width), top + upper + lower + kMargin);
  cv::Mat mat = as_mat(sheet);
  mat = ink::kPaper;
  text(mat, title, kMargin, kMargin + 18, 16, ink::kText);
  paste(mat, picture, kMargin, top, "Scene: obstacle blue, tool red, contact normals as arrows");
  const int right = 2 * kMargin + picture.width;
  paste(mat, gauss_map, right, top, "Gauss map: forces red, torques blue");
  paste(mat, slice, right, top + gauss_map.height + kCaption, "Field: outside blue, inside green");
  if (strips.width > 0) paste(mat, strips, kMargin, top + upper + kCaption, "Last 20 seconds");
  return sheet;
}

}  // namespace tact::view
