#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "contact/bake/worker/triangle.hpp"
#include "mesh/mesh.hpp"

namespace tact::contact {

/// A triangle that a ray meets.
struct Crossing {
  std::uint32_t triangle;
  bool against;  ///< the ray enters where the triangle faces
};

/// A triangle soup that answers distance and ray questions (Embree). Immutable, cheap to copy; any thread. Coordinates
/// in metres in the mesh's frame; kept inside relative to the middle of the box, so that float32 rays lose nothing to a
/// far origin.
class Surface {
 public:
  explicit Surface(const Mesh& mesh);

  bool empty() const { return scene_ == nullptr; }
  const Vec3& middle() const { return middle_; }
  double size() const { return size_; }  ///< longest side of the box
  std::uint32_t size_in_triangles() const { return empty() ? 0 : static_cast<std::uint32_t>(triangles_->size()); }
  /// In units of size(), so that single precision neither overflows nor underflows; relative to middle().
  struct Ball {
    float x, y, z, radius;
  };
  const Ball& ball(std::uint32_t i) const { return (*balls_)[i]; }
  const SmallTriangle& small(std::uint32_t i) const { return (*small_)[i]; }
  const Triangle& triangle(std::uint32_t i) const { return (*triangles_)[i]; }  ///< relative to middle()

  /// Distance to the nearest triangle, `limit_m` when none is nearer. Infinite for an empty surface without limit.
  double distance(const Vec3& p, double limit_m) const;

  /// Replaces `found` by the triangles nearer than `reach_m` (and perhaps a few beyond). False, and `found` is of no
  /// use, when there are more than `most`.
  bool near(const Vec3& p, double reach_m, std::size_t most, std::vector<std::uint32_t>& found) const;

  /// Appends every triangle that the ray from p meets within `reach_m`, in no order.
  void cross(const Vec3& p, const Vec3& direction, double reach_m, std::vector<Crossing>& found) const;

 private:
  struct Scene;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const std::vector<Triangle>> triangles_;
  std::shared_ptr<const std::vector<SmallTriangle>> small_;
  std::shared_ptr<const std::vector<Ball>> balls_;
  Vec3 middle_ = Vec3::Zero();
  double size_ = 0;
};

}  // namespace tact::contact
