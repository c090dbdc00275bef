#pragma once
#include "session/key.hpp"
#include "session/session.hpp"

namespace tact::session {

/// Makes room for the names a file or a command line brings along: "scripts.NAME.*" and "obstacle.params.NAME", so
/// that scene_keys binds them.
void make_room(SceneSpec& scene, const std::string& key);

/// Every key of the object; relative paths are taken from `base`.
Keys scene_keys(SceneSpec& scene, const std::filesystem::path& base);
Keys machine_keys(MachineSpec& machine, const std::filesystem::path& base);
Keys run_keys(RunSpec& run, const std::filesystem::path& base);
Keys session_keys(Session& session, const std::filesystem::path& base);

}  // namespace tact::session
