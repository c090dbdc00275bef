#pragma once
#include <cstdint>

#include "coupling/link/first_scene.hpp"
#include "link/wire.hpp"
#include "math/pose.hpp"

namespace tact::coupling {

/// What coupling needs to know of the bodies, as the contact server baked them: the wire's SceneInfo in our own types.
struct SceneModel {
  std::uint64_t server_epoch = 0;
  SceneIdentity identity;  ///< every reply must name the same
  Pose X_TM;               ///< mesh frame of the tool in T
  Pose X_WO;
  Mat3 inertia_shape_m2 = Mat3::Zero();  ///< inertia of unit mass about To in T
  double gyration_radius_m = 0;
  double tool_radius_m = 0;  ///< farthest shell point from To
  double voxel_m = 0;
  double stiffness_n_per_m = 0, x_max_m = 0;
};

/// Throws SetupError naming the first field without physical sense: a pose that is not finite and a rotation, a length,
/// stiffness or inertia that is not positive, an inertia no body can have. Quaternions come out normalised.
SceneModel scene_model(const wire::SceneInfo& info);

}  // namespace tact::coupling
