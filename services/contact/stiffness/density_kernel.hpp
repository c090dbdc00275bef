#pragma once
#include <array>
#include <cstddef>
#include <vector>

namespace tact::contact {

/// Directions that are in use, near ones near each other: blocks of eight of them are the leaves of a tree of boxes,
/// eight to a node. Set size, x, y, z, count and phi; the last block is filled up here. Allocates when it is made.
struct DensityWork {
  static constexpr std::size_t kBlock = 8;

  explicit DensityWork(std::size_t capacity);

  std::size_t size = 0;
  std::vector<double> x, y, z, count, phi;
  std::array<std::vector<double>, 3> lo, hi;  ///< scratch: boxes, level by level
};

/// phi of each direction += sum_j count_j hat(v, v_j), hat(a, b) = max(1 - |a - b|^2, 0): [P] eq. 6-7 with directions
/// in units of eps. Nodes farther apart than 1 are passed over, nodes that lie within 1 of each other everywhere are
/// summed by moments; single pairs are visited where neither holds. Real-time: does not allocate, lock or throw.
void sum_density(DensityWork& work) noexcept;

}  // namespace tact::contact
