#pragma once
#include <cstdint>
#include <filesystem>

#include "session/session.hpp"

namespace tact::contact {

/// What a baked file was made from: changes whenever the geometry, the options or our own method change. Reads the
/// whole mesh file (and what a .gltf refers to); SetupError when it cannot be read.
std::uint64_t obstacle_key(const SceneSpec& scene);
std::uint64_t tool_key(const SceneSpec& scene, double spacing_m);  ///< spacing_m: tool_spacing_m

/// Files of one baked body in a cache folder.
struct BakedFiles {
  std::filesystem::path data;    ///< distance field or pointshell
  std::filesystem::path mesh;    ///< cleaned mesh, in the body's mesh frame
  std::filesystem::path report;  ///< JSON, written last
  std::filesystem::path lock;
};
BakedFiles obstacle_files(const std::filesystem::path& cache, std::uint64_t key);
BakedFiles tool_files(const std::filesystem::path& cache, std::uint64_t key);

/// Spacing of the pointshell in metres; 0 when tool.points counts. One in voxels needs the voxel, which the obstacle's
/// bake decides: it comes first, and SetupError when its report is not there. The tool's key holds metres, so obstacles
/// of equal voxels share a tool.
double tool_spacing_m(const SceneSpec& scene, const BakedFiles& obstacle);

/// For messages: the mesh file, or "shape NAME".
std::string body_name(const BodySpec& body);

}  // namespace tact::contact
