#pragma once
#include <functional>
#include <string>

#include "contact/server/loaded_scene.hpp"

namespace tact::contact {

/// "baking block.stl: distances" and how far that stage is, 0..1; < 0: not known. Return false to give up.
using LoadProgress = std::function<bool(const std::string& what, double fraction)>;

/// Bakes what the cache lacks (in a child process) and maps the field, locked into memory, and the pointshell: these
/// two and nothing else. Throws SetupError naming the file and what to do; also when `progress` gives up.
LoadedScene load_bodies(const Session& session, const LoadProgress& progress);

}  // namespace tact::contact
