#include "cli/run_options.hpp"

#include <sys/random.h>
#include <unistd.h>

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

void use_mesh(Session& session, const char* option, BodySpec& body, const fs::path& mesh, const std::string& unit) {
  body = {};
  const std::string name = option + 2;  // --tool: the body of the keys tool.*
  apply({"--unit", name + ".unit", unit}, session);
  apply({option, name + ".mesh", mesh.string()}, session);
}

void use_meshes(const RunOptions& options, Session& session) {
  if (options.obstacle.empty() && options.tool.empty()) {
    if (!options.unit.empty())
      throw SetupError("--unit: found no mesh it belongs to, expected --obstacle or --tool too");
    return;
  }
  if (options.unit.empty()) {
    throw SetupError("--unit: found none, expected m, cm, mm or inch: the unit of the numbers in your mesh files");
  }
  if (!options.obstacle.empty())
    use_mesh(session, "--obstacle", session.scene.obstacle, options.obstacle, options.unit);
  if (!options.tool.empty()) use_mesh(session, "--tool", session.scene.tool, options.tool, options.unit);
}

}  // namespace

void load_machine_file(const fs::path& stated, Session& session) {
  const fs::path system = "/etc/tact/machine.toml";
  if (!stated.empty()) {
    load_machine(stated, session);
  } else if (fs::exists(system)) {
    load_machine(system, session);
  }
}

Session resolve(const RunOptions& options) {
  Session session;
  const bool own_bodies = !options.obstacle.empty() && !options.tool.empty();
  if (!options.scene.empty()) {
    load_scene(find_scene(options.scene), session);
  } else if (own_bodies) {
    session.scene.name = "own";
    session.scene.title = options.tool.filename().string() + " in " + options.obstacle.filename().string();
  } else {
    throw SetupError(
        "scene: found none, expected the name of a scene (tact scenes), a scene file, or --obstacle and --tool");
  }
  load_machine_file(options.machine_file, session);
  use_meshes(options, session);
  for (const Setting& setting : options.settings) apply(setting, session);
  check_session(session);

  if (const auto hand = scripted_hand(session)) {
    const HandMotion motion = load_hand_motion(hand->hand_csv);
    if (!session.run.hand_csv.empty()) {  // the user's motion says where it begins and ends
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

void apply(const Setting& setting, Session& session) {
  try {
    set_key(session, setting.key, setting.value);
  } catch (const SetupError& e) {
    throw SetupError(setting.option + ": " + e.what());
  }
}

Setting parse_set(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw SetupError("--set: found \"" + text + "\", expected KEY=VALUE such as contact.p=8");
  }
  return {"--set", text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace tact::cli
