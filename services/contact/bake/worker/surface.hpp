#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/bake/worker/triangle.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {

/// How a point was found to be inside or outside.
struct Vote {
  bool inside = false;
  bool close = false;  ///< 40 to 60 % of the rays said inside: hardly better than a coin
};

/// A triangle soup that answers distance and ray questions (Embree). Immutable; any thread. Coordinates in metres in
/// the mesh's frame; kept inside relative to the middle of the box, so that float32 rays lose nothing to a far origin.
class Surface {
 public:
  explicit Surface(const Mesh& mesh);

  bool empty() const { return triangles_.empty(); }
  const Vec3& middle() const { return middle_; }
  double size() const { return size_; }                                      ///< longest side of the box
  const Triangle& triangle(std::uint32_t i) const { return triangles_[i]; }  ///< relative to middle()

  /// Distance to the nearest triangle, `limit_m` when none is nearer. Infinite for an empty surface without limit.
  double distance(const Vec3& p, double limit_m) const;

  /// Replaces `found` by the triangles nearer than `reach_m` (and perhaps a few beyond). False, and `found` is of no
  /// use, when there are more than `most`.
  bool near(const Vec3& p, double reach_m, std::size_t most, std::vector<std::uint32_t>& found) const;

  /// Times a ray crosses the surface.
  unsigned crossings(const Vec3& p, const Vec3& direction) const;

  /// Vote by the parity of crossings: four rays when they agree, else eight when seven do, else 24, of which more than
  /// 60 % must say inside. Right for a soup of any orientation, and mostly for open ones; both sides of a lone sheet
  /// are outside. Coincident duplicates must have been removed.
  Vote vote(const Vec3& p) const;

 private:
  struct Scene;
  std::shared_ptr<const Scene> scene_;
  std::vector<Triangle> triangles_;
  Vec3 middle_ = Vec3::Zero();
  double size_ = 0;
};

}  // namespace tact::contact
