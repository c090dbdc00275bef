#include "field/block_transform.hpp"

#include <cmath>
#include <limits>

namespace tact {
namespace {

constexpr float kFar = 1e20f;  // squared; finite, so that differences stay defined

/// One line of the transform: lower envelope of the parabolas y = f[q] + (x - q)^2, after Felzenszwalb and
/// Huttenlocher, "Distance Transforms of Sampled Functions", 2012.
struct Line {
  std::vector<float> f, out;
  std::vector<double> border;
  std::vector<std::size_t> apex;

  explicit Line(std::size_t n) : f(n), out(n), border(n + 1), apex(n) {}

  void run(std::size_t n) {
    const auto cross = [this](std::size_t p, std::size_t q) {
      const auto a = static_cast<double>(p), b = static_cast<double>(q);
      return ((static_cast<double>(f[q]) + b * b) - (static_cast<double>(f[p]) + a * a)) / (2 * b - 2 * a);
    };
    constexpr double kInf = std::numeric_limits<double>::infinity();
    std::size_t k = 0;
    apex[0] = 0;
    border[0] = -kInf;
    border[1] = kInf;
    for (std::size_t q = 1; q < n; ++q) {
      double s = cross(apex[k], q);
      while (s <= border[k]) s = cross(apex[--k], q);
      apex[++k] = q;
      border[k] = s;
      border[k + 1] = kInf;
    }
    k = 0;
    for (std::size_t x = 0; x < n; ++x) {
      while (border[k + 1] < static_cast<double>(x)) ++k;
      const float d = static_cast<float>(x) - static_cast<float>(apex[k]);
      out[x] = f[apex[k]] + d * d;
    }
  }
};

}  // namespace

std::vector<float> distance_between_blocks(const FieldGrid& grid, const std::vector<std::uint8_t>& marked) {
  std::vector<float> square(marked.size());
  for (std::size_t i = 0; i < marked.size(); ++i) square[i] = marked[i] ? 0 : kFar;
  const std::size_t n[3] = {static_cast<std::size_t>(grid.blocks[0]), static_cast<std::size_t>(grid.blocks[1]),
                            static_cast<std::size_t>(grid.blocks[2])};
  const std::size_t stride[3] = {1, n[0], n[0] * n[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    Line line(n[axis]);
    for (std::size_t a = 0; a < n[u]; ++a) {
      for (std::size_t b = 0; b < n[v]; ++b) {
        const std::size_t start = a * stride[u] + b * stride[v];
        for (std::size_t i = 0; i < n[axis]; ++i) line.f[i] = square[start + i * stride[axis]];
        line.run(n[axis]);
        for (std::size_t i = 0; i < n[axis]; ++i) square[start + i * stride[axis]] = line.out[i];
      }
    }
  }
  for (float& s : square) s = s >= kFar ? std::numeric_limits<float>::infinity() : std::sqrt(s);
  return square;
}

}  // namespace tact
