#include "shapes/outline.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace tact::shapes {
namespace {

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Corners on the arc about `centre` from `from` to `to` (angles, either way), ends included.
void add_arc(Outline& out, const Vec2& centre, double radius, double from, double to, double edge) {
  const int n = std::max(1, static_cast<int>(std::ceil(radius * std::abs(to - from) / edge)));
  for (int i = 0; i <= n; ++i) {
    const double angle = from + (to - from) * i / n;
    out.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
}

/// Cuts ears off a polygon whose corners may lie on each other where a hole is bridged to its surroundings.
class EarClipper {
 public:
  EarClipper(const Outline& outline, const std::vector<Outline>& holes) {
    for (const Vec2& p : outline) add_point(p);
    for (std::uint32_t i = 0; i < outline.size(); ++i) loop_.push_back(i);
    struct Hole {
      std::vector<std::uint32_t> loop;  // clockwise, from its rightmost corner on
      double right;
    };
    std::vector<Hole> rest;
    for (const Outline& hole : holes) {
      const auto begin = static_cast<std::uint32_t>(point_.size());
      for (const Vec2& p : hole) add_point(p);
      Hole h;
      for (auto i = static_cast<std::uint32_t>(point_.size()); i-- > begin;) h.loop.push_back(i);
      const auto right = std::max_element(h.loop.begin(), h.loop.end(), [&](std::uint32_t a, std::uint32_t b) {
        return point_[a].x() < point_[b].x();
      });
      std::rotate(h.loop.begin(), right, h.loop.end());
      h.right = point_[h.loop.front()].x();
      rest.push_back(std::move(h));
    }
    std::sort(rest.begin(), rest.end(), [](const Hole& a, const Hole& b) { return a.right > b.right; });
    for (const Hole& hole : rest) bridge(hole.loop);
  }

  std::vector<std::array<std::uint32_t, 3>> run() {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::size_t i = 0, tried = 0;
    while (loop_.size() > 3) {
      const std::size_t n = loop_.size();
      i %= n;
      // After a whole round without an ear only rounding is in the way: take what turns left.
      if (is_ear(i, tried > n)) {
        triangles.push_back({loop_[(i + n - 1) % n], loop_[i], loop_[(i + 1) % n]});
        loop_.erase(loop_.begin() + static_cast<std::ptrdiff_t>(i));
        tried = 0;
        ++i;  // not the same fan again: rounder triangles
      } else {
        if (++tried > 2 * n + 2) break;
        ++i;
      }
    }
    if (loop_.size() == 3) triangles.push_back({loop_[0], loop_[1], loop_[2]});
    return triangles;
  }

 private:
  /// Turned by an odd angle, so that bridges along x do not run through the corners of regular patterns.
  void add_point(const Vec2& p) {
    point_.emplace_back(std::cos(0.37) * p.x() - std::sin(0.37) * p.y(),
                        std::sin(0.37) * p.x() + std::cos(0.37) * p.y());
  }

  static bool holds(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& p) {
    return cross(b - a, p - a) >= 0 && cross(c - b, p - b) >= 0 && cross(a - c, p - c) >= 0;
  }

  bool is_ear(std::size_t i, bool lenient) const {
    const std::size_t n = loop_.size();
    const Vec2 &a = point_[loop_[(i + n - 1) % n]], &b = point_[loop_[i]], &c = point_[loop_[(i + 1) % n]];
    const double turn = cross(b - a, c - b);
    if (!(turn > (lenient ? 0 : 1e-9 * (b - a).norm() * (c - b).norm()))) return false;
    if (lenient) return true;
    for (const std::uint32_t k : loop_) {
      const Vec2& p = point_[k];
      if (p != a && p != b && p != c && holds(a, b, c, p)) return false;
    }
    return true;
  }

  /// Joins a hole to the loop by a cut from its rightmost corner to one that it sees.
  void bridge(const std::vector<std::uint32_t>& hole) {
    const Vec2 m = point_[hole.front()];
    double reach = std::numeric_limits<double>::infinity();
    std::size_t best = 0;
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const Vec2 &a = point_[loop_[i]], &b = point_[loop_[(i + 1) % loop_.size()]];
      if ((a.y() > m.y()) == (b.y() > m.y())) continue;
      const double x = a.x() + (m.y() - a.y()) * (b.x() - a.x()) / (b.y() - a.y());
      if (x >= m.x() && x - m.x() < reach) {
        reach = x - m.x();
        best = a.x() > b.x() ? i : (i + 1) % loop_.size();
      }
    }
    // What lies between the cut and the edge it runs to would be cut through: take the nearest in angle instead.
    const Vec2 hit(m.x() + reach, m.y());
    const Vec2 far = point_[loop_[best]];
    double flattest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const Vec2& p = point_[loop_[i]];
      const bool within = p == far || (far.y() > m.y() ? holds(m, hit, far, p) : holds(m, far, hit, p));
      if (!within || p.x() <= m.x()) continue;
      const double slope = std::abs(p.y() - m.y()) / (p.x() - m.x());
      if (slope < flattest - 1e-12 || (p == far && slope <= flattest && sees(i, m) && !sees(best, m))) {
        flattest = slope;
        best = i;
      }
    }
    // Corners that lie on each other: the one whose inside the cut begins in.
    for (std::size_t i = 0; i < loop_.size() && !sees(best, m); ++i) {
      if (point_[loop_[i]] == point_[loop_[best]] && sees(i, m)) best = i;
    }
    std::vector<std::uint32_t> cut(hole);
    cut.push_back(hole.front());
    cut.push_back(loop_[best]);
    loop_.insert(loop_.begin() + static_cast<std::ptrdiff_t>(best) + 1, cut.begin(), cut.end());
  }

  /// p lies in the inner angle at corner i of the loop.
  bool sees(std::size_t i, const Vec2& p) const {
    const std::size_t n = loop_.size();
    const Vec2 &a = point_[loop_[(i + n - 1) % n]], &b = point_[loop_[i]], &c = point_[loop_[(i + 1) % n]];
    const bool left_of_in = cross(b - a, p - b) > 0, left_of_out = cross(c - b, p - b) > 0;
    return cross(b - a, c - b) > 0 ? left_of_in && left_of_out : left_of_in || left_of_out;
  }

  std::vector<Vec2> point_;
  std::vector<std::uint32_t> loop_;
};

}  // namespace

Outline circle(double radius, int sides, const Vec2& centre) {
  Outline out;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * std::numbers::pi * i / sides;
    out.emplace_back(centre + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return out;
}

Outline rectangle(const Vec2& lowest, const Vec2& highest) {
  return {lowest, {highest.x(), lowest.y()}, highest, {lowest.x(), highest.y()}};
}

namespace {

template <class Stays>
Outline round_corners(const Outline& corners, double radius, double edge, const Stays& stays) {
  Outline out;
  const std::size_t n = corners.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 before = corners[i] - corners[(i + n - 1) % n], after = corners[(i + 1) % n] - corners[i];
    const Vec2 in = before.normalized(), to = after.normalized();
    const double turn = std::atan2(cross(in, to), in.dot(to)), half_tan = std::tan(std::abs(turn) / 2);
    const double r = std::min(radius, 0.499 * std::min(before.norm(), after.norm()) / half_tan);
    if (stays(corners[i]) || std::abs(turn) < 1e-6) {
      out.push_back(corners[i]);
      continue;
    }
    const double side = turn > 0 ? 1 : -1;
    const Vec2 centre = corners[i] - r * half_tan * in + side * r * Vec2(-in.y(), in.x());
    const double from = std::atan2(-side * in.x(), side * in.y());
    add_arc(out, centre, r, from, from + turn, edge);
  }
  return out;
}

}  // namespace

Outline rounded(const Outline& corners, double radius, double edge) {
  return round_corners(corners, radius, edge, [](const Vec2&) { return false; });
}

Outline rounded_profile(const Outline& corners, double radius, double edge) {
  return round_corners(corners, radius, edge, [](const Vec2& p) { return p.x() == 0; });
}

Outline convex_hull(Outline points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  Outline hull;
  const auto add_chain = [&hull](auto begin, auto end) {
    const std::size_t kept = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= kept + 2 && cross(hull.back() - hull[hull.size() - 2], *p - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();  // the next chain begins with it
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  return hull;
}

Outline link(const Vec2& a, double radius_a, const Vec2& b, double radius_b, double edge) {
  const auto sides = [edge](double radius) {
    return std::max(16, static_cast<int>(std::ceil(2 * std::numbers::pi * radius / edge)));
  };
  Outline points = circle(radius_a, sides(radius_a), a);
  const Outline others = circle(radius_b, sides(radius_b), b);
  points.insert(points.end(), others.begin(), others.end());
  return convex_hull(std::move(points));
}

Outline gear(int teeth, double root_radius, double tip_radius) {
  Outline out;
  for (int i = 0; i < teeth; ++i) {
    const double pitch = 2 * std::numbers::pi / teeth;
    for (const auto& [at, tip] : {std::pair{-0.34, false}, {-0.16, true}, {0.16, true}, {0.34, false}}) {
      const double angle = pitch * (i + at);
      out.emplace_back((tip ? tip_radius : root_radius) * Vec2(std::cos(angle), std::sin(angle)));
    }
  }
  return out;
}

std::vector<std::array<std::uint32_t, 3>> triangulate(const Outline& outline, const std::vector<Outline>& holes) {
  return EarClipper(outline, holes).run();
}

}  // namespace tact::shapes
