#pragma once
#include <cstddef>

#include "math/pose.hpp"

namespace tact::contact {

/// A triangle prepared for exact distances. Inside the prism over the triangle the nearest point is on the plane, else
/// on an edge; a triangle without area has edges only.
struct Triangle {
  Triangle() = default;
  Triangle(const Vec3& a, const Vec3& b, const Vec3& c);

  double square_distance(const Vec3& p) const;

  double corner[3][3];        ///< a, b, c
  double edge[3][3];          ///< ab, bc, ca
  double inverse_square[3];   ///< of each edge's length; 0 for an edge without length
  double side[3][3];          ///< edge x normal: points out of the triangle, in its plane
  double normal[3];           ///< not unit
  double inverse_normal = 0;  ///< 1 / normal^2; 0 without area
};

/// best[i] = min(best[i], square distance of (x[i], y[i], z[i]) to t). Vectorised over the points.
void lower_square_distances(const Triangle& t, const double* x, const double* y, const double* z, std::size_t count,
                            double* best);

}  // namespace tact::contact
