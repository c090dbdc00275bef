#include "cli/run_options.hpp"

#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <charconv>
#include <cmath>

#include "fault/fault.hpp"

namespace tact::cli {
namespace fs = std::filesystem;
namespace {

std::uint64_t random_number() {
  std::uint64_t number = 0;
  if (::getrandom(&number, sizeof number, 0) != sizeof number)
    throw SetupError("getrandom: the kernel gave no random bytes");
  return number;
}

std::string hex(std::uint64_t number, std::size_t digits) {
  std::string text(digits, '0');
  for (auto c = text.rbegin(); c != text.rend(); ++c, number >>= 4) *c = "0123456789abcdef"[number & 15];
  return text;
}

/// Scene names may be 24 characters long: so may session names, with 6 random digits in them.
std::string session_name(const std::string& scene) { return scene.substr(0, 17) + "-" + hex(random_number(), 6); }

bool valid_session_name(const std::string& name) {
  return !name.empty() && name.size() <= 24 &&
         name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-") == std::string::npos;
}

void use_mesh(SceneSpec& scene, const char* option, BodySpec& body, const fs::path& mesh, const std::string& unit) {
  body = {};
  const std::string name = option + 2;  // --tool: the body of the keys tool.*
  MachineSpec none;
  apply({"--unit", name + ".unit", unit}, scene, none);
  apply({option, name + ".mesh", mesh.string()}, scene, none);
}

void use_meshes(const RunOptions& options, SceneSpec& scene) {
  if (options.obstacle.empty() && options.tool.empty()) {
    if (!options.unit.empty())
      throw SetupError("--unit: found no mesh it belongs to, expected --obstacle or --tool too");
    return;
  }
  if (options.unit.empty()) {
    throw SetupError("--unit: found none, expected m, cm, mm or inch: the unit of the numbers in your mesh files");
  }
  if (!options.obstacle.empty()) use_mesh(scene, "--obstacle", scene.obstacle, options.obstacle, options.unit);
  if (!options.tool.empty()) use_mesh(scene, "--tool", scene.tool, options.tool, options.unit);
}

void use_script(const std::string& name, Session& session) {
  if (name.empty()) return;
  const auto script = session.scene.scripts.find(name);
  if (script == session.scene.scripts.end()) {
    std::string known;
    for (const auto& [other, spec] : session.scene.scripts) known += " " + other;
    throw SetupError("--script: found \"" + name + "\", expected " +
                     (known.empty() ? "none: scene " + session.scene.name + " has no scripts" : "one of" + known));
  }
  session.script = name;
  session.hand_csv = script->second.hand_csv;
  session.hand_force_max_n = script->second.hand_force_max_n;
}

}  // namespace

Session resolve(const RunOptions& options) {
  Session session;
  const bool own_bodies = !options.obstacle.empty() && !options.tool.empty();
  if (!options.scene.empty()) {
    session.scene = load_scene(find_scene(options.scene));
  } else if (own_bodies) {
    session.scene.name = "own";
    session.scene.title = options.tool.filename().string() + " in " + options.obstacle.filename().string();
  } else {
    throw SetupError(
        "scene: found none, expected the name of a scene (tact scenes), a scene file, or --obstacle and --tool");
  }
  if (!options.machine_file.empty()) {
    session.machine = load_machine(options.machine_file);
  } else if (const fs::path system = "/etc/tact/machine.toml"; fs::exists(system)) {
    session.machine = load_machine(system);
  }
  use_meshes(options, session.scene);
  for (const Setting& setting : options.settings) apply(setting, session.scene, session.machine);
  check_scene(session.scene);

  if (!options.hand.empty() && !options.script.empty()) {
    throw SetupError("--hand: found --script " + options.script + " too, expected one of them: both move the hand");
  }
  use_script(options.script, session);
  if (!options.hand.empty()) session.hand_csv = fs::absolute(options.hand);
  if (!session.hand_csv.empty()) {
    const HandMotion motion = load_hand_motion(session.hand_csv);
    if (!options.hand.empty()) {  // the user's motion says where it begins and ends
      session.scene.start_X_WM = motion.X_WM.front();
      session.scene.goal_X_WM = motion.X_WM.back();
    } else if (!session.scene.goal_X_WM) {
      session.scene.goal_X_WM = motion.X_WM.back();
    }
  }

  session.name = options.session.empty() ? session_name(session.scene.name) : options.session;
  if (!valid_session_name(session.name)) {
    throw SetupError("--session: found \"" + session.name + "\", expected 1 to 24 of the characters a-z, 0-9 and -");
  }
  session.id = random_number();
  if (session.machine.view && session.machine.token.empty()) {
    session.machine.token = hex(random_number(), 16) + hex(random_number(), 16);
  }
  return session;
}

void apply(const Setting& setting, SceneSpec& scene, MachineSpec& machine) {
  static constexpr std::array kMachine{"device.", "gate.", "cpu.", "view.", "cache.", "transport"};
  bool of_machine = false;
  for (const std::string_view prefix : kMachine) of_machine |= setting.key.compare(0, prefix.size(), prefix) == 0;
  try {
    if (of_machine) {
      set_machine_key(machine, setting.key, setting.value);
    } else {
      set_scene_key(scene, setting.key, setting.value);
    }
  } catch (const SetupError& e) {
    throw SetupError(setting.option + ": " + e.what());
  }
}

double parse_duration_s(const std::string& option, const std::string& text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const std::string unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const double factor = unit.empty() || unit == "s" ? 1
                        : unit == "ms"              ? 1e-3
                        : unit == "min"             ? 60
                        : unit == "h"               ? 3600
                                                    : 0;
  const double seconds = number * factor;
  if (error != std::errc{} || !(seconds > 0) || !(seconds <= 1e6)) {
    throw SetupError(option + ": found \"" + text + "\", expected a duration such as 20s, 500ms, 2min or 1h");
  }
  return seconds;
}

Setting parse_set(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw SetupError("--set: found \"" + text + "\", expected KEY=VALUE such as contact.p=8");
  }
  return {"--set", text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace tact::cli
