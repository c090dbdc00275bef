#include "coupling/link/first_scene.hpp"

#include <fstream>

#include "fault/fault.hpp"
#include "file/sealed_file.hpp"
#include "file/whole_file.hpp"
#include "log/log.hpp"

namespace tact::coupling {

SceneIdentity first_scene(const std::filesystem::path& run_dir, const SceneIdentity& now) {
  const auto path = run_dir / "first_scene";
  if (std::filesystem::exists(path)) {
    SceneIdentity first;
    std::ifstream in(path);
    if (in >> std::hex >> first.field_hash >> first.shell_hash) return first;
    throw SetupError(path.string() +
                     ": found no two hashes, expected the scene this session began with; restart the session");
  }
  write_whole(path, hex(now.field_hash) + ' ' + hex(now.shell_hash) + '\n');
  return now;
}

void refuse_scene(HealthReporter& health, const SceneIdentity& found, const SceneIdentity& first) {
  const std::string text = "the contact server serves another scene: found field " + hex(found.field_hash) +
                           " and pointshell " + hex(found.shell_hash) + ", this session began with " +
                           hex(first.field_hash) + " and " + hex(first.shell_hash) +
                           ". Has a mesh file changed? The arm stays calm: restart the session";
  health.set_faults(bit(Fault::scene_changed), bit(Fault::scene_changed));
  health.phase(wire::kDegraded, text);
  log_error(text);
}

}  // namespace tact::coupling
