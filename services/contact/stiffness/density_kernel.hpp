#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/pose.hpp"

namespace tact::contact {

/// Classes of directions in use, those of a cell side by side. Arrays reach kDensityPad beyond the last class.
struct DensityClasses {
  std::vector<double> x, y, z, count, phi;
};
inline constexpr std::size_t kDensityPad = 8;

/// A cell in use: its classes are [begin, end).
struct DensityCell {
  Vec3 centre, lo, hi, sum_b;  // b = v - centre
  double count, sum_b2;
  std::uint32_t index, begin, end;
};

/// Cells of larger index that may lie within eps of cell i of the shell: cell[begin[i], begin[i + 1]).
struct DensityNeighbours {
  std::vector<std::uint32_t> begin, cell;
};

/// phi of every class += sum of hat over the classes of all cells, [P] eq. 6-7; see DirectionDensity. `used_cell`: of
/// the shell's cells, where in `cells` it is; of no meaning when that is another's. The widest SIMD the processor has
/// is chosen at run time. Real-time: does not allocate, lock or throw.
void sum_density(const DensityCell* cells, std::size_t cell_count, const DensityNeighbours& neighbours,
                 const std::uint32_t* used_cell, double eps2, DensityClasses& classes) noexcept;

}  // namespace tact::contact
