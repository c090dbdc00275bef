#pragma once
#include <cstddef>

#include "math/pose.hpp"

namespace tact::contact {

/// A point and the radius of its sphere, as a traversal reads them: a quarter of a cache line. Also a normal.
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

/// Points taken at once by place_in_cells().
inline constexpr std::size_t kPlacedAtOnce = 16;

/// From T to cells of a field, for culling: a place is A p + b, its sphere needs factor * radius + slack to be clear.
struct ToCells {
  Eigen::Matrix3f A;
  Eigen::Vector3f b;
  float factor, slack;
};

/// Arrays, in cells.
struct PlacedInCells {
  float *x, *y, *z, *needed;
};

/// In single precision, good to 4.2e-7 (|A p| + |b|), |b| the largest component. Real-time.
/// @pre `count` is a multiple of kPlacedAtOnce
void place_in_cells(const ToCells& to, const Node* nodes, std::size_t count, const PlacedInCells& out) noexcept;

}  // namespace tact::contact
