#include <pwd.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "fault/fault.hpp"
#include "fault/nearest.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

/// The nearest folder above the running program that holds share/tact: build tree and installed prefix are laid out
/// alike, so one rule serves both.
const std::filesystem::path& prefix() {
  static const std::filesystem::path found = [] {
    const auto program = std::filesystem::read_symlink("/proc/self/exe");
    for (auto folder = program.parent_path(); folder.has_relative_path(); folder = folder.parent_path()) {
      std::error_code ignored;
      if (std::filesystem::is_directory(folder / "share" / "tact", ignored)) return folder;
    }
    throw SetupError(program.string() +
                     ": found no folder share/tact above this program, expected an installed tree or a build tree");
  }();
  return found;
}

std::filesystem::path home() {
  if (const char* h = std::getenv("HOME"); h && *h == '/') return h;
  if (const passwd* user = ::getpwuid(::getuid()); user && user->pw_dir && *user->pw_dir == '/') return user->pw_dir;
  throw SetupError("cache.dir: found no home folder, expected the key cache.dir or the variable TACT_CACHE to be set");
}

}  // namespace

std::filesystem::path share_dir() { return prefix() / "share" / "tact"; }
std::filesystem::path libexec_dir() { return prefix() / "libexec" / "tact"; }

std::filesystem::path cache_dir(const MachineSpec& machine) {
  if (!machine.cache_dir.empty()) return machine.cache_dir;
  if (const char* dir = std::getenv("TACT_CACHE"); dir && *dir) return std::filesystem::absolute(dir);
  if (const char* dir = std::getenv("XDG_CACHE_HOME"); dir && *dir == '/') {  // relative ones are to be ignored
    return std::filesystem::path(dir) / "tact";
  }
  return home() / ".cache" / "tact";
}

std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(share_dir() / "scenes", error)) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::filesystem::path find_scene(const std::string& name_or_path) {
  std::error_code ignored;
  std::filesystem::path given(name_or_path);
  if (given.has_parent_path() || given.extension() == ".toml") return given;  // load_scene says if it is not there
  auto own = share_dir() / "scenes" / (name_or_path + ".toml");
  if (!name_or_path.empty() && std::filesystem::is_regular_file(own, ignored)) return own;
  std::vector<std::string> names;
  for (const auto& file : scene_files()) names.push_back(file.stem().string());
  std::string expected = "a scene file (*.toml) or one of";
  for (const auto& n : names) expected += " " + n;
  if (const auto near = nearest(name_or_path, names)) expected += "; did you mean " + *near + "?";
  throw SetupError("scene: found \"" + name_or_path + "\", expected " + expected);
}

}  // namespace tact
