#pragma once
#include <memory>
#include <span>

#include "mesh/mesh.hpp"
#include "view/model/camera.hpp"
#include "view/render/arrows.hpp"
#include "view/render/image.hpp"

namespace tact::view {

/// What moves between two pictures.
struct Placement {
  Pose X_WO, X_WM;  ///< obstacle; mesh frame of the tool
  std::span<const Arrow> arrows;
};

/// Draws both bodies by ray tracing on the processor: no display, no GPU. The trees over the triangles are built once,
/// in the constructor; a picture only places them anew. Arrows shine through what hides them, so that a contact deep
/// inside is seen. One key light from the viewer's upper left with shadows, smoothed silhouettes, darkened creases.
class RayTracer {
 public:
  /// `threads`: at most so many at work at once.
  RayTracer(const Mesh& obstacle_O, const Mesh& tool_M, int threads);
  ~RayTracer();

  void trace(const Camera& camera, const Placement& placement, Image& out);

  /// Ball about everything, for the first camera: both bodies at the given poses.
  void bounds(const Placement& placement, Vec3& centre_W, double& radius_m) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

}  // namespace tact::view
