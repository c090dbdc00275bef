#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "contact/bake/worker/inside.hpp"
#include "contact/bake/worker/progress.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {

/// Pairs of triangles that pass through or touch each other, both ways round, sorted; neighbours (of one part, with a
/// common corner) aside. An edge of one meets the other, so every edge asks the surface of the mesh.
using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
TrianglePairs find_crossings(const Mesh& mesh, const std::vector<std::uint32_t>& part, const Surface& surface,
                             const StageProgress& progress);

/// The mesh without what lies inside the union: triangles that others cross are cut along them first, in double, so
/// that the boundary of the union stays and nothing behind it. What hangs together without being crossed is decided as
/// one.
struct Trimmed {
  Mesh mesh;
  std::size_t buried = 0;  ///< triangles dropped, whole or in part
};
Trimmed drop_buried(const Mesh& mesh, const TrianglePairs& crossings, const Inside& inside,
                    const StageProgress& progress);

}  // namespace tact::contact
