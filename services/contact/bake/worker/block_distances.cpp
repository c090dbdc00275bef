#include "contact/bake/worker/block_distances.hpp"

#include <algorithm>
#include <cmath>

namespace tact::contact {
namespace {
constexpr std::size_t kFewTriangles = 96;  ///< above, halving a cube is cheaper than looking at all of them
double half_diagonal(int cells, double h) { return std::sqrt(3.0) / 2 * cells * h; }
}  // namespace

void BlockDistances::compute(int x, int y, int z, double limit_m, std::span<float, kBlockValues> out) {
  origin_ = grid_->corner_O(kBlockCells * x, kBlockCells * y, kBlockCells * z) - surface_->middle();
  limit_m_ = limit_m;
  out_ = out;
  std::fill(out.begin(), out.end(), static_cast<float>(limit_m));
  search({0, 0, 0, kBlockCells});
}

BlockDistances::Cube BlockDistances::part(const Cube& c, int k) const {
  const int half = c.cells / 2;
  return {c.x + ((k & 1) ? half : 0), c.y + ((k & 2) ? half : 0), c.z + ((k & 4) ? half : 0), half};
}

Vec3 BlockDistances::centre(const Cube& c) const {
  return origin_ + grid_->voxel_m * Vec3(c.x + 0.5 * c.cells, c.y + 0.5 * c.cells, c.z + 0.5 * c.cells);
}

/// A cube owns its lower corners, and its upper ones at the end of the block.
template <class Visit>
void BlockDistances::for_each_corner(const Cube& c, Visit&& visit) {
  const auto last = [&](int from) { return from + c.cells - (from + c.cells == kBlockCells ? 0 : 1); };
  for (int z = c.z; z <= last(c.z); ++z) {
    for (int y = c.y; y <= last(c.y); ++y) {
      for (int x = c.x; x <= last(c.x); ++x) visit(x, y, z);
    }
  }
}

void BlockDistances::search(const Cube& c) {
  const double r = half_diagonal(c.cells, grid_->voxel_m);
  const Vec3 p = centre(c) + surface_->middle();
  const double d = surface_->distance(p, limit_m_ + r);
  if (d >= limit_m_ + r) return;  // all corners are beyond the limit
  if (surface_->near(p, d + 2 * r, kFewTriangles, near_[0])) {
    refine(c, near_[0], 1);
  } else if (c.cells > 2) {
    for (int k = 0; k < 8; ++k) search(part(c, k));
  } else {
    each_corner(c);
  }
}

void BlockDistances::refine(const Cube& c, const std::vector<std::uint32_t>& candidates, int depth) {
  const double r = half_diagonal(c.cells, grid_->voxel_m);
  const Vec3 p = centre(c);
  square_.resize(candidates.size());
  double nearest = (limit_m_ + r) * (limit_m_ + r);
  bool any = false;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    square_[i] = surface_->triangle(candidates[i]).square_distance(p);
    if (square_[i] <= nearest) {
      nearest = square_[i];
      any = true;
    }
  }
  if (!any) return;
  const double reach = (std::sqrt(nearest) + 2 * r) * (1 + 1e-9);
  std::vector<std::uint32_t>& kept = near_[depth];
  kept.clear();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (square_[i] <= reach * reach) kept.push_back(candidates[i]);
  }
  if (c.cells > 2 && kept.size() > 3) {
    for (int k = 0; k < 8; ++k) refine(part(c, k), kept, depth + 1);
    return;
  }

  const double h = grid_->voxel_m;
  x_.clear();
  y_.clear();
  z_.clear();
  for_each_corner(c, [&](int x, int y, int z) {
    x_.push_back(origin_.x() + h * x);
    y_.push_back(origin_.y() + h * y);
    z_.push_back(origin_.z() + h * z);
  });
  best_.assign(x_.size(), limit_m_ * limit_m_);
  for (const std::uint32_t t : kept) {
    lower_square_distances(surface_->triangle(t), x_.data(), y_.data(), z_.data(), x_.size(), best_.data());
  }
  std::size_t i = 0;
  for_each_corner(c, [&](int x, int y, int z) {
    out_[static_cast<std::size_t>(FieldBlock::index(x, y, z))] = static_cast<float>(std::sqrt(best_[i++]));
  });
}

void BlockDistances::each_corner(const Cube& c) {
  const double h = grid_->voxel_m;
  double last = limit_m_;
  for_each_corner(c, [&](int x, int y, int z) {
    // Corners of a cube lie within its diagonal of each other: the last distance bounds this one.
    const double limit = std::min(limit_m_, last + 2.001 * half_diagonal(c.cells, h));
    last = surface_->distance(origin_ + surface_->middle() + h * Vec3(x, y, z), limit);
    out_[static_cast<std::size_t>(FieldBlock::index(x, y, z))] = static_cast<float>(last);
  });
}

}  // namespace tact::contact
