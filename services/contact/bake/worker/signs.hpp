#pragma once
#include <cstdint>
#include <vector>

#include "contact/bake/worker/inside.hpp"
#include "contact/bake/worker/progress.hpp"
#include "field/field_builder.hpp"

namespace tact::contact {

struct SignReport {
  std::size_t components = 0;     ///< regions that no surface separates
  std::size_t leaking = 0;        ///< of those, regions that are neither all inside nor all outside: open mesh
  std::size_t voted_corners = 0;  ///< corners too near the surface to belong to a region
  std::size_t close_votes = 0;    ///< Vote::close
  std::size_t doubtful_blocks = 0;
};

/// Gives signs to a field of unsigned distances (README, "Sign").
///
/// Two corners with |d_a| + |d_b| > |a - b| have no surface between them, so they share a sign; so do the corners and
/// neighbours of a block far from the surface. Such corners form regions. Every block votes on its part of each region
/// (Inside::vote at the corner farthest from the surface); a region whose parts agree takes their sign. A region whose
/// parts disagree leaks through a hole of the mesh: there each part votes for itself, and each corner in blocks on the
/// hole's `rim` (by block index), where a thin part of the body is of one piece with the air. Blocks that disagree
/// within are marked doubtful. Corners in no region vote for themselves.
SignReport settle_signs(FieldParts& parts, const Inside& inside, const std::vector<std::uint8_t>& rim,
                        const StageProgress& progress);

}  // namespace tact::contact
