#pragma once
#include <cstddef>

#include "field/distance_field.hpp"

namespace tact {

/// Places in cells from the corner of the grid, (p_O - min_O) / h, as three arrays.
struct CellPlaces {
  const float *x, *y, *z;
  std::size_t size;  ///< a multiple of 8
};

/// Single precision is right to this, in cells.
inline constexpr float kClearanceSlack = 1e-4f;

/// What a traversal culls by: no sample is negative nearer to place i than clearance[i] - kClearanceSlack, in cells, as
/// DistanceField::probe promises it in metres; single precision, so that twice as many fit a vector. How exactly the
/// places are rounded is the caller's to know.
///
/// Who asks only whether the clearance is more than enough[i] says so: where the coarse entry alone promises it,
/// corners are not read, and clearance[i] is that promise. Real-time.
/// @pre field not empty; places finite and less than 1e9 cells away
void clearances(const DistanceField& field, const CellPlaces& places, const float* enough, float* clearance) noexcept;

}  // namespace tact
