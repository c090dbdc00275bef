#pragma once
#include <cstdint>

#include "coupling/link/first_scene.hpp"
#include "coupling/loop/session_config.hpp"
#include "link/wire.hpp"

namespace tact::coupling {

/// The wire's SceneInfo in our own types.
struct SceneModel : BodyModel {
  std::uint64_t server_epoch = 0;
  SceneIdentity identity;  ///< every reply must name the same
};

/// Throws SetupError naming the first field without physical sense: a pose that is not finite and a rotation, a length,
/// stiffness or inertia that is not positive, an inertia no body can have. Quaternions come out normalised.
SceneModel scene_model(const wire::SceneInfo& info);

}  // namespace tact::coupling
