#pragma once
#include <cstddef>

#include "field/distance_field.hpp"

namespace tact {

/// Places in cells from the corner of the grid, (p_O - min_O) / h, as three arrays.
struct CellPlaces {
  const float *x, *y, *z;
  std::size_t size;  ///< a multiple of kPlacesAtOnce
};
inline constexpr std::size_t kPlacesAtOnce = 16;

/// Single precision is right to this, in cells.
inline constexpr float kClearanceSlack = 1e-4f;

/// What clearances() reads of a field, in cells. Valid as long as the field.
struct ClearanceView {
  /// @pre field not empty
  explicit ClearanceView(const DistanceField& field) noexcept;

  const CoarseEntry* coarse;
  const PartBound* parts;  ///< of the first block
  float cells[3];
  std::int32_t row, slice;  ///< strides of coarse entries
  float band, step, face_slack, far_slack;
};

/// What a traversal culls by: no sample is negative nearer to place i than clearance[i] - kClearanceSlack, in cells, as
/// DistanceField::probe promises it in metres, but of a stored block no corners are read: the bound of the values of a
/// part of it (PartBound) stands for the value. Where the surface is flat that is the same to rounding. Single
/// precision, so that twice as many fit a vector. How exactly the places are rounded is the caller's to know.
///
/// Who asks only whether the clearance is more than enough[i] says so: where the coarse entry alone promises it,
/// no more is looked at, and clearance[i] is that promise. Real-time.
/// @pre places finite and less than 1e9 cells away
void clearances(const ClearanceView& field, const CellPlaces& places, const float* enough, float* clearance) noexcept;

}  // namespace tact
