#pragma once
#include <vector>

#include "mesh/mesh.hpp"

namespace tact::bench {

/// Points uniform by area on a surface, each moved at random by up to `reach_m` along each axis; seeded.
std::vector<Vec3> points_near(const Mesh& mesh, double reach_m, std::size_t count, unsigned seed);

}  // namespace tact::bench
