#include "contact/stiffness/direction_density.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <utility>

#include "contact/stiffness/distinct_directions.hpp"

namespace tact::contact {
namespace {

constexpr int kReach = 2;  // a cell has side eps / sqrt 3: eps reaches into the second neighbour

}  // namespace

DirectionDensity::DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon)
    : eps2_(epsilon * epsilon) {
  const DistinctDirections distinct = distinct_directions(direction_per_point);
  const double side = epsilon / std::sqrt(3.0);
  using Key = std::array<int, 3>;
  std::map<Key, std::vector<std::uint32_t>> classes_at;
  for (std::uint32_t i = 0; i < distinct.direction.size(); ++i) {
    const Eigen::Vector3d f = (distinct.direction[i] / side).array().floor();
    classes_at[{static_cast<int>(f.x()), static_cast<int>(f.y()), static_cast<int>(f.z())}].push_back(i);
  }
  std::map<Key, std::uint32_t> cell_at;
  std::vector<std::uint32_t> number(distinct.direction.size());
  for (const auto& [key, members] : classes_at) {
    const auto cell = static_cast<std::uint32_t>(centre_.size());
    cell_at[key] = cell;
    centre_.push_back((Vec3(key[0], key[1], key[2]).array() + 0.5) * side);
    for (const std::uint32_t i : members) {
      number[i] = static_cast<std::uint32_t>(direction_.size());
      direction_.push_back(distinct.direction[i]);
      cell_of_.push_back(cell);
    }
  }
  for (const std::uint32_t i : distinct.class_of) class_of_.push_back(number[i]);
  for (const auto& [key, index] : cell_at) {
    neighbours_.begin.push_back(static_cast<std::uint32_t>(neighbours_.cell.size()));
    for (int dx = -kReach; dx <= kReach; ++dx)
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dz = -kReach; dz <= kReach; ++dz) {
          const auto other = cell_at.find({key[0] + dx, key[1] + dy, key[2] + dz});
          if (other != cell_at.end() && other->second > index) neighbours_.cell.push_back(other->second);
        }
  }
  neighbours_.begin.push_back(static_cast<std::uint32_t>(neighbours_.cell.size()));
  is_used_.resize((direction_.size() + 63) / 64);
  count_.resize(direction_.size());
  phi_.resize(direction_.size());
  used_cell_.resize(centre_.size());
  used_class_.resize(direction_.size());
  for (auto* array : {&used_.x, &used_.y, &used_.z, &used_.count, &used_.phi}) {
    array->resize(direction_.size() + kDensityPad);
  }
  cells_.resize(centre_.size());
}

void DirectionDensity::add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept {
  collect(ids);
  list_used();
  sum_density(cells_.data(), cell_count_, neighbours_, used_cell_.data(), eps2_, used_);
  for (std::size_t k = 0; k < class_count_; ++k) phi_[used_class_[k]] = used_.phi[k];
  for (std::size_t i = 0; i < ids.size(); ++i) phi[i] += phi_[class_of_[ids[i]]];
}

/// Counts the points of each class.
void DirectionDensity::collect(std::span<const std::uint32_t> ids) noexcept {
  for (const std::uint32_t id : ids) {
    const std::uint32_t c = class_of_[id];
    ++count_[c];
    is_used_[c / 64] |= std::uint64_t{1} << (c % 64);
  }
}

/// Lists the counted classes and their cells, with boxes and moments; the counts are 0 again.
void DirectionDensity::list_used() noexcept {
  class_count_ = cell_count_ = 0;
  for (std::size_t w = 0; w < is_used_.size(); ++w) {
    for (std::uint64_t bits = std::exchange(is_used_[w], 0); bits != 0; bits &= bits - 1) {
      const auto c = static_cast<std::uint32_t>(64 * w) + static_cast<std::uint32_t>(std::countr_zero(bits));
      const Vec3& v = direction_[c];
      const std::uint32_t index = cell_of_[c];
      if (cell_count_ == 0 || cells_[cell_count_ - 1].index != index) {
        const auto begin = static_cast<std::uint32_t>(class_count_);
        used_cell_[index] = static_cast<std::uint32_t>(cell_count_);
        cells_[cell_count_++] = {centre_[index], v, v, Vec3::Zero(), 0, 0, index, begin, begin};
      }
      DensityCell& cell = cells_[cell_count_ - 1];
      const double count = std::exchange(count_[c], 0);
      const Vec3 b = v - cell.centre;
      cell.lo = cell.lo.cwiseMin(v);
      cell.hi = cell.hi.cwiseMax(v);
      cell.count += count;
      cell.sum_b += count * b;
      cell.sum_b2 += count * b.squaredNorm();
      ++cell.end;
      used_.x[class_count_] = v.x();
      used_.y[class_count_] = v.y();
      used_.z[class_count_] = v.z();
      used_.count[class_count_] = count;
      used_.phi[class_count_] = 0;
      used_class_[class_count_++] = c;
    }
  }
}

}  // namespace tact::contact
