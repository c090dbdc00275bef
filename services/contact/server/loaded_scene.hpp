#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "contact/model/pointshell.hpp"
#include "field/distance_field.hpp"
#include "session/session.hpp"

namespace tact::contact {

/// What was loaded, how long it took and what it holds in memory: the user sees this list.
struct LoadedPart {
  std::string what;
  double seconds = 0;
  std::uint64_t bytes = 0;
};

/// The bodies of a scene, ready to be served, and the cache files other processes may map.
struct LoadedScene {
  DistanceField field;
  std::shared_ptr<const Pointshell> shell;
  std::filesystem::path field_path, obstacle_mesh_path, tool_mesh_path;
  std::vector<LoadedPart> parts;
  std::string notes;  ///< what the bake refused, repaired or doubts: a sentence a line
};

}  // namespace tact::contact
