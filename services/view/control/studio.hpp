#pragma once
#include <memory>
#include <optional>

#include "field/distance_field.hpp"
#include "mesh/mesh.hpp"
#include "view/model/slice_plane.hpp"
#include "view/model/view_scene.hpp"
#include "view/render/ray_tracer.hpp"

namespace tact::view {

/// The bodies of one scene, loaded and ready to be drawn from. Made when somebody looks for the first time, not before.
class Studio {
 public:
  /// Reads the cached meshes, builds the trees, maps the field (read-only; without it there is no slice). Throws
  /// SetupError.
  Studio(const SceneInfo& info, int threads);

  /// A camera that shows the scene well as it now stands; the radius is of the ball about both bodies.
  Camera home(const ViewScene& scene, double& radius_m) const;

  Image picture(const ViewScene& scene, const Camera& camera, int width, int height);
  Image slice(const ViewScene& scene, const Camera& camera, int size);
  /// Everything on one page, for a file.
  Image sheet(const ViewScene& scene, const Camera& camera);

  /// Of which scene: these change when it has to be made anew.
  bool shows(const SceneInfo& info) const;
  double seconds() const { return seconds_; }  ///< the making took

 private:
  SceneInfo info_;
  Mesh tool_M_;  // kept for the cross-section
  std::unique_ptr<RayTracer> tracer_;
  std::optional<DistanceField> field_;
  SlicePlaneChooser chooser_;
  double scene_radius_m_ = 0;
  double seconds_ = 0;
};

}  // namespace tact::view
