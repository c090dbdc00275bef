#pragma once
#include <cstdint>
#include <filesystem>

#include "link/health.hpp"

namespace tact::coupling {

/// The baked bodies, by their hashes.
struct SceneIdentity {
  std::uint64_t field_hash = 0, shell_hash = 0;
  bool operator==(const SceneIdentity&) const = default;
};

/// The scene this session's first coupling began with. It is kept as a file in the session's directory, which is empty
/// when the session begins, so that it outlives the process: a coupling that was started again, alone or with RouDi and
/// the server, must not take over bodies its predecessor would have refused. The first call keeps `now`.
/// Throws SetupError when the file cannot be written or read.
SceneIdentity first_scene(const std::filesystem::path& run_dir, const SceneIdentity& now);

/// Health says Fault::scene_changed, kDegraded and what a person is to do.
void refuse_scene(HealthReporter& health, const SceneIdentity& found, const SceneIdentity& first);

}  // namespace tact::coupling
