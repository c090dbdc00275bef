#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Density of directions on one Gauss sphere, [P] eq. 6-7 summed over the points now in contact:
///   phi_i = sum_j hat(v_i, v_j),   hat(a, b) = max(1 - |a - b|^2 / eps^2, 0)
/// equal to the double sum up to rounding, in linear time however many directions are equal or nearly equal:
/// - directions are kept per point, in the tool's frame: distances between them never change for a rigid shell, so
///   classes of equal directions and the grid of cells (side eps / sqrt 3, diameter eps) are built once;
/// - within a cell, and between cells whose occupied boxes lie within eps of each other everywhere, hat is a quadratic
///   and the sum follows from moments (count, sum b, sum |b|^2);
/// - boxes at least eps apart contribute nothing; only pairs across a border are visited one by one, once per class.
/// Vectors need not have unit length, but |v| <= 1.
class DirectionDensity {
 public:
  DirectionDensity(std::span<const Vec3> direction_per_point, double epsilon);

  /// phi[i] += density at the direction of point ids[i], over all ids. Real-time.
  void add(std::span<const std::uint32_t> ids, std::span<double> phi) noexcept;

 private:
  struct Class {
    Vec3 v;
    std::uint32_t cell;
    std::uint32_t next = 0;
    std::uint64_t tick = 0;  // of its last use: nothing needs clearing
    double count = 0, phi = 0;
  };
  struct Cell {
    Vec3 centre;
    // Of the directions now in use; b = v - centre.
    Vec3 lo = Vec3::Zero(), hi = Vec3::Zero(), sum_b = Vec3::Zero();
    double count = 0, sum_b2 = 0;
    std::uint64_t tick = 0;
    std::uint32_t first = 0;  // list of classes in use
    std::uint32_t neighbour_begin = 0, neighbour_end = 0;
  };

  void collect(std::span<const std::uint32_t> ids) noexcept;
  void add_moments(Cell& from, Cell& to) noexcept;
  void add_pairs(Cell& a, Cell& b) noexcept;

  double inverse_eps2_, eps2_;
  std::vector<std::uint32_t> class_of_;
  std::vector<Class> classes_;
  std::vector<Cell> cells_;
  std::vector<std::uint32_t> neighbours_;  // cells of larger index that may lie within eps
  std::vector<std::uint32_t> used_;
  std::size_t used_count_ = 0;
  std::uint64_t tick_ = 0;
};

}  // namespace tact::contact
