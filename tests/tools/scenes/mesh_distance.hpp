#pragma once
#include "mesh/mesh.hpp"

namespace tact {

/// Exact distances between triangle meshes by brute force with a bound on spheres: an oracle, slow and simple.
struct PlacedMesh {
  PlacedMesh(const Mesh& mesh, const Pose& X_W);

  struct Triangle {
    Vec3 corner[3];
    Vec3 centre;
    double radius;
  };
  std::vector<Triangle> triangles;
};

double distance(const Vec3& p, const PlacedMesh::Triangle& t);
double distance(const PlacedMesh::Triangle& a, const PlacedMesh::Triangle& b);  ///< of triangles that do not cross
double distance(const Vec3& p, const PlacedMesh& mesh);
/// Of surfaces that do not cross; at most `cap`, beyond which it does not look.
double distance(const PlacedMesh& a, const PlacedMesh& b, double cap);

/// Solid angle of the mesh seen from p over 4 pi: 1 inside a closed outward surface, 0 outside.
double winding_number(const Vec3& p, const PlacedMesh& mesh);

}  // namespace tact
