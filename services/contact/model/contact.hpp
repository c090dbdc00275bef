#pragma once
#include <cstdint>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// The points in contact at one pose, in O (the field body's frame), structure of arrays with fixed capacity.
/// Filled by the traversal, weighed by a law, summed by assemble. r is the lever p - To expressed in O.
struct ContactBuffer {
  explicit ContactBuffer(std::size_t capacity);

  std::size_t size = 0;          ///< contacts in use
  std::size_t dropped = 0;       ///< found beyond capacity: the shallowest, not kept
  std::vector<std::uint32_t> point_id;
  std::vector<Vec3> r;           ///< m
  std::vector<Vec3> N;           ///< unit inward normal of the tool
  std::vector<Vec3> g;           ///< gradient of the interpolated field
  std::vector<double> depth_m;   ///< > 0
  std::vector<double> weight;    ///< of the law
  std::vector<std::uint32_t> flags;

  std::size_t capacity() const { return point_id.size(); }
};

}  // namespace tact::contact
