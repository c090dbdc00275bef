#include "contact/stiffness/distinct_directions.hpp"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace tact::contact {

DistinctDirections distinct_directions(std::span<const Vec3> directions) {
  const auto key = [&](std::uint32_t i) {
    const Vec3& v = directions[i];
    return std::make_tuple(v.x(), v.y(), v.z());
  };
  std::vector<std::uint32_t> order(directions.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });

  // The first of each run of equals stands for the run; classes are then numbered in order of first appearance.
  std::vector<std::uint32_t> first(directions.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && key(order[k]) == key(order[k - 1]);
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  DistinctDirections out;
  out.class_of.resize(directions.size());
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    if (first[i] == i) {
      out.class_of[i] = static_cast<std::uint32_t>(out.direction.size());
      out.direction.push_back(directions[i]);
    } else {
      out.class_of[i] = out.class_of[first[i]];
    }
  }
  return out;
}

}  // namespace tact::contact
