#include "contact/bake/worker/import.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <optional>
#include <set>

#include "fault/fault.hpp"
#include "fault/nearest.hpp"
#include "session/mesh_parts.hpp"

namespace tact::contact {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& text) {
  throw SetupError(path.string() + ": " + text);
}

std::optional<double> metres(const std::string& unit) {
  if (unit == "m") return 1;
  if (unit == "mm") return 1e-3;
  if (unit == "cm") return 1e-2;
  if (unit == "inch") return 0.0254;
  return std::nullopt;
}

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_collada(const std::filesystem::path& path) { return extension_of(path) == ".dae"; }

void check_extension(const std::filesystem::path& path) {
  constexpr std::array kKnown{".obj", ".stl", ".ply", ".gltf", ".glb", ".dae", ".off"};
  const std::string extension = extension_of(path);
  if (std::find(kKnown.begin(), kKnown.end(), extension) == kKnown.end()) {
    refuse(path, "unknown mesh format \"" + extension + "\", expected .obj, .stl, .ply, .off, .gltf, .glb or .dae");
  }
}

/// Which parts are wanted, and what there was.
class Choice {
 public:
  enum class Fate { out, in, dropped };  ///< dropped: whatever is named below

  explicit Choice(const MeshParts& parts) : parts_(parts) {}

  Fate everything() const { return parts_.only.empty() ? Fate::in : Fate::out; }
  /// Of a node or mesh of this name within one of that fate.
  Fate fate(const std::string& name, Fate within) {
    if (!name.empty()) names_.insert(name);
    if (within == Fate::dropped || holds(parts_.without, name)) return Fate::dropped;
    return holds(parts_.only, name) ? Fate::in : within;
  }

  /// Refuses a name that was never met.
  void check() const {
    for (const auto* asked : {&parts_.only, &parts_.without}) {
      for (const std::string& name : *asked) {
        if (names_.contains(name)) continue;
        std::string text = "found no part \"" + name + "\" in it, expected one of ";
        for (const std::string& known : names_) text += (known == *names_.begin() ? "\"" : ", \"") + known + "\"";
        if (const auto near = nearest(name, {names_.begin(), names_.end()})) text += "; did you mean " + *near + "?";
        refuse(parts_.file, text);
      }
    }
  }

 private:
  static bool holds(const std::vector<std::string>& list, const std::string& name) {
    return std::find(list.begin(), list.end(), name) != list.end();
  }
  const MeshParts& parts_;
  std::set<std::string> names_;
};

/// Reads the nodes of a file into one mesh.
struct Reader {
  const aiScene& scene;
  const std::filesystem::path& path;
  double scale;
  Choice choice;
  Mesh mesh;

  /// Adds the meshes of a node and of those below it, in the root's frame.
  void add(const aiNode& node, const aiMatrix4x4& parent, Choice::Fate within, int depth) {
    if (depth > 256) refuse(path, "parts nested deeper than 256 levels");
    const aiMatrix4x4 transform = parent * node.mTransformation;
    const Choice::Fate fate = choice.fate(node.mName.C_Str(), within);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
      if (choice.fate(part.mName.C_Str(), fate) == Choice::Fate::in) add(part, transform, node.mName.C_Str());
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], transform, fate, depth + 1);
  }

 private:
  void add(const aiMesh& part, const aiMatrix4x4& transform, const char* node) {
    const bool mirrored = transform.Determinant() < 0;  // a mirror turns the order of corners round
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      const Vec3 metric = scale * Vec3(p.x, p.y, p.z);
      if (!metric.allFinite()) {
        refuse(path, "vertex " + std::to_string(v) + " of node \"" + node + "\" is not finite");
      }
      mesh.vertices.push_back(metric.cast<float>());
    }
    for (unsigned f = 0; f < part.mNumFaces; ++f) {
      const aiFace& face = part.mFaces[f];
      if (face.mNumIndices != 3) continue;  // points and lines
      const std::array<std::uint32_t, 3> t{face.mIndices[0], face.mIndices[1], face.mIndices[2]};
      if (*std::max_element(t.begin(), t.end()) >= part.mNumVertices) {
        refuse(path, "face " + std::to_string(f) + " names a vertex that is not there");
      }
      mesh.triangles.push_back({base + t[0], base + t[mirrored ? 2 : 1], base + t[mirrored ? 1 : 2]});
    }
  }
};

}  // namespace

Mesh import_mesh(const std::filesystem::path& file, const std::string& unit) {
  const MeshParts parts = mesh_parts(file);
  const std::filesystem::path& path = parts.file;
  const auto scale = metres(unit);
  if (!scale) {
    refuse(path, unit.empty() ? "no unit given, expected m, mm, cm or inch"
                              : "found unit \"" + unit + "\", expected m, mm, cm or inch");
  }
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) refuse(path, "no such mesh file");
  if (std::filesystem::file_size(path, error) == 0) refuse(path, "the mesh file is empty");
  check_extension(path);

  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);  // the file's own axes
  const aiScene* scene = importer.ReadFile(path.string(), aiProcess_Triangulate | aiProcess_SortByPType);
  if (scene == nullptr) refuse(path, std::string("cannot read the mesh: ") + importer.GetErrorString());
  Reader reader{*scene, path, *scale, Choice(parts), {}};
  if (aiNode* root = scene->mRootNode; root != nullptr) {
    // The root of a COLLADA scene holds the file's unit and nothing else: the caller states the unit.
    if (is_collada(path)) root->mTransformation = aiMatrix4x4();
    reader.add(*root, aiMatrix4x4(), reader.choice.everything(), 0);
  }
  reader.choice.check();
  const Mesh& mesh = reader.mesh;
  if (mesh.triangles.empty()) refuse(path, "the mesh has no triangles");

  Vec3 low = Vec3::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t i : t) {
      low = low.cwiseMin(mesh.vertices[i].cast<double>());
      high = high.cwiseMax(mesh.vertices[i].cast<double>());
    }
  }
  if (!low.allFinite() || !high.allFinite()) refuse(path, "a vertex is not finite");
  const double size = (high - low).maxCoeff(), away = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  if (!(size > 0)) refuse(path, "the mesh has no extent");
  const auto text = [](double metre) { return std::to_string(metre) + " m"; };
  if (size < 1e-6 || size > 1e5) {
    refuse(path, "the mesh is " + text(size) + " long, expected 1 um to 100 km: check the unit");
  }
  if (away > 1e4 * size) {
    refuse(path, "the mesh is " + text(size) + " long but lies " + text(away) +
                     " from its origin, too far for 32-bit coordinates: move it to the origin");
  }
  return std::move(reader.mesh);
}

}  // namespace tact::contact
