#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tact::view {

using Color = std::array<std::uint8_t, 3>;  ///< blue, green, red: OpenCV's order

/// A picture: rows from the top, three bytes a pixel.
struct Image {
  Image() = default;
  Image(int width_px, int height_px, Color fill = {255, 255, 255});

  int width = 0, height = 0;
  std::vector<std::uint8_t> bgr;

  Color at(int x, int y) const {
    const std::size_t i =
        3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    return {bgr[i], bgr[i + 1], bgr[i + 2]};
  }
};

/// quality 1..100.
std::string encode_jpeg(const Image& image, int quality);

/// Throws SetupError, naming the file, when it cannot be written. A reader never sees half a picture.
void write_png(const Image& image, const std::filesystem::path& path);

}  // namespace tact::view
