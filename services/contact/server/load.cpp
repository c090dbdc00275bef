#include "contact/server/load.hpp"

#include <chrono>

#include "contact/bake/baked_scene.hpp"
#include "fault/fault.hpp"
#include "log/log.hpp"

namespace tact::contact {
namespace {

std::string name_of(const BodySpec& body) { return body.shape.empty() ? body.mesh.filename().string() : body.shape; }

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::uint64_t bytes_of(const Pointshell& shell) {
  const std::size_t a_point = 2 * sizeof(Eigen::Vector3f) + 2 * sizeof(float) + 2 * sizeof(std::uint32_t);
  return shell.size() * a_point;
}

void log_body(const std::string& name, const BakedBody& body, std::string& notes) {
  if (body.from_cache) {
    log_info(name, ": from the cache, ", body.data.string());
  } else {
    log_info(name, ": baked in ", body.bake_seconds, " s with ", body.bake_peak_bytes >> 20, " MB, ",
             body.data.string());
  }
  for (const std::string& warning : body.warnings) {
    log_warn(warning);
    notes += warning + '\n';
  }
}

}  // namespace

LoadedScene load_bodies(const Session& session, const LoadProgress& progress) {
  const SceneSpec& spec = session.scene;
  const std::string obstacle = name_of(spec.obstacle), tool = name_of(spec.tool);
  const auto on_step = [&](const BakeStep& step) {
    return progress("baking " + (step.part == "tool" ? tool : obstacle) + ": " + step.stage, step.fraction);
  };
  auto begin = std::chrono::steady_clock::now();
  const BakedScene baked = ensure_baked(spec, cache_dir(session.machine), on_step);
  const double bake_s = seconds_since(begin);
  LoadedScene scene;
  log_body(obstacle, baked.obstacle, scene.notes);
  log_body(tool, baked.tool, scene.notes);
  scene.field_path = baked.obstacle.data;
  scene.obstacle_mesh_path = baked.obstacle.mesh;
  scene.tool_mesh_path = baked.tool.mesh;
  const bool fresh = !baked.obstacle.from_cache || !baked.tool.from_cache;
  scene.parts.push_back({fresh ? "bake (child process)" : "look-up in the cache", bake_s, 0});

  progress("loading the distance field", -1);
  begin = std::chrono::steady_clock::now();
  scene.field = DistanceField::open(baked.obstacle.data, baked.obstacle.hash, true);
  scene.parts.push_back({"distance field of " + obstacle, seconds_since(begin), scene.field.bytes()});

  progress("loading the pointshell", -1);
  begin = std::chrono::steady_clock::now();
  scene.shell = std::make_shared<const Pointshell>(load_pointshell(baked.tool.data, baked.tool.hash));
  scene.parts.push_back({"pointshell of " + tool, seconds_since(begin), bytes_of(*scene.shell)});
  for (const LoadedPart& part : scene.parts) log_info(part.what, ": ", part.seconds, " s, ", part.bytes >> 10, " KB");
  return scene;
}

}  // namespace tact::contact
