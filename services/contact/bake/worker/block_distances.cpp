#include "contact/bake/worker/block_distances.hpp"

#include <algorithm>
#include <cmath>

namespace tact::contact {
namespace {
constexpr std::size_t kFewTriangles = 1024;  ///< above, halving a cube is cheaper than looking at all of them
constexpr float kLargeVoxels = 600;          ///< up to here single precision errs by less than half a step of the field
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
  if (surface_->near(p, d + 2 * r, kFewTriangles, near_)) {
    candidates_[0].resize(near_.size());
    for (std::size_t i = 0; i < near_.size(); ++i) candidates_[0].set(i, surface_->ball(near_[i]), near_[i]);
    refine(c, 0);
  } else if (c.cells > 2) {
    for (int k = 0; k < 8; ++k) search(part(c, k));
  } else {
    each_corner(c);
  }
}

void BlockDistances::Candidates::resize(std::size_t n) {
  for (std::vector<float>* v : {&x, &y, &z, &radius}) v->resize(n);
  triangle.resize(n);
}

void BlockDistances::Candidates::set(std::size_t i, const Surface::Ball& ball, std::uint32_t id) {
  x[i] = ball.x;
  y[i] = ball.y;
  z[i] = ball.z;
  radius[i] = ball.radius;
  triangle[i] = id;
}

/// Lengths are in units of the surface's size.
void BlockDistances::refine(const Cube& c, int depth) {
  Candidates& from = candidates_[depth];
  const double scale = 1 / surface_->size();
  const Vec3 p = centre(c);
  const auto r = static_cast<float>(scale * half_diagonal(c.cells, grid_->voxel_m));
  const auto limit = static_cast<float>(scale * limit_m_) + r;
  const float at[3] = {static_cast<float>(scale * p.x()), static_cast<float>(scale * p.y()),
                       static_cast<float>(scale * p.z())};
  constexpr float kHair = 1e-6f;  // rounding of coordinates up to 1
  const std::size_t n = from.triangle.size();
  from.low.resize(n);
  float nearest = std::min(
      limit,
      bound_distances(from.x.data(), from.y.data(), from.z.data(), from.radius.data(), n, at, from.low.data()) + kHair);
  for (std::size_t i = 0; i < n; ++i) {
    if (from.radius[i] < 0.5f * r || from.low[i] > nearest + 2 * r) continue;  // its ball is sharp enough
    from.low[i] = static_cast<float>(scale * std::sqrt(surface_->triangle(from.triangle[i]).square_distance(p)));
    nearest = std::min(nearest, from.low[i] + kHair);
  }
  const float reach = nearest + 2 * r + 4 * kHair;
  Candidates& kept = candidates_[depth + 1];
  kept.resize(n);
  std::size_t count = 0;
  float least = reach;
  for (std::size_t i = 0; i < n; ++i) {  // without branches: which stay is hard to foretell
    kept.set(count, {from.x[i], from.y[i], from.z[i], from.radius[i]}, from.triangle[i]);
    count += from.low[i] <= reach ? 1 : 0;
    least = std::min(least, from.low[i]);
  }
  kept.resize(count);
  if (least > limit + kHair) return;  // all corners are beyond the limit
  if (c.cells > 2 && kept.triangle.size() > 3) {
    for (int k = 0; k < 8; ++k) refine(part(c, k), depth + 1);
  } else {
    all_against_all(c, kept.triangle);
  }
}

void BlockDistances::all_against_all(const Cube& c, const std::vector<std::uint32_t>& triangles) {
  const double scale = 1 / surface_->size(), h = grid_->voxel_m;
  const auto step = static_cast<float>(scale * h);
  x_.clear();
  y_.clear();
  z_.clear();
  for_each_corner(c, [&](int x, int y, int z) {
    x_.push_back(step * static_cast<float>(x - c.x));
    y_.push_back(step * static_cast<float>(y - c.y));
    z_.push_back(step * static_cast<float>(z - c.z));
  });
  const std::size_t whole = (x_.size() + 7) / 8 * 8;  // whole vectors
  for (std::vector<float>* v : {&x_, &y_, &z_}) v->resize(whole, 0);
  const auto limit = static_cast<float>(scale * limit_m_);
  best_.assign(whole, limit * limit);
  const Vec3 base = scale * (origin_ + h * Vec3(c.x, c.y, c.z));
  for (const std::uint32_t t : triangles) {
    if (surface_->ball(t).radius > kLargeVoxels * step) {  // single precision would show
      for (std::size_t k = 0; k < whole; ++k) {
        const Vec3 p = surface_->size() * (base + Eigen::Vector3f(x_[k], y_[k], z_[k]).cast<double>());
        const double square = scale * scale * surface_->triangle(t).square_distance(p);
        best_[k] = std::min(best_[k], static_cast<float>(square));
      }
      continue;
    }
    lower_square_distances(surface_->small(t), base, x_.data(), y_.data(), z_.data(), whole, best_.data());
  }
  const auto size = static_cast<float>(surface_->size());
  std::size_t i = 0;
  for_each_corner(c, [&](int x, int y, int z) {
    const float d = size * std::sqrt(best_[i++]);
    out_[static_cast<std::size_t>(FieldBlock::index(x, y, z))] = std::min(d, static_cast<float>(limit_m_));
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
