#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/bake/worker/surface.hpp"
#include "field/field_blocks.hpp"

namespace tact::contact {

/// Exact unsigned distances from the 729 corners of a block to a surface. The block is halved in the manner of an
/// octree: a cube of half diagonal r whose centre is d from the surface needs only the triangles within d + 2 r of it.
/// Few triangles: all corners of the cube against each of them. Many (a mesh finer than the grid): halve, and at last
/// ask for each corner by itself. One object per thread: it keeps its scratch.
class BlockDistances {
 public:
  BlockDistances(const Surface& surface, const FieldGrid& grid) : surface_(&surface), grid_(&grid) {}

  /// Writes min(distance, limit_m) for the block at (x, y, z), x fastest.
  void compute(int x, int y, int z, double limit_m, std::span<float, kBlockValues> out);

 private:
  struct Cube {
    int x, y, z, cells;
  };
  template <class Visit>
  static void for_each_corner(const Cube& c, Visit&& visit);
  Cube part(const Cube& c, int k) const;
  Vec3 centre(const Cube& c) const;
  void search(const Cube& c);
  void refine(const Cube& c, const std::vector<std::uint32_t>& candidates, int depth);
  void each_corner(const Cube& c);

  const Surface* surface_;
  const FieldGrid* grid_;
  Vec3 origin_ = Vec3::Zero();  ///< the block's corner, relative to the surface's middle
  double limit_m_ = 0;
  std::span<float> out_;
  std::vector<std::uint32_t> near_[5];  ///< by depth
  std::vector<double> square_;          ///< of the candidates at one depth
  std::vector<double> x_, y_, z_, best_;
};

}  // namespace tact::contact
