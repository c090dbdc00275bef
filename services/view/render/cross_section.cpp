#include "view/render/cross_section.hpp"

#include <cmath>

namespace tact::view {

std::vector<Segment> cut(const Mesh& mesh_M, const Pose& X_OM, const SlicePlane& plane) {
  // Plane and window in M, so that no vertex needs to be moved.
  const Pose X_MO = X_OM.inverse();
  const Eigen::Vector3f centre = (X_MO * plane.centre_O).cast<float>();
  const Eigen::Vector3f u = (X_MO.q * plane.u_O).cast<float>(), v = (X_MO.q * plane.v_O).cast<float>();
  const Eigen::Vector3f n = u.cross(v);
  const auto half = static_cast<float>(plane.half_side_m);

  std::vector<Segment> segments;
  for (const auto& triangle : mesh_M.triangles) {
    Eigen::Vector3f p[3];
    float height[3];
    for (int i = 0; i < 3; ++i) {
      p[i] = mesh_M.vertices[triangle[static_cast<std::size_t>(i)]] - centre;
      height[i] = n.dot(p[i]);
    }
    if ((height[0] < 0) == (height[1] < 0) && (height[1] < 0) == (height[2] < 0)) continue;
    Eigen::Vector2f ends[2];
    int count = 0;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if ((height[i] < 0) == (height[j] < 0)) continue;
      const float s = height[i] / (height[i] - height[j]);
      const Eigen::Vector3f x = p[i] + s * (p[j] - p[i]);
      ends[count++] = {u.dot(x), v.dot(x)};
    }
    const Eigen::Vector2f low = ends[0].cwiseMin(ends[1]), high = ends[0].cwiseMax(ends[1]);
    if (low.maxCoeff() > half || high.minCoeff() < -half) continue;
    segments.push_back({ends[0], ends[1]});
  }
  return segments;
}

}  // namespace tact::view
