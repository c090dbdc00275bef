#include "shapes/solids.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "common/shapes/closed_surface.hpp"
#include "shapes/sweep.hpp"

namespace tact::shapes {
namespace {

double area(const Outline& outline) {
  double twice = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vec2 &p = outline[i], &q = outline[(i + 1) % outline.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

double circle_area(double radius, int sides) {
  return sides * radius * radius / 2 * std::sin(2 * std::numbers::pi / sides);
}

/// Area of the triangles; each must be turned anticlockwise.
double covered(const Outline& outline, const std::vector<Outline>& holes) {
  Outline all = outline;
  for (const Outline& hole : holes) all.insert(all.end(), hole.begin(), hole.end());
  double sum = 0;
  for (const auto& t : triangulate(outline, holes)) {
    const double one = area({all[t[0]], all[t[1]], all[t[2]]});
    EXPECT_GT(one, 0);
    sum += one;
  }
  return sum;
}

TEST(Outline, TrianglesCoverTheOutlineButNotItsHoles) {
  const Outline teeth = gear(40, 0.9, 1);
  EXPECT_NEAR(covered(teeth, {}), area(teeth), 1e-12);
  std::vector<Outline> holes;  // a regular pattern: corners one behind the other
  double open = 0;
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 4; ++j) {
      holes.push_back(circle(0.3, 12, {i + 0.5, j + 0.5}));
      open += circle_area(0.3, 12);
    }
  }
  EXPECT_NEAR(covered(rectangle({0, 0}, {5, 4}), holes), 20 - open, 1e-12);
  const Outline hook{{0, 0}, {4, 0}, {4, 4}, {1, 4}, {1, 3}, {3, 3}, {3, 1}, {0, 1}};
  EXPECT_NEAR(covered(hook, {circle(0.3, 9, {3.5, 2}), circle(0.2, 7, {1, 0.5})}),
              9 - circle_area(0.3, 9) - circle_area(0.2, 7), 1e-12);
}

TEST(Outline, RoundedCornersKeepTheSidesAndLoseTheCornersArea) {
  const Outline square = rounded(rectangle({0, 0}, {2, 2}), 0.5, 0.001);
  EXPECT_NEAR(area(square), 4 - (4 - std::numbers::pi) * 0.25, 1e-6);
  const Outline hook =
      rounded({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 0.2, 0.001);  // one corner the other way
  EXPECT_NEAR(area(hook), 3 - 4 * (1 - std::numbers::pi / 4) * 0.04, 1e-6);
}

TEST(Outline, LinkIsTheConvexHullOfItsCircles) {
  const double r = 0.5, d = 2;
  EXPECT_NEAR(area(link({0, 0}, r, {d, 0}, r, 0.001)), std::numbers::pi * r * r + 2 * r * d, 1e-5);
  EXPECT_EQ(convex_hull({{0, 0}, {1, 0}, {0.5, 0.2}, {1, 1}, {0, 1}, {0.5, 0}}).size(), 4u);
}

TEST(Solid, PlateLatheAndLoftAreClosedAndHaveTheirVolume) {
  const Mesh washer = plate(circle(2, 40), {circle(1, 30), circle(0.2, 8, {1.5, 0})}, -1, 2);
  expect_closed(washer, "plate");
  EXPECT_NEAR(volume(washer), 3 * (circle_area(2, 40) - circle_area(1, 30) - circle_area(0.2, 8)), 1e-5);

  const double round = circle_area(1, 48);  // of a unit circle's polygon
  const Mesh full = lathe({{0, 0}, {2, 0}, {1, 3}, {0, 3}}, 48);
  expect_closed(full, "lathe");
  EXPECT_NEAR(volume(full), round * 3 * (4 + 2 + 1) / 3., 1e-5);  // frustum
  const Mesh ring = lathe({{1, 0}, {1, 1}, {2, 1}, {2, 0}}, 48);  // the other way round
  expect_closed(ring, "ring");
  EXPECT_NEAR(volume(ring), round * 3, 1e-5);

  const Mesh block = bevelled(rectangle({-2, -1}, {2, 1}), 3, 0.25);
  expect_closed(block, "bevelled");
  const auto slice = [](double in) { return (4 - 2 * in) * (2 - 2 * in); };
  EXPECT_NEAR(volume(block), 2.5 * 8 + 2 * 0.25 / 6 * (slice(0) + 4 * slice(0.125) + slice(0.25)), 1e-5);
}

TEST(Solid, TubeHasTheVolumeOfItsSectionAlongItsMiddle) {
  const Path corner = pipe_path({{0, 0, 0}, {10, 0, 0}, {10, 10, 4}}, 3, 0.1);
  const Mesh pipe = tube(corner, 0.5, 24);
  expect_closed(pipe, "tube");
  EXPECT_NEAR(volume(pipe), circle_area(0.5, 24) * length(corner), 0.01);  // Pappus
}

TEST(Path, PipeIsStraightButForItsBend) {
  const double bend = 3, quarter = std::numbers::pi / 2;
  const Path path = pipe_path({{0, 0, 0}, {10, 0, 0}, {10, 10, 0}}, bend, 0.05);
  EXPECT_NEAR(length(path), 20 - 2 * bend + quarter * bend, 0.01);
  for (const Vec3& p : path) {
    if (p.x() < 7) {
      EXPECT_NEAR(p.y(), 0, 1e-9);
    } else if (p.y() > 3) {
      EXPECT_NEAR(p.x(), 10, 1e-9);
    } else {
      EXPECT_NEAR((p - Vec3(7, 3, 0)).norm(), bend, 0.01);
    }
  }
}

TEST(Path, CableGoesThroughItsPointsAndStrandsKeepTheirDistance) {
  const Path points{{0, 0, 0}, {1, 0.5, 0}, {2, 0, 1}, {3, 0, 0}};
  const Path cable = cable_path(points, 0.01);
  for (const Vec3& p : points) {
    double nearest = 1;
    for (const Vec3& q : cable) nearest = std::min(nearest, (p - q).norm());
    EXPECT_LT(nearest, 0.006);
  }
  const Path beside = strand(cable, 0.1, 0.7, 2);
  ASSERT_EQ(beside.size(), cable.size());
  for (std::size_t i = 0; i < cable.size(); ++i) EXPECT_NEAR((beside[i] - cable[i]).norm(), 0.1, 1e-12);
}

}  // namespace
}  // namespace tact::shapes
