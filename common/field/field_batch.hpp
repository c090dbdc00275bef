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

/// What batch kernels may see.
struct BatchAccess {
  static BatchView view(const DistanceField& f) noexcept {
    return {f.coarse_,
            f.blocks_,
            {f.min_O_.x(), f.min_O_.y(), f.min_O_.z()},
            {f.cells_.x(), f.cells_.y(), f.cells_.z()},
            f.voxel_m_,
            f.inverse_voxel_,
            f.band_m_,
            f.scale_m_,
            DistanceField::kFarSlack * f.voxel_m_,
            DistanceField::kInset,
            DistanceField::kInsetSlack * f.voxel_m_,
            DistanceField::kFaces * f.scale_m_,
            DistanceField::kFarthest,
            static_cast<std::int32_t>(f.row_),
            static_cast<std::int32_t>(f.slice_)};
  }
};

/// Points are taken in chunks whose scratch stays in the first-level cache.
inline constexpr std::size_t kBatchChunk = 64;

}  // namespace tact
