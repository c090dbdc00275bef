#include <cstdio>
#include <nlohmann/json.hpp>

#include "cli/commands.hpp"

namespace tact::cli {
namespace {

std::string describe(const BodySpec& body) { return body.shape.empty() ? body.mesh.filename().string() : body.shape; }

void print(const SceneSpec& scene) {
  std::printf("%-12s %s\n", scene.name.c_str(), scene.title.c_str());
  std::printf("%-12s   tool %s (%d points) against %s (%d cells), law %s\n", "", describe(scene.tool).c_str(),
              scene.points, describe(scene.obstacle).c_str(), scene.field_resolution, scene.contact.law.c_str());
  for (const auto& [name, script] : scene.scripts) {
    std::printf("%-12s   --script %-10s %s\n", "", name.c_str(), script.description.c_str());
  }
}

nlohmann::ordered_json json_of(const SceneSpec& scene) {
  nlohmann::ordered_json scripts = nlohmann::ordered_json::object();
  for (const auto& [name, script] : scene.scripts) scripts[name] = script.description;
  return {{"name", scene.name},
          {"title", scene.title},
          {"file", scene.file.string()},
          {"tool", describe(scene.tool)},
          {"points", scene.points},
          {"obstacle", describe(scene.obstacle)},
          {"field_cells", scene.field_resolution},
          {"law", scene.contact.law},
          {"scripts", scripts}};
}

}  // namespace

int scenes(bool json) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& file : scene_files()) {
    const SceneSpec scene = load_scene(file);
    if (json) {
      list.push_back(json_of(scene));
    } else {
      print(scene);
    }
  }
  if (json) {
    std::printf("%s\n", list.dump(2).c_str());
  } else {
    std::printf("\nRun one: tact run alpha --script solve. Your own: tact run my_scene.toml\n");
  }
  return 0;
}

}  // namespace tact::cli
