#pragma once
#include <cstddef>

#include "math/pose.hpp"

namespace tact::contact {

/// Points in single precision to R p + t in double, with the bits of Eigen's R * p.cast<double>() + t (tested), on
/// every instruction set (chosen at run time). Real-time. @pre `count` is a multiple of 8
void place(const Mat3& R, const Vec3& t, const float* x, const float* y, const float* z, std::size_t count,
           double* out_x, double* out_y, double* out_z) noexcept;

}  // namespace tact::contact
