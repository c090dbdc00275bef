#pragma once
#include <cstdint>
#include <vector>

#include "contact/bake/worker/surface.hpp"

namespace tact::contact {

/// How a point was found to be inside or outside.
struct Vote {
  bool inside = false;
  bool close = false;  ///< 40 to 60 % of the rays said inside: hardly better than a coin
  bool sure = false;   ///< all agreed, and none met a triangle outside the closed parts
  /// An open component by itself holds the point, all open ones together do not: they overlap, or one is a cavity.
  bool disputed = false;
};

/// Tells inside from outside by rays. Immutable, cheap to copy; any thread.
///
/// A ray tells, for each closed part, how often the part winds round its origin: not zero is inside that part. The rest
/// of the soup (part 0) is one body whose inside is where the number of crossings is odd, and each of its connected
/// components is one too: surfaces in pieces close a volume together, torn solids that overlap do alone. A point is
/// inside when more solids than cavities hold it, so solids that interpenetrate are their union.
class Inside {
 public:
  /// `part` names each triangle's part, 0 the rest, and `component` its component there; `role` is by part, +1 for a
  /// solid and -1 for a cavity.
  Inside(Surface surface, std::vector<std::uint32_t> part, std::vector<std::uint32_t> component,
         std::vector<std::int8_t> role);

  /// Four rays when they agree, else eight when seven do, else 24, of which more than 60 % must say inside: both sides
  /// of a lone sheet, which gets exactly half, are outside. Coincident duplicates must have been removed.
  Vote vote(const Vec3& p) const;

  /// All 24 rays, and close already from 25 to 75 %: for places where the mesh is known to leak, where the few rays of
  /// vote() may all leave through the same hole.
  Vote careful_vote(const Vec3& p) const;

  /// The parts that p is inside, by the majority of twelve rays; sorted. Costs what the rays meet, however many parts.
  std::vector<std::uint32_t> parts_around(const Vec3& p) const;

  const Surface& surface() const { return surface_; }
  std::uint32_t part(std::uint32_t triangle) const { return (*part_)[triangle]; }

 private:
  struct Answer {
    bool inside, by_closed_parts;
    std::size_t open;  ///< components of the rest that the ray meets an odd number of times
  };
  /// Appends those components to `odd`.
  Answer ask_ray(const Vec3& p, const Vec3& direction, std::vector<std::uint32_t>& odd) const;
  /// Of all rays, `in` of which said inside.
  Vote count(int in, std::vector<std::uint32_t>& odd, double close_from) const;

  Surface surface_;
  std::shared_ptr<const std::vector<std::uint32_t>> part_, component_;
  std::vector<std::int8_t> role_;
};

}  // namespace tact::contact
