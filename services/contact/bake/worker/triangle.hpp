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

/// The same in single precision, about its first corner, for millions of questions: good to 1e-7 of the triangle's size
/// and of the distance. Points are given relative to `base`, which is in double.
struct SmallTriangle {
  SmallTriangle() = default;
  explicit SmallTriangle(const Triangle& t);

  double first[3];
  float edge[3][3], inverse_square[3], side[3][3], normal[3];
  float inverse_normal = 0;
};

/// best[i] = min(best[i], square distance of base + (x[i], y[i], z[i]) to t). Vectorised over the points.
void lower_square_distances(const SmallTriangle& t, const Vec3& base, const float* x, const float* y, const float* z,
                            std::size_t count, float* best);

/// Balls about a point of each triangle (its middle) that hold all of it: low[i] = |p - centre[i]| - radius[i], a lower
/// bound of the distance. Returns the least |p - centre[i]|, an upper bound of the least distance. Vectorised.
float bound_distances(const float* x, const float* y, const float* z, const float* radius, std::size_t count,
                      const float* p, float* low);

}  // namespace tact::contact
