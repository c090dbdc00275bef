#pragma once
#include <cstddef>

#include "math/pose.hpp"

namespace tact::contact {

/// A point and a number that goes with it, as a traversal reads it: a quarter of a cache line.
struct alignas(16) Node {
  float x, y, z;  ///< T, m
  float radius;   ///< m
};

/// Points as three arrays in double, and their radii.
struct Placed {
  double *x, *y, *z, *radius;
};

/// R p + t for many points, each coordinate summed from left to right:
///   out_i = ((R_i0 x + R_i1 y) + R_i2 z) + t_i
/// in double, without fused multiply-add: the same bits on every instruction set (chosen at run time). Whoever wants to
/// know exactly where a point of the shell is asks here. Real-time. @pre `count` is a multiple of 8
void place(const Mat3& R, const Vec3& t, const Node* nodes, std::size_t count, const Placed& out) noexcept;

}  // namespace tact::contact
