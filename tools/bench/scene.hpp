#pragma once
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "contact/pipeline/contact_pipeline.hpp"
#include "lockstep/bodies.hpp"
#include "mesh/mesh.hpp"
#include "session/session.hpp"

namespace tact::bench {

/// A scene as the contact server holds it, and its cleaned meshes for those who work on triangles.
struct LoadedScene : lockstep::Bodies {
  SceneSpec spec;
  contact::BakedScene baked;
  Mesh obstacle_O, tool_M;

  std::unique_ptr<contact::ContactPipeline> pipeline(const std::string& law = {}) const;
  contact::ToolQuery query(const Pose& X_WM) const;  ///< at rest
  Pose X_OM(const Pose& X_WM) const;
};

/// Loads a scene of the product, changed by `change`; what is not in the cache is baked.
LoadedScene load_scene_by_name(const std::string& name, const std::function<void(SceneSpec&)>& change = {});

/// Poses near the motion of a script, moved at random by up to `shift_m` and `turn_rad`; seeded.
std::vector<Pose> poses_along(const LoadedScene& scene, const std::string& script, std::size_t count, double shift_m,
                              double turn_rad, unsigned seed);

/// The motion of a script, a pose for every tick of a millisecond.
std::vector<Pose> poses_tick_by_tick(const LoadedScene& scene, const std::string& script);

/// The first `count` of `poses` at which the pipeline finds from `fewest` to `most` contacts, none deeper than
/// `deepest_m`. Throws SetupError when there is none.
std::vector<Pose> with_contacts(const LoadedScene& scene, const std::vector<Pose>& poses, std::size_t fewest,
                                std::size_t most, std::size_t count, double deepest_m = 1);

}  // namespace tact::bench
