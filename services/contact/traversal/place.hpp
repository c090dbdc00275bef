#pragma once
#include <cstddef>

#include "math/pose.hpp"

namespace tact::contact {

/// A point and the radius of its sphere, as a traversal reads them: a quarter of a cache line.
struct alignas(16) Node {
  float x, y, z, radius;  ///< T, m
};

/// Points as three arrays.
struct Placed {
  double *x, *y, *z;
};

/// R p + t for many points, each coordinate summed from left to right:
///   out_i = ((R_i0 x + R_i1 y) + R_i2 z) + t_i
/// in double, without fused multiply-add: the same bits on every instruction set (chosen at run time). This alone
/// decides where a point of the shell is. Real-time. @pre `count` is a multiple of 8
void place(const Mat3& R, const Vec3& t, const Node* nodes, std::size_t count, const Placed& out) noexcept;

/// Points and radii as arrays, in cells of a field.
struct PlacedInCells {
  float *x, *y, *z, *radius;
};

/// The same in single precision, good to 4.2e-7 (|A p| + |b|), |b| the largest component: to cull by. A takes metres of
/// T to cells; radii are multiplied by `cells_per_m`. Real-time. @pre `count` is a multiple of 8
void place_in_cells(const Mat3& A, const Vec3& b, double cells_per_m, const Node* nodes, std::size_t count,
                    const PlacedInCells& out) noexcept;

}  // namespace tact::contact
