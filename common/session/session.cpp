#include "session/session.hpp"

#include <tuple>

#include "fault/fault.hpp"
#include "session/scene_keys.hpp"
#include "session/toml_file.hpp"

namespace tact {
namespace {

using session::Entry;

[[noreturn]] void refuse(const std::string& where, const std::string& key, const std::string& found,
                         const std::string& expected) {
  throw SetupError(where + key + ": found " + found + ", expected " + expected);
}

void check_file(const std::string& where, const std::string& key, const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) refuse(where, key, "no file \"" + path.string() + "\"", "an existing file");
  if (std::filesystem::is_directory(status)) refuse(where, key, "the folder \"" + path.string() + "\"", "a file");
}

void check_body(const std::string& where, const std::string& name, const BodySpec& body) {
  if (body.shape.empty() && body.mesh.empty()) refuse(where, name, "neither shape nor mesh", "one of them");
  if (!body.shape.empty() && !body.mesh.empty()) refuse(where, name, "both shape and mesh", "one of them");
  if (!body.shape.empty() && !body.unit.empty()) refuse(where, name + ".unit", "a unit", "none: shapes are in metres");
  if (body.mesh.empty()) return;
  if (!body.shape_params.empty()) {
    refuse(where, name + ".params." + body.shape_params.begin()->first, "a shape's parameter", "none with a mesh");
  }
  if (body.unit.empty()) refuse(where, name + ".unit", "nothing", "one of m mm cm inch: the unit of the mesh file");
  check_file(where, name + ".mesh", body.mesh);
}

void check(const SceneSpec& scene, const std::string& where, const std::string& prefix) {
  check_body(where, prefix + "obstacle", scene.obstacle);
  check_body(where, prefix + "tool", scene.tool);
  for (const auto& [name, script] : scene.scripts) {
    const std::string key = prefix + "scripts." + name + ".hand";
    if (script.hand_csv.empty()) refuse(where, key, "nothing", "a path to a CSV file of poses");
    check_file(where, key, script.hand_csv);
  }
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).lexically_normal().parent_path();
}

bool mentions(const std::vector<Entry>& entries, const std::string& key) {
  for (const auto& e : entries) {
    if (e.name == key) return true;
  }
  return false;
}

}  // namespace

SceneSpec load_scene(const std::filesystem::path& path) {
  const auto entries = session::read_toml(path);
  SceneSpec scene;
  scene.file = std::filesystem::absolute(path).lexically_normal();
  scene.name = path.stem().string();
  for (const auto& entry : entries) session::make_room(scene, entry.name);
  const auto keys = session::scene_keys(scene, folder_of(path));
  session::apply(entries, keys, path);
  const std::string where = path.string() + ": ";
  for (const auto& key : keys) {
    // A name taken from the file's own name obeys the same rule as a written one.
    if (key.name == "name" && !key.set(scene.name)) refuse(where, "name", "\"" + scene.name + "\"", key.expected);
  }
  if (mentions(entries, "contact.stiffness_n_per_m") && mentions(entries, "contact.f_max_n")) {
    refuse(where, "contact.stiffness_n_per_m", "f_max_n stated as well", "one of them: F_max = k x_max links them");
  }
  check(scene, where, "");
  return scene;
}

MachineSpec load_machine(const std::filesystem::path& path) {
  MachineSpec machine;
  machine.file = std::filesystem::absolute(path).lexically_normal();
  session::apply(session::read_toml(path), session::machine_keys(machine, folder_of(path)), path);
  return machine;
}

Session load_session(const std::filesystem::path& path) {
  const auto entries = session::read_toml(path);
  Session s;
  const std::string scene_prefix = "scene.";
  for (const auto& entry : entries) {
    if (entry.name.rfind(scene_prefix, 0) == 0) session::make_room(s.scene, entry.name.substr(scene_prefix.size()));
  }
  session::apply(entries, session::session_keys(s, folder_of(path)), path);
  const std::string where = path.string() + ": ";
  if (s.name.empty()) refuse(where, "name", "nothing", "the name of the session");
  if (s.run_dir.empty()) refuse(where, "run_dir", "nothing", "a path to a folder");
  if (!s.hand_csv.empty()) check_file(where, "hand", s.hand_csv);
  check(s.scene, where, scene_prefix);
  return s;
}

void save_session(const Session& s, const std::filesystem::path& path) {
  Session copy = s;  // keys bind to an object they may change
  session::write_toml(session::session_keys(copy, folder_of(path)), path);
}

void check_scene(const SceneSpec& scene) { check(scene, scene.file.empty() ? "" : scene.file.string() + ": ", ""); }

void set_scene_key(SceneSpec& scene, const std::string& key, const std::string& value) {
  SceneSpec next = scene;
  session::make_room(next, key);
  session::apply_text(key, value, session::scene_keys(next, std::filesystem::current_path()));
  // Of two that exclude each other, the last one said holds.
  if (key == "contact.f_max_n") next.contact.stiffness_n_per_m = 0;
  for (auto [name, before, now] :
       {std::tuple{"obstacle", &scene.obstacle, &next.obstacle}, std::tuple{"tool", &scene.tool, &next.tool}}) {
    if (now->shape != before->shape) {
      now->shape_params.clear();
      now->mesh.clear();
      now->unit.clear();
    } else if (now->mesh != before->mesh) {
      now->shape.clear();
      now->shape_params.clear();
    }
  }
  scene = std::move(next);
}

void set_machine_key(MachineSpec& machine, const std::string& key, const std::string& value) {
  session::apply_text(key, value, session::machine_keys(machine, std::filesystem::current_path()));
}

}  // namespace tact
