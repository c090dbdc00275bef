#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Vectors that are equal bit by bit share a class: a flat face has one class, however many points sample it.
struct DistinctDirections {
  std::vector<std::uint32_t> class_of;  ///< per vector given
  std::vector<Vec3> direction;          ///< per class, in order of first appearance
};

/// O(n log n), allocates: for configuration.
DistinctDirections distinct_directions(std::span<const Vec3> directions);

}  // namespace tact::contact
