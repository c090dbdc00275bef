#pragma once
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "field/field_blocks.hpp"
#include "math/pose.hpp"

namespace tact {

struct FieldParts;

/// Sparse narrow-band signed distance field of a body, in its own frame O: metres, negative inside.
///
/// Space is a grid of cubic cells of side h = voxel_m(); 8x8x8 cells form a block. Blocks that the band
/// |sdf| <= band_m() touches store their 9x9x9 corner values (16-bit, shared corners stored in both neighbours so that
/// one block answers a sample); every other block stores only a conservative bound of |sdf| and its sign.
/// Values between corners are trilinear; the gradient is that of the *interpolated* field, so it is exactly the
/// derivative of the value inside a cell, and not unit length.
///
/// Immutable. Samples do not allocate, lock or throw, and are safe from any thread; one costs some tens of ns. Points
/// that are not finite count as outside the grid.
class DistanceField {
 public:
  struct Sample {
    double value_m;            ///< interpolated; clamped to +-band_m() outside the band
    Eigen::Vector3d gradient;  ///< of the interpolated field, in O; zero outside the band
    bool in_band;              ///< value and gradient come from stored corners
    bool doubtful;             ///< the bake could not settle inside/outside in this block
  };

  /// What a hierarchy traversal asks of a node's centre.
  struct Probe {
    double value_m;      ///< as Sample
    double clearance_m;  ///< see probe()
  };

  DistanceField() = default;  ///< empty: a placeholder to assign to

  /// Maps the file (populated; locked when `lock`). Throws SetupError naming the file and the reason when it is
  /// missing, truncated, of another schema, damaged (checksum), or not `expected_hash` (0: any).
  static DistanceField open(const std::filesystem::path& path, std::uint64_t expected_hash = 0, bool lock = false);

  /// @pre not empty, as are all questions below.
  Sample sample(const Vec3& p_O) const noexcept;

  /// Conservative lower bound of the signed distance at p_O: never above the true distance, also far outside the
  /// grid; inside the body it is at most 0. Cheap: one coarse look-up. To cull a ball of radius R about p_O, use
  /// lower_bound(p_O) - R > (sqrt(3)/2) h: interpolated values are not distances.
  double lower_bound(const Vec3& p_O) const noexcept;

  /// value_m as Sample; clearance_m: no sample within this distance of p_O is negative, so a ball of radius
  /// R < clearance_m holds no contact. Holds for the field *as stored* (interpolation, rounding, dirty input with
  /// jumping signs included), so a traversal that culls by it finds exactly what brute force finds. Negative where
  /// nothing can be promised. One block look-up; sharper near the surface than lower_bound() (README).
  Probe probe(const Vec3& p_O) const noexcept;

  /// Points as three arrays.
  struct Points {
    const double *x_O, *y_O, *z_O;
    std::size_t size;
  };
  struct Samples {
    double *value_m, *gx, *gy, *gz;
    std::uint8_t* flags;  ///< kInBand, kDoubtful
  };
  static constexpr std::uint8_t kInBand = 1, kDoubtful = 2;

  /// Many points at once: for each, bit for bit what probe() and sample() answer. Several times faster: arithmetic with
  /// the widest SIMD the processor has, and the memory accesses of many points under way together.
  void probe(const Points& points, double* value_m, double* clearance_m) const noexcept;
  void sample(const Points& points, const Samples& samples) const noexcept;

  double voxel_m() const noexcept { return voxel_m_; }
  double band_m() const noexcept { return band_m_; }
  Vec3 min_O() const noexcept { return min_O_; }  ///< corners of the grid
  Vec3 max_O() const noexcept { return min_O_ + voxel_m_ * cells_; }
  std::uint64_t content_hash() const noexcept { return content_hash_; }  ///< of mesh, resolution, options, schema
  std::size_t bytes() const noexcept { return bytes_; }                  ///< mapped
  bool empty() const noexcept { return coarse_ == nullptr; }

 private:
  friend struct BatchAccess;
  friend DistanceField make_field(FieldParts parts, std::uint64_t content_hash);
  friend DistanceField view_field(const FieldParts& parts);
  struct Cell {
    const CoarseEntry* entry = nullptr;  ///< null: outside the grid
    Vec3 u;                              ///< grid coordinates, in cells
    int block[3] = {};                   ///< block indices
  };
  Cell find(const Vec3& p_O) const noexcept;
  Cell cell_at(const Vec3& u) const noexcept;  ///< @pre u inside the grid
  /// The eight corners of the cell holding c.u and the place in it.
  struct Corners {
    double v[8];  ///< x fastest, metres
    double f[3];  ///< in [0, 1]
  };
  Corners corners(const Cell& c) const noexcept;
  Probe probe_cell(const Cell& c) const noexcept;
  template <class Promise>
  double beyond(const Vec3& u, Promise promise) const noexcept;
  double outside_clearance(const Vec3& u) const noexcept;
  double lower_bound(const Cell& c) const noexcept;
  double boundary_bound(const Cell& c) const noexcept;
  void adopt(const FieldGrid& grid, const CoarseEntry* coarse, const FieldBlock* blocks) noexcept;

  /// Faces of blocks that a segment shorter than a block crosses at most: neighbours may round a shared corner
  /// differently, by one step.
  static constexpr double kFaces = 3;
  /// Points farther than this, in cells, count as not finite.
  static constexpr double kFarthest = 1e100;
  /// The nearest point of the grid to a point outside it is taken a hair inside, in cells, so that it has a cell.
  static constexpr double kInset = 1e-6, kInsetSlack = 1e-5;
  /// A zero of the interpolated field lies within sqrt(3) h of the body's boundary (README), plus rounding.
  static constexpr double kFarSlack = 1.74;

  const CoarseEntry* coarse_ = nullptr;
  const FieldBlock* blocks_ = nullptr;
  Vec3 min_O_ = Vec3::Zero(), cells_ = Vec3::Zero();
  double voxel_m_ = 0, inverse_voxel_ = 0, band_m_ = 0, scale_m_ = 0;
  std::size_t row_ = 0, slice_ = 0;  ///< coarse strides
  std::uint64_t content_hash_ = 0;
  std::size_t bytes_ = 0;
  std::shared_ptr<const void> owner_;
};

inline DistanceField::Cell DistanceField::find(const Vec3& p_O) const noexcept {
  Cell c;
  c.u = (p_O - min_O_) * inverse_voxel_;
  // Written so that NaN fails too.
  if (!(c.u.x() >= 0 && c.u.x() < cells_.x() && c.u.y() >= 0 && c.u.y() < cells_.y() && c.u.z() >= 0 &&
        c.u.z() < cells_.z())) {
    return c;
  }
  return cell_at(c.u);
}

inline DistanceField::Cell DistanceField::cell_at(const Vec3& u) const noexcept {
  Cell c;
  c.u = u;
  for (int i = 0; i < 3; ++i) c.block[i] = static_cast<int>(c.u[i]) / kBlockCells;
  c.entry = coarse_ + static_cast<std::size_t>(c.block[2]) * slice_ + static_cast<std::size_t>(c.block[1]) * row_ +
            static_cast<std::size_t>(c.block[0]);
  return c;
}

inline DistanceField::Corners DistanceField::corners(const Cell& c) const noexcept {
  Corners k;
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    const int whole = static_cast<int>(c.u[i]);
    cell[i] = whole - c.block[i] * kBlockCells;
    k.f[i] = c.u[i] - whole;
  }
  const std::int16_t* q = blocks_[c.entry->slot()].q.data() + FieldBlock::index(cell[0], cell[1], cell[2]);
  constexpr int dy = kBlockCorners, dz = kBlockCorners * kBlockCorners;
  const int at[8] = {0, 1, dy, dy + 1, dz, dz + 1, dz + dy, dz + dy + 1};
  for (int i = 0; i < 8; ++i) k.v[i] = scale_m_ * q[at[i]];
  return k;
}

/// No part of the body's boundary is nearer: see CoarseEntry::level.
inline double DistanceField::boundary_bound(const Cell& c) const noexcept {
  double v[3];  // from the block's centre, in cells
  for (int i = 0; i < 3; ++i) v[i] = c.u[i] - (c.block[i] + 0.5) * kBlockCells;
  const auto& tilt = c.entry->tilt;
  const double tilted = static_cast<double>(tilt[0].value()) * v[0] + static_cast<double>(tilt[1].value()) * v[1] +
                        static_cast<double>(tilt[2].value()) * v[2];
  const double square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + static_cast<double>(c.entry->level) + tilted;
  return voxel_m_ * std::sqrt(square > 0 ? square : 0);
}

inline DistanceField::Sample DistanceField::sample(const Vec3& p_O) const noexcept {
  const Cell c = find(p_O);
  if (c.entry == nullptr) return {band_m_, Vec3::Zero(), false, false};
  const bool doubtful = c.entry->doubtful();
  if (!c.entry->stored()) return {c.entry->inside() ? -band_m_ : band_m_, Vec3::Zero(), false, doubtful};
  const Corners k = corners(c);
  const double fx = k.f[0], fy = k.f[1], fz = k.f[2], ex = 1 - fx, ey = 1 - fy, ez = 1 - fz;
  const double x00 = k.v[0] * ex + k.v[1] * fx, x10 = k.v[2] * ex + k.v[3] * fx;
  const double x01 = k.v[4] * ex + k.v[5] * fx, x11 = k.v[6] * ex + k.v[7] * fx;
  const double y0 = x00 * ey + x10 * fy, y1 = x01 * ey + x11 * fy;
  const double value = y0 * ez + y1 * fz;
  if (!(std::fabs(value) <= band_m_)) return {value < 0 ? -band_m_ : band_m_, Vec3::Zero(), false, doubtful};
  const double gx =
      ((k.v[1] - k.v[0]) * ey + (k.v[3] - k.v[2]) * fy) * ez + ((k.v[5] - k.v[4]) * ey + (k.v[7] - k.v[6]) * fy) * fz;
  const double gy = (x10 - x00) * ez + (x11 - x01) * fz;
  return {value, inverse_voxel_ * Vec3(gx, gy, y1 - y0), true, doubtful};
}

inline DistanceField::Probe DistanceField::probe(const Vec3& p_O) const noexcept {
  const Cell c = find(p_O);
  if (c.entry == nullptr) return {band_m_, outside_clearance(c.u)};
  return probe_cell(c);
}

inline DistanceField::Probe DistanceField::probe_cell(const Cell& c) const noexcept {
  const double free = boundary_bound(c) - kFarSlack * voxel_m_;  // of a point where the field is positive
  if (!c.entry->stored()) {
    if (c.entry->inside()) return {-band_m_, -band_m_};
    return {band_m_, free};
  }
  const Corners k = corners(c);
  const double fx = k.f[0], fy = k.f[1], fz = k.f[2], ex = 1 - fx, ey = 1 - fy, ez = 1 - fz;
  const double value = ((k.v[0] * ex + k.v[1] * fx) * ey + (k.v[2] * ex + k.v[3] * fx) * fy) * ez +
                       ((k.v[4] * ex + k.v[5] * fx) * ey + (k.v[6] * ex + k.v[7] * fx) * fy) * fz;
  const double clamped = value < -band_m_ ? -band_m_ : value > band_m_ ? band_m_ : value;
  const double near = (value - kFaces * scale_m_) * static_cast<double>(c.entry->inverse_slope.value());
  return {clamped, value > 0 && free > near ? free : near};
}

}  // namespace tact
