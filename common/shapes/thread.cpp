#include "shapes/thread.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tact::shapes {
namespace {

using Index = std::uint32_t;
using Ring = std::vector<Index>;

constexpr double kCrest = 1.0 / 16,
                 kRoot = 3.0 / 8;  // in pitches from the crest's middle to where its flats end, begin
constexpr std::array kCorners{-kRoot, -kCrest, kCrest, kRoot};
constexpr double kFlank_rad = std::numbers::pi / 6;

class Builder {
 public:
  explicit Builder(int sides) : sides_(sides) {}

  /// The helical surface between two planes across z, outward to larger r, and the rings it ends in.
  ///
  /// Columns of corners stand at `sides` angles; corner m of a column is corner m + 4 of the one a turn before. What
  /// lies beyond an end shrinks into the corner where the column meets that end.
  std::array<Ring, 2> thread(const Thread& thread, double height, bool outward) {
    const int turns = static_cast<int>(std::ceil(height / thread.pitch_m)) + 4;
    const double least = 1e-3 * thread.pitch_m;  // no triangle is lower
    const auto level = [&](int column, int corner) {
      const auto of_profile = static_cast<std::size_t>(corner % 4);
      const int turn = corner / 4 - 2;
      return thread.pitch_m * (static_cast<double>(column) / sides_ + turn + kCorners[of_profile]);
    };
    std::array<Ring, 2> ends;
    std::vector<Ring> columns(static_cast<std::size_t>(sides_));
    for (int j = 0; j < sides_; ++j) {
      const auto at = [&](double z) { return add(polar(j, thread.radius(angle(j), z), z)); };
      ends[0].push_back(at(0));
      ends[1].push_back(at(height));
      for (int m = 0; m < 4 * (turns + 1); ++m) {
        const double z = level(j, m);
        columns[static_cast<std::size_t>(j)].push_back(z < least            ? ends[0].back()
                                                       : z > height - least ? ends[1].back()
                                                                            : at(z));
      }
    }
    const auto corner = [&](int j, int m) {
      return j < sides_ ? columns[static_cast<std::size_t>(j)][static_cast<std::size_t>(m)]
                        : columns[0][static_cast<std::size_t>(m) + 4];
    };
    for (int j = 0; j < sides_; ++j) {
      for (int m = 0; m + 1 < 4 * turns; ++m) {
        quad(corner(j, m), corner(j + 1, m), corner(j + 1, m + 1), corner(j, m + 1), outward);
      }
    }
    return ends;
  }

  Ring hexagon(double width, double z) {
    Ring ring;
    for (int j = 0; j < sides_; ++j) {
      const double from_flat = std::remainder(angle(j), std::numbers::pi / 3);
      ring.push_back(add(polar(j, width / 2 / std::cos(from_flat), z)));
    }
    return ring;
  }

  /// A band from one ring to the next, its outside to the right of that way seen along the rings.
  void band(const Ring& from, const Ring& to) {
    for (std::size_t j = 0; j < from.size(); ++j) {
      const std::size_t next = (j + 1) % from.size();
      quad(from[j], from[next], to[next], to[j], true);
    }
  }

  void disc(const Ring& ring, double z, bool up) {
    const Index middle = add(Vec3(0, 0, z));
    for (std::size_t j = 0; j < ring.size(); ++j) triangle(middle, ring[j], ring[(j + 1) % ring.size()], up);
  }

  Mesh take() { return std::move(mesh_); }

 private:
  double angle(int column) const { return 2 * std::numbers::pi * column / sides_; }
  Vec3 polar(int column, double r, double z) const {
    return {r * std::cos(angle(column)), r * std::sin(angle(column)), z};
  }
  Index add(const Vec3& p) {
    mesh_.vertices.push_back(p.cast<float>());
    return static_cast<Index>(mesh_.vertices.size() - 1);
  }
  void triangle(Index a, Index b, Index c, bool forward) {
    if (a == b || b == c || c == a) return;
    mesh_.triangles.push_back(forward ? std::array{a, b, c} : std::array{a, c, b});
  }
  void quad(Index a, Index b, Index c, Index d, bool forward) {
    triangle(a, b, c, forward);
    triangle(a, c, d, forward);
  }

  int sides_;
  Mesh mesh_;
};

}  // namespace

double Thread::root_m() const { return crest_m() - 1.25 * std::numbers::sqrt3 / 2 * pitch_m; }

double Thread::radius(double angle_rad, double z_m) const {
  const double turns = z_m / pitch_m - angle_rad / (2 * std::numbers::pi);
  const double from_crest = std::fabs(turns - std::round(turns));
  const double down = std::clamp((from_crest - kCrest) / (kRoot - kCrest), 0.0, 1.0);
  return (crest_m() - down * (crest_m() - root_m())) / 2;
}

double Thread::section_m2() const {
  // Every height has all phases of the profile once round: pi times the mean of r^2 over a pitch.
  const double a = crest_m() / 2, b = root_m() / 2;
  return std::numbers::pi *
         (a * a * 2 * kCrest + b * b * (1 - 2 * kRoot) + (a * a + a * b + b * b) / 3 * 2 * (kRoot - kCrest));
}

double Thread::axial_play_m() const { return allowance_m * std::tan(kFlank_rad); }

Mesh bolt(const Thread& thread, double length, double head_width, double head_height, int sides) {
  Builder build(sides);
  const auto [tip, neck] = build.thread(thread, length, true);
  const Ring below = build.hexagon(head_width, length), above = build.hexagon(head_width, length + head_height);
  build.disc(tip, 0, false);
  build.band(neck, below);
  build.band(below, above);
  build.disc(above, length + head_height, true);
  return build.take();
}

Mesh nut(const Thread& thread, double width, double height, int sides) {
  Builder build(sides);
  const auto [low, high] = build.thread(thread, height, false);
  const Ring below = build.hexagon(width, 0), above = build.hexagon(width, height);
  build.band(low, below);
  build.band(below, above);
  build.band(above, high);
  return build.take();
}

}  // namespace tact::shapes
