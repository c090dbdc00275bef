#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "contact/bake/bake_child.hpp"
#include "session/session.hpp"

namespace tact::contact {

/// One body, ready to be mapped.
struct BakedBody {
  std::filesystem::path data;    ///< obstacle: DistanceField::open; tool: load_pointshell
  std::filesystem::path mesh;    ///< load_mesh: cleaned, in the body's mesh frame (obstacle: O)
  std::filesystem::path report;  ///< JSON: what was found, decided and measured (README)
  std::uint64_t hash = 0;        ///< content hash of `data`
  bool from_cache = false;
  double bake_seconds = 0;  ///< when it was baked
  std::uint64_t bake_peak_bytes = 0;
  std::uint64_t bytes = 0;            ///< of `data`
  std::vector<std::string> warnings;  ///< repaired or doubtful, one sentence each, naming the file
};

struct BakedScene {
  BakedBody obstacle, tool;
  double voxel_m = 0;                                          ///< of the field
  std::optional<double> field_error_max_m, field_error_rms_m;  ///< nothing: it could be measured nowhere
  std::optional<double> thinnest_wall_m, narrowest_gap_m;      ///< of the obstacle; nothing: it has none (README)
  std::size_t points = 0;                                      ///< of the pointshell
  double largest_gap_voxels = 0;  ///< from any place of the tool's surface to the nearest point, in voxels of the field
};

/// Finds the scene's field, pointshell and cleaned meshes in the cache; bakes what is missing or damaged in a child
/// process (meshes are hostile: a crash, a signal, lack of memory or a refusal of the child becomes one SetupError
/// naming the mesh file). Two processes at once are safe: one bakes, the other waits. Cost when cached: hashing the
/// mesh files and checking the baked files once.
BakedScene ensure_baked(const SceneSpec& scene, const std::filesystem::path& cache, const BakeProgress& progress = {},
                        const std::filesystem::path& program = libexec_dir() / "tact-bake");

}  // namespace tact::contact
