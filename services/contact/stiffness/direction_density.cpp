#include "contact/stiffness/direction_density.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "contact/stiffness/distinct_directions.hpp"

namespace tact::contact {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr int kReach = 2;  // a cell has side eps / sqrt 3: eps reaches into the second neighbour

}  // namespace

DirectionDensity::DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon)
    : inverse_eps2_(1.0 / (epsilon * epsilon)), eps2_(epsilon * epsilon) {
  DistinctDirections distinct = distinct_directions(direction_per_point);
  class_of_ = std::move(distinct.class_of);

  const double side = epsilon / std::sqrt(3.0);
  using Key = std::array<int, 3>;
  std::map<Key, std::uint32_t> cell_at;
  classes_.reserve(distinct.direction.size());
  for (const Vec3& v : distinct.direction) {
    const Eigen::Vector3d f = (v / side).array().floor();
    const Key key = {static_cast<int>(f.x()), static_cast<int>(f.y()), static_cast<int>(f.z())};
    const auto [it, is_new] = cell_at.try_emplace(key, static_cast<std::uint32_t>(cells_.size()));
    if (is_new) cells_.emplace_back().centre = (f.array() + 0.5) * side;
    classes_.push_back({v, it->second});
  }
  for (const auto& [key, index] : cell_at) {
    Cell& cell = cells_[index];
    cell.neighbour_begin = static_cast<std::uint32_t>(neighbours_.size());
    for (int dx = -kReach; dx <= kReach; ++dx)
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dz = -kReach; dz <= kReach; ++dz) {
          const auto other = cell_at.find({key[0] + dx, key[1] + dy, key[2] + dz});
          if (other != cell_at.end() && other->second > index) neighbours_.push_back(other->second);
        }
    cell.neighbour_end = static_cast<std::uint32_t>(neighbours_.size());
  }
  used_.resize(cells_.size());
}

void DirectionDensity::add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept {
  collect(ids);
  for (std::size_t u = 0; u < used_count_; ++u) {
    Cell& a = cells_[used_[u]];
    add_moments(a, a);
    for (std::uint32_t n = a.neighbour_begin; n < a.neighbour_end; ++n) {
      Cell& b = cells_[neighbours_[n]];
      if (b.tick != tick_) continue;
      const Vec3 gap = (a.lo - b.hi).cwiseMax(b.lo - a.hi).cwiseMax(0.0);
      if (gap.squaredNorm() >= eps2_) continue;
      const Vec3 span = (a.hi - b.lo).cwiseMax(b.hi - a.lo);
      if (span.squaredNorm() <= eps2_) {
        add_moments(a, b);
        add_moments(b, a);
      } else {
        add_pairs(a, b);
      }
    }
  }
  for (std::size_t i = 0; i < ids.size(); ++i) phi[i] += classes_[class_of_[ids[i]]].phi;
}

/// Lists the classes and cells that the ids touch, with their counts, boxes and moments.
void DirectionDensity::collect(std::span<const std::uint32_t> ids) noexcept {
  ++tick_;
  used_count_ = 0;
  for (const std::uint32_t id : ids) {
    const std::uint32_t class_index = class_of_[id];
    Class& c = classes_[class_index];
    Cell& cell = cells_[c.cell];
    if (c.tick != tick_) {
      if (cell.tick != tick_) {
        cell.tick = tick_;
        cell.lo = cell.hi = c.v;
        cell.sum_b.setZero();
        cell.count = cell.sum_b2 = 0;
        cell.first = kNone;
        used_[used_count_++] = c.cell;
      }
      c.tick = tick_;
      c.count = c.phi = 0;
      c.next = cell.first;
      cell.first = class_index;
      cell.lo = cell.lo.cwiseMin(c.v);
      cell.hi = cell.hi.cwiseMax(c.v);
    }
    const Vec3 b = c.v - cell.centre;
    c.count += 1;
    cell.count += 1;
    cell.sum_b += b;
    cell.sum_b2 += b.squaredNorm();
  }
}

/// sum_j (1 - |a - b_j|^2 / eps^2) for every class a of `to`, over all b_j of `from`.
void DirectionDensity::add_moments(Cell& from, Cell& to) noexcept {
  for (std::uint32_t i = to.first; i != kNone; i = classes_[i].next) {
    const Vec3 a = classes_[i].v - from.centre;
    const double sum_d2 = from.count * a.squaredNorm() - 2 * a.dot(from.sum_b) + from.sum_b2;
    classes_[i].phi += from.count - sum_d2 * inverse_eps2_;
  }
}

void DirectionDensity::add_pairs(Cell& a, Cell& b) noexcept {
  for (std::uint32_t i = a.first; i != kNone; i = classes_[i].next) {
    Class& ci = classes_[i];
    double phi = 0;
    for (std::uint32_t j = b.first; j != kNone; j = classes_[j].next) {
      Class& cj = classes_[j];
      const double hat = std::max(1.0 - (ci.v - cj.v).squaredNorm() * inverse_eps2_, 0.0);
      phi += hat * cj.count;
      cj.phi += hat * ci.count;
    }
    ci.phi += phi;
  }
}

}  // namespace tact::contact
