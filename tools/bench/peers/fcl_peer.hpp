#pragma once
#include <cstddef>
#include <memory>

#include "mesh/mesh.hpp"

namespace tact::bench {

/// Two triangle meshes in the Flexible Collision Library: BVHModel<OBBRSS<double>>, as its users would.
class FclPair {
 public:
  FclPair(const Mesh& obstacle, const Mesh& tool);
  ~FclPair();

  /// fcl::collide at a pose of the tool's mesh frame in the obstacle's, contacts (points, normals) enabled. Returns
  /// the number of contacts, at most `most`.
  std::size_t collide(const Pose& X_OM, std::size_t most);

  static const char* version();

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

}  // namespace tact::bench
