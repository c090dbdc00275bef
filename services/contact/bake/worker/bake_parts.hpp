#pragma once
#include <cstdint>

#include "contact/bake/content_key.hpp"
#include "contact/bake/worker/progress.hpp"
#include "session/session.hpp"

namespace tact::contact {

/// Bake one body of a scene and write its files, the report last. Throw SetupError naming the mesh file, Cancelled.
/// `spacing_m` is tool_spacing_m.
void bake_obstacle(const SceneSpec& scene, const BakedFiles& files, std::uint64_t key, const StageProgress& progress);
void bake_tool(const SceneSpec& scene, double spacing_m, const BakedFiles& files, std::uint64_t key,
               const StageProgress& progress);

}  // namespace tact::contact
