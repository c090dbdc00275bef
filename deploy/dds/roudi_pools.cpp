// Writes roudi.toml: memory pools that fit the haptic messages, from their sizes.
#include <algorithm>
#include <cstddef>
#include <cstdio>

#include "haptic.h"

int main() {
  // In front of each sample Cyclone keeps its own header (writer, time, kind) in the chunk: below 256 bytes.
  constexpr std::size_t kHeader = 256;
  constexpr std::size_t kLargest = std::max(sizeof(tact_haptic_ToolPose), sizeof(tact_haptic_ContactWrench));
  constexpr std::size_t kChunk = (kLargest + kHeader + 63) / 64 * 64;
  // A live pair of endpoints holds about ten chunks, one abandoned after a crash as many: room for hundreds of both.
  constexpr std::size_t kCount = 4000;
  std::printf("# Generated from the sizes of the haptic messages (ToolPose %zu B, ContactWrench %zu B).\n",
              sizeof(tact_haptic_ToolPose), sizeof(tact_haptic_ContactWrench));
  std::printf("[general]\nversion = 1\n\n[[segment]]\n\n[[segment.mempool]]\nsize = %zu\ncount = %zu\n", kChunk,
              kCount);
}
