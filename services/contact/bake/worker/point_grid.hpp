#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Points sorted into cubic cells, for neighbours within a radius and for the nearest one.
class PointGrid {
 public:
  /// @pre cell > 0. Cells are enlarged when there would be many more of them than points.
  PointGrid(const std::vector<Vec3>& points, double cell) : points_(&points) {
    low_ = Vec3::Constant(std::numeric_limits<double>::max());
    Vec3 high = -low_;
    for (const Vec3& p : points) {
      low_ = low_.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    if (points.empty()) low_ = high = Vec3::Zero();
    const Vec3 size = high - low_;
    const auto cells = [&](double c) { return (size.x() / c + 1) * (size.y() / c + 1) * (size.z() / c + 1); };
    while (cells(cell) > 8.0 * static_cast<double>(points.size()) + 1000) cell *= 1.3;
    cell_ = cell;
    for (int i = 0; i < 3; ++i) n_[i] = static_cast<int>(size[i] / cell) + 1;
    begin_.assign(
        static_cast<std::size_t>(n_[0]) * static_cast<std::size_t>(n_[1]) * static_cast<std::size_t>(n_[2]) + 1, 0);
    std::vector<std::size_t> at(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      int c[3];
      locate(points[i], c);
      at[i] = index(c[0], c[1], c[2]);
      ++begin_[at[i] + 1];
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    order_.resize(points.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) order_[next[at[i]]++] = static_cast<std::uint32_t>(i);
  }

  /// visit(index, square distance) for the points within `radius` of p.
  template <class Visit>
  void within(const Vec3& p, double radius, Visit&& visit) const {
    int low[3], high[3];
    locate(p - Vec3::Constant(radius), low);
    locate(p + Vec3::Constant(radius), high);
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (std::size_t k = begin_[index(low[0], y, z)]; k < begin_[index(high[0], y, z) + 1]; ++k) {
          const double square = ((*points_)[order_[k]] - p).squaredNorm();
          if (square <= radius * radius) visit(order_[k], square);
        }
      }
    }
  }

  /// Index of the nearest point. @pre there is one
  std::uint32_t nearest(const Vec3& p) const {
    double best = std::numeric_limits<double>::max();
    std::uint32_t found = 0;
    for (double radius = cell_; best == std::numeric_limits<double>::max(); radius *= 2) {
      within(p, radius, [&](std::uint32_t i, double square) {
        if (square < best || (square == best && i < found)) {
          best = square;
          found = i;
        }
      });
    }
    return found;
  }

 private:
  void locate(const Vec3& p, int (&c)[3]) const {
    for (int i = 0; i < 3; ++i) {
      c[i] = static_cast<int>(std::clamp((p[i] - low_[i]) / cell_, 0.0, static_cast<double>(n_[i] - 1)));
    }
  }
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(n_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(n_[0]) +
           static_cast<std::size_t>(x);
  }

  const std::vector<Vec3>* points_;
  Vec3 low_;
  double cell_ = 1;
  int n_[3];
  std::vector<std::uint32_t> begin_;  ///< by cell
  std::vector<std::uint32_t> order_;
};

}  // namespace tact::contact
