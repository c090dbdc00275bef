#include "mesh/mesh.hpp"

#include <cstring>

#include "fault/fault.hpp"
#include "file/sealed_file.hpp"

namespace tact {
namespace {

constexpr SealedKind kKind{{'M', 'E', 'S', 'H'}, 1, "mesh"};

struct Counts {
  std::uint64_t vertices, triangles;
};
static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(std::array<std::uint32_t, 3>) == 12);

}  // namespace

void save_mesh(const Mesh& mesh, const std::filesystem::path& path) {
  const Counts counts{mesh.vertices.size(), mesh.triangles.size()};
  const std::span<const std::byte> parts[] = {std::as_bytes(std::span(&counts, 1)),
                                              std::as_bytes(std::span(mesh.vertices)),
                                              std::as_bytes(std::span(mesh.triangles))};
  write_sealed(path, kKind, 0, parts);
}

Mesh load_mesh(const std::filesystem::path& path) {
  const SealedFile file = SealedFile::open(path, kKind);
  const auto payload = file.payload();
  const auto bad = [&](const char* what) {
    return SetupError(path.string() + ": the mesh is inconsistent: " + what + ": delete it and bake again");
  };
  Counts counts{};
  if (payload.size() < sizeof(counts)) throw bad("no counts");
  std::memcpy(&counts, payload.data(), sizeof(counts));
  constexpr std::uint64_t kMost = 1ull << 32;
  if (counts.vertices >= kMost || counts.triangles >= kMost ||
      payload.size() != sizeof(counts) + 12 * (counts.vertices + counts.triangles)) {
    throw bad("counts do not fit the size");
  }
  Mesh mesh;
  mesh.vertices.resize(counts.vertices);
  mesh.triangles.resize(counts.triangles);
  const auto vertices = payload.subspan(sizeof(counts), 12 * counts.vertices);
  const auto triangles = payload.subspan(sizeof(counts) + 12 * counts.vertices);
  if (counts.vertices > 0) std::memcpy(static_cast<void*>(mesh.vertices.data()), vertices.data(), vertices.size());
  if (counts.triangles > 0) std::memcpy(mesh.triangles.data(), triangles.data(), triangles.size());
  for (const auto& v : mesh.vertices) {
    if (!v.allFinite()) throw bad("a vertex is nowhere");
  }
  for (const auto& t : mesh.triangles) {
    if (t[0] >= counts.vertices || t[1] >= counts.vertices || t[2] >= counts.vertices) {
      throw bad("a triangle names a vertex that is not there");
    }
  }
  return mesh;
}

}  // namespace tact
