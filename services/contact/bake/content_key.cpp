#include "contact/bake/content_key.hpp"

#include <fstream>
#include <sstream>
#include <vector>

#include "contact/bake/bake_report.hpp"
#include "fault/fault.hpp"
#include "file/sealed_file.hpp"
#include "session/mesh_parts.hpp"
#include "shapes/shapes.hpp"

namespace tact::contact {
namespace {

/// Raise it whenever a bake would give other files from the same input.
constexpr int kMethod = 9;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  if (!std::filesystem::is_regular_file(path) || !file || !(bytes << file.rdbuf())) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error) && std::filesystem::file_size(path, error) == 0) {
      throw SetupError(path.string() + ": the mesh file is empty");
    }
    throw SetupError(path.string() + ": cannot read the mesh file: check the path and its permissions");
  }
  return std::move(bytes).str();
}

/// A .gltf keeps its vertices in other files: hash those it names, wherever in the text it names them.
std::uint64_t add_gltf_buffers(const std::string& text, const std::filesystem::path& folder, std::uint64_t hash) {
  for (std::size_t at = text.find("\"uri\""); at != std::string::npos; at = text.find("\"uri\"", at + 5)) {
    const std::size_t begin = text.find('"', at + 5),
                      end = begin == std::string::npos ? begin : text.find('"', begin + 1);
    if (end == std::string::npos) break;
    const std::string uri = text.substr(begin + 1, end - begin - 1);
    std::error_code error;
    if (uri.rfind("data:", 0) == 0 || !std::filesystem::is_regular_file(folder / uri, error)) continue;
    hash = hash_text(read_file(folder / uri), hash);
  }
  return hash;
}

/// Says whose shape it is that cannot be made.
Mesh shape_of(const SceneSpec& scene, const char* which, const BodySpec& body) {
  try {
    return make_shape(body.shape, body.shape_params);
  } catch (const SetupError& error) {
    throw SetupError((scene.file.empty() ? "" : scene.file.string() + ": ") + which + ": " + error.what());
  }
}

/// `which`: "obstacle" or "tool".
std::uint64_t body_key(const SceneSpec& scene, const char* which, const BodySpec& body, std::uint64_t seed) {
  std::ostringstream options;
  options << std::hexfloat << body.unit << '|' << body.sheet_thickness_m;
  std::uint64_t hash = hash_text(options.str(), seed);
  if (!body.shape.empty()) {  // the shape's mesh itself, so that a changed generator is noticed
    const Mesh mesh = shape_of(scene, which, body);
    hash = hash_bytes(std::as_bytes(std::span(mesh.vertices)), hash);
    return hash_bytes(std::as_bytes(std::span(mesh.triangles)), hash);
  }
  if (body.unit.empty()) {
    throw SetupError(body.mesh.string() +
                     ": no unit given, expected unit = m, mm, cm or inch: mesh files do not state it");
  }
  const MeshParts parts = mesh_parts(body.mesh);
  for (const std::string& name : parts.only) hash = hash_text("part " + name, hash);
  for (const std::string& name : parts.without) hash = hash_text("without " + name, hash);
  const std::string text = read_file(parts.file);
  hash = hash_text(text, hash_text(parts.file.extension().string(), hash));
  if (parts.file.extension() == ".gltf") hash = add_gltf_buffers(text, parts.file.parent_path(), hash);
  return hash;
}

BakedFiles files(const std::filesystem::path& cache, const std::string& stem, const char* extension) {
  return {cache / (stem + extension), cache / (stem + ".mesh"), cache / (stem + ".json"), cache / (stem + ".lock")};
}

}  // namespace

std::uint64_t obstacle_key(const SceneSpec& scene) {
  std::ostringstream options;
  options << "field " << kMethod << ' ' << std::hexfloat;
  if (scene.field_error_mm > 0) {
    options << "error " << scene.field_error_mm;
  } else {
    options << scene.field_resolution;
  }
  return body_key(scene, "obstacle", scene.obstacle, hash_text(options.str()));
}

std::uint64_t tool_key(const SceneSpec& scene, double spacing_m) {
  std::ostringstream options;
  options << "shell " << kMethod << ' ' << scene.levels << ' ' << std::hexfloat;
  if (spacing_m > 0) {
    options << "spacing " << spacing_m;
  } else {
    options << scene.points;
  }
  return body_key(scene, "tool", scene.tool, hash_text(options.str()));
}

double tool_spacing_m(const SceneSpec& scene, const BakedFiles& obstacle) {
  if (!(scene.spacing_voxels > 0)) return 0;
  if (!std::filesystem::exists(obstacle.report)) {
    throw SetupError(obstacle.report.string() +
                     ": no voxel there, which tool.spacing_voxels counts in: bake the obstacle first");
  }
  return scene.spacing_voxels * read_bake_report(obstacle.report, BakedPart::obstacle).voxel_m;
}

BakedFiles obstacle_files(const std::filesystem::path& cache, std::uint64_t key) {
  return files(cache, "obstacle-" + hex(key), ".field");
}

BakedFiles tool_files(const std::filesystem::path& cache, std::uint64_t key) {
  return files(cache, "tool-" + hex(key), ".shell");
}

std::string body_name(const BodySpec& body) { return body.shape.empty() ? body.mesh.string() : "shape " + body.shape; }

}  // namespace tact::contact
