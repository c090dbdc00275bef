#pragma once
#include <cstdint>
#include <vector>

#include "field/field_blocks.hpp"

namespace tact {

/// Exact Euclidean distance transform on the grid of blocks: from each block's centre to the nearest marked block's
/// centre, in blocks; infinite when none is marked. O(blocks).
std::vector<float> distance_between_blocks(const FieldGrid& grid, const std::vector<std::uint8_t>& marked);

}  // namespace tact
