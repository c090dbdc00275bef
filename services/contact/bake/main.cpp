// tact-bake: reads other people's meshes and makes the files that the contact server maps. A short-lived child process,
// so that a hostile mesh can crash nothing else.
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/sysinfo.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "contact/bake/content_key.hpp"
#include "contact/bake/worker/bake_parts.hpp"
#include "fault/fault.hpp"
#include "session/session.hpp"

namespace tact::contact {
namespace {

constexpr int kExitSetupError = 2;

struct Options {
  std::filesystem::path scene, session, cache;
  std::string part = "both";
  bool progress = false;
};

/// A mesh that would need more than most of the machine's memory fails here, not in the kernel's out-of-memory killer.
void limit_memory() {
#ifndef TACT_SANITIZED
  struct sysinfo info {};
  if (::sysinfo(&info) != 0) return;
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  const rlim_t most = static_cast<rlim_t>(info.totalram) * info.mem_unit / 10 * 9;
  limit.rlim_cur = std::min(limit.rlim_cur, most);
  ::setrlimit(RLIMIT_AS, &limit);
#endif
}

std::atomic<int> stop_asked = 0;         ///< the signal; also asked by TBB's threads
std::atomic<bool> interruptible = true;  ///< nothing is half-written, and nobody asks stop_asked: reading a mesh
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

/// Ctrl-C and a polite end: what is half-written is removed, then the signal does what it does. While a mesh is read,
/// and the second time, it does so at once.
void stop_when_asked() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::signal(signal, [](int number) {
      if (stop_asked.exchange(number) == 0 && !interruptible) return;
      std::signal(number, SIG_DFL);
      std::raise(number);  // ends the process when this handler returns
    });
  }
}

StageProgress reporter(const Options& options, const std::string& part) {
  const auto go_on = [](const char* stage) {
    interruptible = std::strcmp(stage, "reading") == 0;
    return stop_asked == 0;
  };
  if (!options.progress) return [go_on](const char* stage, double) { return go_on(stage); };
  // Twenty lines a second are plenty, but each new stage is worth one.
  return [go_on, part, last = std::chrono::steady_clock::time_point(), stage_before = std::string()](
             const char* stage, double fraction) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (!go_on(stage)) return false;
    if (stage == stage_before && now - last < std::chrono::milliseconds(50)) return true;
    last = now;
    stage_before = stage;
    std::printf("%s\n", nlohmann::json({{"part", part}, {"stage", stage}, {"fraction", fraction}}).dump().c_str());
    std::fflush(stdout);
    return true;
  };
}

/// `body` names the mesh that is being worked on, for the one error that cannot name it itself.
void bake(const Options& options, std::string& body) {
  std::filesystem::create_directories(options.cache);
  const SceneSpec scene = options.session.empty() ? load_scene(options.scene) : load_session(options.session).scene;
  const auto say = [&](const BakedFiles& files) {
    if (!options.progress) std::printf("%s\n%s\n%s\n", files.data.c_str(), files.mesh.c_str(), files.report.c_str());
  };
  if (options.part != "tool") {
    body = body_name(scene.obstacle);
    const std::uint64_t key = obstacle_key(scene);
    const BakedFiles files = obstacle_files(options.cache, key);
    bake_obstacle(scene, files, key, reporter(options, "obstacle"));
    say(files);
  }
  if (options.part != "obstacle") {
    body = body_name(scene.tool);
    const double spacing_m =
        scene.spacing_voxels > 0 ? tool_spacing_m(scene, obstacle_files(options.cache, obstacle_key(scene))) : 0;
    const std::uint64_t key = tool_key(scene, spacing_m);
    const BakedFiles files = tool_files(options.cache, key);
    bake_tool(scene, spacing_m, files, key, reporter(options, "tool"));
    say(files);
  }
}

int fail(const Options& options, const std::string& text) {
  if (options.progress) {
    std::printf(
        "%s\n",
        nlohmann::json({{"error", text}}).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else {
    std::fprintf(stderr, "tact-bake: %s\n", text.c_str());
  }
  return kExitSetupError;
}

}  // namespace
}  // namespace tact::contact

int main(int argc, char** argv) {
  using namespace tact::contact;
  Options options;
  CLI::App app{"Bakes the distance field of a scene's obstacle and the pointshell of its tool into a cache folder."};
  app.name("tact-bake");
  app.footer(
      "Example: tact-bake --scene alpha.toml --cache ~/.cache/tact\n`tact bake` does the same and shows what was "
      "found.");
  auto* scene = app.add_option("--scene", options.scene, "Scene file")->check(CLI::ExistingFile);
  app.add_option("--session", options.session, "Session file, instead of a scene")
      ->check(CLI::ExistingFile)
      ->excludes(scene);
  app.add_option("--cache", options.cache, "Folder for the baked files, made if missing")->required();
  app.add_option("--part", options.part, "What to bake")->check(CLI::IsMember({"obstacle", "tool", "both"}));
  app.add_flag("--progress", options.progress, "Print progress and errors as one JSON object a line on stdout");
  CLI11_PARSE(app, argc, argv);
  if (options.scene.empty() && options.session.empty()) return fail(options, "give --scene FILE or --session FILE");
  if (options.progress) ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // nobody is left to use the result
  limit_memory();
  stop_when_asked();
  std::string body = "bake";
  try {
    bake(options, body);
    if (stop_asked != 0) throw Cancelled();  // while the last file was written
  } catch (const std::bad_alloc&) {
    return fail(options, body + ": not enough memory for this bake: lower the resolution or simplify the mesh");
  } catch (const Cancelled&) {
    std::signal(stop_asked, SIG_DFL);
    return std::raise(stop_asked);
  } catch (const std::exception& error) {
    return fail(options, error.what());
  }
  return 0;
}
