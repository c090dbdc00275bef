#include "view/render/image.hpp"

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "fault/fault.hpp"
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
  const std::filesystem::path part = path.string() + ".part";
  std::ofstream out(part, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(part, path, error);
  if (!out || error) {
    std::filesystem::remove(part, error);
    throw SetupError(path.string() + ": cannot write the picture; check that the folder exists and may be written");
  }
}

}  // namespace tact::view
