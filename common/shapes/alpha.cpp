#include "shapes/alpha.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tact::shapes {
namespace {

using Index = std::uint32_t;

// Intervals of the centre line: most where it bends. 2 (5 + 6 + 3 + 2) + 9 = 41.
constexpr int kLegOuter = 1, kLegInner = 4, kStrandInner = 4, kStrandOuter = 2, kSideBend = 3, kFlank = 2, kTip = 9;

/// Corners of half the centre line in the xy plane, y > 0.
struct Plan {
  Vec3 side_begin, side_centre, flank_begin, flank_end, tip_centre;
  double flank;   ///< length
  double length;  ///< from the crossing to the middle of the tip
};

Plan plan(const Alpha& alpha) {
  const double a = alpha.crossing_half_rad, g = alpha.tip_half_rad, side = alpha.side_radius_m,
               tip = alpha.tip_radius_m;
  Plan p;
  p.side_begin = alpha.strand_m * Vec3(std::cos(a), std::sin(a), 0);
  p.side_centre = p.side_begin + side * Vec3(std::sin(a), -std::cos(a), 0);
  p.flank_begin = p.side_centre + side * Vec3(std::sin(g), std::cos(g), 0);
  p.flank = (p.flank_begin.y() - tip * std::cos(g)) / std::sin(g);
  p.flank_end = p.flank_begin + p.flank * Vec3(std::cos(g), -std::sin(g), 0);
  p.tip_centre = {p.flank_end.x() - tip * std::sin(g), 0, 0};
  p.length = alpha.strand_m + side * (a + g) + p.flank + tip * (std::numbers::pi / 2 - g);
  return p;
}

/// Height of the centre line of the upper half, `s` along it from the crossing: h + pinch but for the dip at the
/// crossing, then down to 0 at the tip, smoothly at first and straight at the end.
double height(const Alpha& alpha, double s, double length) {
  const double top = alpha.h() + alpha.pinch_m;
  if (s <= alpha.pinch_length_m) {
    const double dip = (1 + std::cos(std::numbers::pi * std::min(std::abs(s) / alpha.pinch_length_m, 1.0))) / 2;
    return top - alpha.pinch_m * dip;
  }
  constexpr double kEase = 0.35;
  const double u = (s - alpha.pinch_length_m) / (length - alpha.pinch_length_m);
  const double fallen = u < kEase ? u * u / (2 * kEase) : u - kEase / 2;
  return top * (1 - fallen / (1 - kEase / 2));
}

/// Right-handed across: horizontal normal and the one nearest to z.
void frame(const Vec3& along, Vec3& across, Vec3& up) {
  across = Vec3::UnitZ().cross(along).normalized();
  up = along.cross(across);
}

}  // namespace

Vec3 Alpha::strand_direction() const { return {std::cos(crossing_half_rad), std::sin(crossing_half_rad), 0}; }

Vec3 Alpha::virtual_tip() const {
  const Vec3 end = plan(*this).flank_end;
  return {end.x() + end.y() / std::tan(tip_half_rad), 0, 0};
}

double Alpha::flank_m() const { return plan(*this).flank; }

std::vector<Vec3> Alpha::centre_line() const {
  const Plan p = plan(*this);
  const double a = crossing_half_rad, g = tip_half_rad;
  std::vector<Vec3> upper;  // from the leg's end to the last point before the middle of the tip
  const auto add = [&](const Vec3& xy, double s) { upper.emplace_back(xy.x(), xy.y(), height(*this, s, p.length)); };
  const auto add_straight = [&](double from, double to, int n) {
    for (int i = 0; i < n; ++i) {
      const double s = from + (to - from) * i / n;
      add(s * strand_direction(), s);
    }
  };
  add_straight(-leg_m, -pinch_length_m, kLegOuter);
  add_straight(-pinch_length_m, 0, kLegInner);
  add_straight(0, pinch_length_m, kStrandInner);
  add_straight(pinch_length_m, strand_m, kStrandOuter);
  for (int i = 0; i < kSideBend; ++i) {
    const double turned = (a + g) * i / kSideBend;
    add(p.side_centre + side_radius_m * Vec3(-std::sin(a - turned), std::cos(a - turned), 0),
        strand_m + side_radius_m * turned);
  }
  const double s_flank = strand_m + side_radius_m * (a + g);
  for (int i = 0; i < kFlank; ++i) {
    const double s = p.flank * i / kFlank;
    add(p.flank_begin + s * Vec3(std::cos(g), -std::sin(g), 0), s_flank + s);
  }
  // An odd number of intervals: the middle of the tip lies between two points.
  const double half_turn = std::numbers::pi / 2 - g;
  for (int i = 0; i <= kTip / 2; ++i) {
    const double turned = 2 * half_turn * i / kTip;
    add(p.tip_centre + tip_radius_m * Vec3(std::sin(g + turned), std::cos(g + turned), 0),
        s_flank + p.flank + tip_radius_m * turned);
  }
  std::vector<Vec3> line = upper;
  for (auto it = upper.rbegin(); it != upper.rend(); ++it) line.emplace_back(it->x(), -it->y(), -it->z());
  return line;
}

Mesh Alpha::mesh() const {
  const auto line = centre_line();
  const std::size_t rings = line.size();
  const auto n = static_cast<Index>(sides);
  Mesh mesh;
  const auto add = [&](const Vec3& p) { mesh.vertices.push_back(p.cast<float>()); };
  for (std::size_t i = 0; i < rings; ++i) {
    const Vec3 before = (line[i] - line[i == 0 ? 0 : i - 1]).normalized();
    const Vec3 after = (line[i + 1 == rings ? i : i + 1] - line[i]).normalized();
    const Vec3 along = (before + after).normalized();  // normalized() leaves the zero vector at the ends as it is
    Vec3 across, up;
    frame(along, across, up);
    // Mitre: the bend is in the xy plane but for the gentle rise, so the section is stretched across.
    const double stretch = i == 0 || i + 1 == rings ? 1 : 1 / along.dot(after);
    for (Index k = 0; k < n; ++k) {
      const double angle = 2 * std::numbers::pi * k / sides;
      add(line[i] + diameter_m / 2 * (stretch * std::cos(angle) * across + std::sin(angle) * up));
    }
  }
  for (Index ring = 0; ring + 1 < rings; ++ring) {
    for (Index k = 0; k < n; ++k) {
      const Index a = ring * n + k, b = ring * n + (k + 1) % n;
      mesh.triangles.push_back({a, b, b + n});
      mesh.triangles.push_back({a, b + n, a + n});
    }
  }
  const auto first = static_cast<Index>(mesh.vertices.size());
  add(line.front());
  add(line.back());
  const auto last_ring = static_cast<Index>(rings - 1) * n;
  for (Index k = 0; k < n; ++k) {
    mesh.triangles.push_back({first, (k + 1) % n, k});
    mesh.triangles.push_back({first + 1, last_ring + k, last_ring + (k + 1) % n});
  }
  return mesh;
}

}  // namespace tact::shapes
