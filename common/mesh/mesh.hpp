#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "math/pose.hpp"

namespace tact {

/// A triangle soup: metres, in the mesh frame M. Nothing is promised about orientation, welding or closedness.
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Our own checksummed mesh file (magic, schema version, counts, xxh3): the only mesh file that services map.
/// Third-party formats are read by the bake's child process alone.
void save_mesh(const Mesh& mesh, const std::filesystem::path& path);

/// Throws SetupError, naming the file and the reason, when the file is missing, truncated, foreign or damaged.
Mesh load_mesh(const std::filesystem::path& path);

}  // namespace tact
