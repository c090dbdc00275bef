#include "contact/bake/worker/import.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <algorithm>
#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <optional>

#include "fault/fault.hpp"

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

/// Adds the meshes of a node and of those below it, in the root's frame.
void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& parent, double scale, int depth,
              const std::filesystem::path& path, Mesh& mesh) {
  if (depth > 256) refuse(path, "parts nested deeper than 256 levels");
  const aiMatrix4x4 transform = parent * node.mTransformation;
  const bool mirrored = transform.Determinant() < 0;  // a mirror turns the order of corners round
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const auto base = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned v = 0; v < part.mNumVertices; ++v) {
      const aiVector3D p = transform * part.mVertices[v];
      const Vec3 metric = scale * Vec3(p.x, p.y, p.z);
      if (!metric.allFinite()) {
        refuse(path, "vertex " + std::to_string(v) + " of node \"" + node.mName.C_Str() + "\" is not finite");
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
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    add_node(scene, *node.mChildren[c], transform, scale, depth + 1, path, mesh);
  }
}

}  // namespace

Mesh import_mesh(const std::filesystem::path& path, const std::string& unit) {
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
  Mesh mesh;
  if (aiNode* root = scene->mRootNode; root != nullptr) {
    // The root of a COLLADA scene holds the file's unit and nothing else: the caller states the unit.
    if (is_collada(path)) root->mTransformation = aiMatrix4x4();
    add_node(*scene, *root, aiMatrix4x4(), *scale, 0, path, mesh);
  }
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
  return mesh;
}

}  // namespace tact::contact
