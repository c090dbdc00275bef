#include "contact/stiffness/direction_density.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>
#include <utility>

#include "contact/stiffness/distinct_directions.hpp"

namespace tact::contact {
namespace {

/// Place of a unit vector on a Hilbert curve over the octahedron, unfolded to a square. What is near on the curve is
/// near on the sphere, more often than on a curve through space.
std::uint64_t along_sphere(const Vec3& v) {
  const double sum = v.cwiseAbs().sum();
  double s = v.x() / sum, t = v.y() / sum;
  if (v.z() < 0) {
    std::tie(s, t) = std::pair(std::copysign(1 - std::fabs(t), s), std::copysign(1 - std::fabs(s), t));
  }
  constexpr std::uint32_t kSide = 1u << 24;
  auto x = static_cast<std::uint32_t>((0.5 + 0.5 * s) * (kSide - 1)),
       y = static_cast<std::uint32_t>((0.5 + 0.5 * t) * (kSide - 1));
  std::uint64_t place = 0;
  for (std::uint32_t half = kSide / 2; half > 0; half /= 2) {
    const bool right = x & half, up = y & half;
    place = 4 * place + ((right ? 3u : 0u) ^ (up ? 1u : 0u));
    if (!up) {
      if (right) x = kSide - 1 - x, y = kSide - 1 - y;
      std::swap(x, y);
    }
  }
  return place;
}

/// Place of any other on a Z-order curve through the cube [-reach, reach]^3: bits of the coordinates in turn.
std::uint64_t through_space(const Vec3& v, double reach) {
  constexpr int kBits = 20;
  std::uint64_t place = 0;
  for (int k = 0; k < 3; ++k) {
    const auto cell = static_cast<std::uint64_t>((0.5 + 0.5 * v[k] / reach) * ((1 << kBits) - 1));
    for (int bit = 0; bit < kBits; ++bit) place |= (cell >> bit & 1) << (3 * bit + k);
  }
  return place;
}

/// The order of classes: near ones near each other.
std::vector<std::uint32_t> ordered(std::span<const Vec3> directions) {
  double reach = 1;
  for (const Vec3& v : directions) reach = std::max(reach, v.cwiseAbs().maxCoeff());
  std::vector<std::tuple<bool, std::uint64_t, std::uint32_t>> places;
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    const bool is_unit = std::fabs(directions[i].norm() - 1) < 1e-5;
    places.emplace_back(is_unit, is_unit ? along_sphere(directions[i]) : through_space(directions[i], reach), i);
  }
  std::sort(places.begin(), places.end());
  std::vector<std::uint32_t> order;
  for (const auto& place : places) order.push_back(std::get<2>(place));
  return order;
}

}  // namespace

DirectionDensity::DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon) : work_(0) {
  const DistinctDirections distinct = distinct_directions(direction_per_point);
  const std::size_t count = distinct.direction.size();
  std::vector<std::uint32_t> number(count);
  for (const std::uint32_t i : ordered(distinct.direction)) {
    number[i] = static_cast<std::uint32_t>(direction_.size());
    direction_.push_back(distinct.direction[i] / epsilon);
  }
  for (const std::uint32_t i : distinct.class_of) class_of_.push_back(number[i]);
  is_used_.resize((count + 63) / 64);
  is_word_used_.resize((is_used_.size() + 63) / 64);
  place_.resize(count);
  work_ = DensityWork(count);
}

void DirectionDensity::add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept {
  list_used(ids);
  for (const std::uint32_t id : ids) ++work_.count[place_[class_of_[id]]];
  sum_density(work_);
  for (std::size_t i = 0; i < ids.size(); ++i) phi[i] += work_.phi[place_[class_of_[ids[i]]]];
}

/// Lists the classes of the points, in order, counted 0 times.
void DirectionDensity::list_used(std::span<const std::uint32_t> ids) noexcept {
  for (const std::uint32_t id : ids) {
    const std::uint32_t c = class_of_[id], word = c / 64;
    __builtin_prefetch(&direction_[c]);
    __builtin_prefetch(&place_[c], 1);
    is_used_[word] |= std::uint64_t{1} << (c % 64);
    is_word_used_[word / 64] |= std::uint64_t{1} << (word % 64);
  }
  std::size_t n = 0;
  for (std::size_t g = 0; g < is_word_used_.size(); ++g) {
    for (std::uint64_t words = std::exchange(is_word_used_[g], 0); words != 0; words &= words - 1) {
      const std::size_t w = 64 * g + static_cast<std::size_t>(std::countr_zero(words));
      for (std::uint64_t bits = std::exchange(is_used_[w], 0); bits != 0; bits &= bits - 1) {
        const std::size_t c = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
        const Vec3& v = direction_[c];
        place_[c] = static_cast<std::uint32_t>(n);
        work_.x[n] = v.x();
        work_.y[n] = v.y();
        work_.z[n] = v.z();
        work_.count[n] = work_.phi[n] = 0;
        ++n;
      }
    }
  }
  work_.size = n;
}

}  // namespace tact::contact
