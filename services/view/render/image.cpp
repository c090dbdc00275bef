#include "view/render/image.hpp"

#include <opencv2/imgcodecs.hpp>

#include "file/whole_file.hpp"
#include "view/render/canvas.hpp"

namespace tact::view {

Image::Image(int width_px, int height_px, Color fill) : width(width_px), height(height_px) {
  const std::size_t n = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  bgr.resize(3 * n);
  for (std::size_t i = 0; i < n; ++i)
    std::copy(fill.begin(), fill.end(), bgr.begin() + static_cast<std::ptrdiff_t>(3 * i));
}

std::string encode_jpeg(const Image& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", as_mat(image), bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

void write_png(const Image& image, const std::filesystem::path& path) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".png", as_mat(image), bytes);
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(bytes))};
  write_whole(path, parts);
}

}  // namespace tact::view
