#pragma once
#include "shapes/solids.hpp"
#include "shapes/sweep.hpp"

namespace tact::shapes {

/// A body put together from closed solids that never overlap: what is fixed to each other stands `kSeam_mm` apart, far
/// less than a voxel. **Millimetres**, unlike everything else: the parts of a machine are read and written in them;
/// take() gives metres.
class Assembly {
 public:
  static constexpr double kSeam_mm = 0.1;

  /// `edge_mm`: length of a triangle's side on round parts.
  explicit Assembly(double edge_mm) : edge_(edge_mm) {}

  double edge() const { return edge_; }
  int sides(double radius) const;  ///< of a circle: 8 to 720

  void add(const Mesh& part, const Pose& X = {}) { append(mesh_, part, X); }

  /// Solid of revolution about the z axis of X; rounded at its corners.
  void turned(const Outline& profile, const Pose& X, double corner_radius = 0);

  /// Round bar with bevelled ends.
  void bar(const Vec3& from, const Vec3& to, double radius);

  /// Block between two opposite corners, its edges along `axis` (0, 1, 2) rounded, the others bevelled.
  void block(const Vec3& lowest, const Vec3& highest, int axis, double radius, double bevel);

  void pipe(const Path& corners, double bend_radius, double radius);
  /// A hose with ribs `rib` high every `pitch`.
  void bellows(const Path& corners, double bend_radius, double radius, double rib, double pitch);
  void cable(const Path& points, double radius);
  /// `count` cables of `radius` round each other along the points: one in the middle, then rings of six, twelve...
  void bundle(const Path& points, double radius, int count, double twist_per_mm);

  /// Head of a hexagon bolt with a washer, on the plane through `at` with the outward normal `out`; `size`: across the
  /// thread. With a stud, as high again above the hexagon, it is a nut.
  void bolt(const Vec3& at, const Vec3& out, double size, bool stud = false);

  /// Round connector on the plane through `at`, as a plug with a ribbed skirt.
  void plug(const Vec3& at, const Vec3& out, double radius, double height);

  Mesh take();

 private:
  double edge_;
  Mesh mesh_;
};

}  // namespace tact::shapes
