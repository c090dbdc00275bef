#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "contact/bake/worker/surface.hpp"
#include "field/field_blocks.hpp"

namespace tact::contact {

/// Unsigned distances from the 729 corners of a block to a surface, exact but for rounding (1e-7 of a triangle's size,
/// and at most 1e-4 voxels). The block is halved in the manner of an octree: a cube of half diagonal r
/// whose centre is d from the surface needs only the triangles within d + 2 r of it. Balls round the triangles sort out
/// most of them, the exact distances of large ones the rest; at last all corners of a cube are held against each
/// triangle that is left. Where even that is many (a mesh much finer than the grid), each corner asks by itself. One
/// object per thread: it keeps its scratch.
class BlockDistances {
 public:
  BlockDistances(const Surface& surface, const FieldGrid& grid) : surface_(&surface), grid_(&grid) {}

  /// Writes min(distance, limit_m) for the block at (x, y, z), x fastest.
  void compute(int x, int y, int z, double limit_m, std::span<float, kBlockValues> out);

 private:
  struct Cube {
    int x, y, z, cells;
  };
  /// Triangles with their balls, one depth of halving.
  struct Candidates {
    std::vector<float> x, y, z, radius, low;
    std::vector<std::uint32_t> triangle;
    void resize(std::size_t n);
    void set(std::size_t i, const Surface::Ball& ball, std::uint32_t id);
  };
  template <class Visit>
  static void for_each_corner(const Cube& c, Visit&& visit);
  Cube part(const Cube& c, int k) const;
  Vec3 centre(const Cube& c) const;
  void search(const Cube& c);
  void refine(const Cube& c, int depth);
  void all_against_all(const Cube& c, const std::vector<std::uint32_t>& triangles);
  void each_corner(const Cube& c);

  const Surface* surface_;
  const FieldGrid* grid_;
  Vec3 origin_ = Vec3::Zero();  ///< the block's corner, relative to the surface's middle
  double limit_m_ = 0;
  std::span<float> out_;
  std::vector<std::uint32_t> near_;
  Candidates candidates_[5];  ///< by depth
  std::vector<float> x_, y_, z_, best_;
};

}  // namespace tact::contact
