#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace tact {

/// Which parts of a mesh file make a body. Names are those of nodes (then with all nodes below) or of meshes.
struct MeshParts {
  std::filesystem::path file;
  std::vector<std::string> only;     ///< empty: all
  std::vector<std::string> without;  ///< left out, of those
};

/// "engine.glb": all of it. "engine.glb#piston#ring": these parts. "engine.glb#!piston": all but this one. A file whose
/// own name holds a '#' is taken whole.
MeshParts mesh_parts(const std::filesystem::path& mesh);

}  // namespace tact
