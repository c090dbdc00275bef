#include "session/session.hpp"

#include <climits>
#include <cmath>
#include <numbers>
#include <sstream>
#include <utility>

#include "fault/fault.hpp"
#include "fault/text.hpp"
#include "session/mesh_parts.hpp"
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
  if (!std::filesystem::exists(status))
    refuse(where, key, "no file " + quoted_line(path.native(), PATH_MAX), "an existing file");
  if (std::filesystem::is_directory(status))
    refuse(where, key, "the folder " + quoted_line(path.native(), PATH_MAX), "a file");
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
  check_file(where, name + ".mesh", mesh_parts(body.mesh).file);
}

void check_scene(const SceneSpec& scene, const std::string& where, const std::string& prefix) {
  // Directions are sqrt(4 pi / n) apart; every normal must reach a few (law `potential` relies on it).
  const double reach_min_deg =
      1.5 * std::sqrt(4 * std::numbers::pi / scene.contact.directions) * 180 / std::numbers::pi;
  if (scene.contact.reach_deg < reach_min_deg) {
    std::ostringstream found;
    found << scene.contact.reach_deg;
    refuse(where, prefix + "contact.reach_deg", found.str(),
           std::to_string(std::lround(std::ceil(reach_min_deg))) + " or more with " +
               std::to_string(scene.contact.directions) + " directions (contact.directions)");
  }
  check_body(where, prefix + "obstacle", scene.obstacle);
  check_body(where, prefix + "tool", scene.tool);
  for (const auto& [name, script] : scene.scripts) {
    const std::string key = prefix + "scripts." + name + ".hand";
    if (script.hand_csv.empty()) refuse(where, key, "nothing", "a path to a CSV file of poses");
    check_file(where, key, script.hand_csv);
  }
}

bool mentions(const std::vector<Entry>& entries, const std::string& key) {
  for (const auto& e : entries) {
    if (e.name == key) return true;
  }
  return false;
}

/// Notes that `file` moves the hand, when it does. Whether what it names is there is asked once all has been said
/// (check_run): a later file or the command line may say otherwise.
void note_run(RunSpec& run, const std::filesystem::path& file, const std::vector<Entry>& entries) {
  const bool script = mentions(entries, "run.script"), hand = mentions(entries, "run.hand");
  if (script && hand) {
    refuse(file.string() + ": ", "run.hand", "run.script stated as well", "one of them: both move the hand");
  }
  if (script || hand) run.said_in = file;
}

void check_mode(const std::string& where, const std::string& prefix, const CouplingSpec& coupling,
                const MachineSpec& machine) {
  if (coupling.integrator == "auto" || machine.mode != "impedance" || coupling.kind == "dynamic") return;
  refuse(where, prefix + "coupling.integrator", "\"" + coupling.integrator + "\"",
         "\"auto\" with coupling.kind = \"" + coupling.kind +
             "\" and device.mode = \"impedance\": the handle is the device's and the tool has no motion of its own, so "
             "nothing is integrated");
}

void check_run(const Session& s) {
  const std::string where = s.run.said_in.empty() ? "" : s.run.said_in.string() + ": ";
  if (!s.run.hand_csv.empty()) check_file(where, "run.hand", s.run.hand_csv);
  if (s.run.script.empty() || s.scene.scripts.count(s.run.script) != 0) return;
  std::string known;
  for (const auto& [name, script] : s.scene.scripts) known += " " + name;
  refuse(where, "run.script", "\"" + s.run.script + "\"",
         known.empty() ? "none: scene " + s.scene.name + " has no scripts" : "one of" + known);
}

void check_machine(const MachineSpec& m) {
  const std::string where = m.file.empty() ? "" : m.file.string() + ": ";
  const bool playback = m.device == "playback";
  if (playback && m.recording.empty()) {
    refuse(where, "device.recording", "nothing", "a path to a recording (tact run --record): the driver is playback");
  }
  if (playback) check_file(where, "device.recording", m.recording);
  if (!m.simulated.events.empty()) check_file(where, "device.events", m.simulated.events);
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return std::filesystem::absolute(file).lexically_normal().parent_path();
}

/// Of two that exclude each other, the last one said holds.
void keep_last_said(const std::string& key, const SceneSpec& before, SceneSpec& next) {
  if (key == "contact.f_max_n") next.contact.stiffness_n_per_m = 0;
  if (key == "tool.points") next.spacing_voxels = 0;
  if (key == "obstacle.field_cells") next.field_error_mm = 0;
  for (auto [was, now] : {std::pair{&before.obstacle, &next.obstacle}, std::pair{&before.tool, &next.tool}}) {
    if (now->shape != was->shape) {
      now->shape_params.clear();
      now->mesh.clear();
      now->unit.clear();
    } else if (now->mesh != was->mesh) {
      now->shape.clear();
      now->shape_params.clear();
    }
  }
}

}  // namespace

void load_scene(const std::filesystem::path& path, Session& session) {
  const auto entries = session::read_toml(path);
  SceneSpec& scene = session.scene = {};
  scene.file = std::filesystem::absolute(path).lexically_normal();
  scene.name = path.stem().string();
  for (const auto& entry : entries) session::make_room(scene, entry.name);
  auto keys = session::scene_keys(scene, folder_of(path));
  session::append(keys, session::run_keys(session.run, folder_of(path)));
  session::apply(entries, keys, path);
  const std::string where = path.string() + ": ";
  for (const auto& key : keys) {
    // A name taken from the file's own name obeys the same rule as a written one.
    if (key.name == "name" && !key.set(scene.name)) refuse(where, "name", "\"" + scene.name + "\"", key.expected);
  }
  const auto one_of = [&](const std::string& key, const std::string& table, const char* other, const char* why) {
    if (mentions(entries, key) && mentions(entries, table + other)) {
      refuse(where, key, std::string{other} + " stated as well", std::string{"one of them: "} + why);
    }
  };
  one_of("contact.stiffness_n_per_m", "contact.", "f_max_n", "F_max = k x_max links them");
  one_of("tool.spacing_voxels", "tool.", "points", "both say how dense the pointshell is");
  check_scene(scene, where, "");
  note_run(session.run, path, entries);
}

SceneSpec load_scene(const std::filesystem::path& path) {
  Session session;
  load_scene(path, session);
  return session.scene;
}

void load_machine(const std::filesystem::path& path, Session& session) {
  const auto entries = session::read_toml(path);
  session.machine = {};
  session.machine.file = std::filesystem::absolute(path).lexically_normal();
  auto keys = session::machine_keys(session.machine, folder_of(path));
  session::append(keys, session::run_keys(session.run, folder_of(path)));
  session::apply(entries, keys, path);
  note_run(session.run, path, entries);
}

Session load_session(const std::filesystem::path& path) {
  const auto entries = session::read_toml(path, 4096);  // what we wrote of a scene file is longer
  Session s;
  const std::string scene_prefix = "scene.";
  for (const auto& entry : entries) {
    if (entry.name.rfind(scene_prefix, 0) == 0) session::make_room(s.scene, entry.name.substr(scene_prefix.size()));
  }
  session::apply(entries, session::session_keys(s, folder_of(path)), path);
  const std::string where = path.string() + ": ";
  if (s.name.empty()) refuse(where, "name", "nothing", "the name of the session");
  if (s.run_dir.empty()) refuse(where, "run_dir", "nothing", "a path to a folder");
  check_scene(s.scene, where, scene_prefix);
  check_mode(where, scene_prefix, s.scene.coupling, s.machine);
  note_run(s.run, path, entries);
  check_run(s);
  return s;
}

void save_session(const Session& s, const std::filesystem::path& path) {
  Session copy = s;  // keys bind to an object they may change
  session::write_toml(session::session_keys(copy, folder_of(path)), path);
}

void check_session(const Session& session) {
  const auto& file = session.scene.file;
  check_scene(session.scene, file.empty() ? "" : file.string() + ": ", "");
  check_machine(session.machine);
  check_coupling(session.scene.coupling, session.machine);
  check_run(session);
  if (session.machine.device == "playback" && scripted_hand(session)) {
    refuse("", session.run.script.empty() ? "run.hand" : "run.script", "a motion",
           "none: the driver is playback, and the recording moves the handle");
  }
}

void check_coupling(const CouplingSpec& coupling, const MachineSpec& machine) { check_mode("", "", coupling, machine); }

std::optional<ScriptSpec> scripted_hand(const Session& session) {
  if (!session.run.script.empty()) return session.scene.scripts.at(session.run.script);
  if (!session.run.hand_csv.empty()) return ScriptSpec{session.run.hand_csv, {}};
  return std::nullopt;
}

void set_key(Session& session, const std::string& key, const std::string& value) {
  const auto base = std::filesystem::current_path();
  Session next = session;
  session::make_room(next.scene, key);
  auto keys = session::scene_keys(next.scene, base);
  session::append(keys, session::machine_keys(next.machine, base));
  session::append(keys, session::run_keys(next.run, base));
  session::apply_text(key, value, keys);
  keep_last_said(key, session.scene, next.scene);
  if (key == "run.script" || key == "run.hand") next.run.said_in.clear();
  session = std::move(next);
}

void set_scene_key(SceneSpec& scene, const std::string& key, const std::string& value) {
  SceneSpec next = scene;
  session::make_room(next, key);
  session::apply_text(key, value, session::scene_keys(next, std::filesystem::current_path()));
  keep_last_said(key, scene, next);
  scene = std::move(next);
}

}  // namespace tact
