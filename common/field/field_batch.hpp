#pragma once
#include "field/distance_field.hpp"

namespace tact {

/// What the batch kernels see of a field.
struct BatchView {
  const CoarseEntry* coarse;
  const FieldBlock* blocks;
  double min_O[3], cells[3];
  double voxel_m, inverse_voxel, band_m, scale_m, far_slack_m, inset, inset_slack_m, face_slack_m, farthest;
  std::int32_t row, slice;
};

/// Points are taken in chunks whose scratch stays in the first-level cache.
inline constexpr std::size_t kBatchChunk = 64;

}  // namespace tact
