#include "contact/bake/worker/shell_bake.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "fault/fault.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

struct Baked {
  Pointshell shell;
  ShellReport report;
};

Baked bake(const Mesh& mesh, ShellOptions options) {
  Baked baked;
  baked.shell = bake_shell(clean_soup(mesh), options, {}, baked.report);
  return baked;
}

const Vec3 kLow(-0.01, -0.02, 0.005), kHigh(0.04, 0.01, 0.03);
Mesh block() { return test::box_mesh(kLow, kHigh); }
Mesh torus() { return test::torus_mesh(0.04, 0.015, 80, 48); }

Vec3 in_mesh_frame(const Pointshell& shell, std::size_t i) {
  return shell.X_TM.inverse() * Vec3(shell.position_T[i].cast<double>());
}

TEST(BakeShell, PointsLieOnTheSurfaceAndNormalsPointInward) {
  const Baked box = bake(block(), {2000, 7, 0});
  ASSERT_EQ(box.shell.size(), 2000u);
  for (std::size_t i = 0; i < box.shell.size(); ++i) {
    const Vec3 p = in_mesh_frame(box.shell, i), n = box.shell.normal_T[i].cast<double>();
    EXPECT_NEAR(test::box_distance(p, kLow, kHigh), 0, 1e-7);
    EXPECT_NEAR(n.norm(), 1, 1e-6);
    EXPECT_LT(test::box_distance(p + 1e-3 * n, kLow, kHigh), -0.5e-3);
  }
  const Baked ring = bake(torus(), {2000, 7, 0});
  for (std::size_t i = 0; i < ring.shell.size(); ++i) {
    const Vec3 p = in_mesh_frame(ring.shell, i), n = ring.shell.normal_T[i].cast<double>();
    EXPECT_LT(test::torus_distance(p + 1e-3 * n, 0.04, 0.015), -0.9e-3);
  }
}

TEST(BakeShell, NormalsAreInwardOnSpoiledSoup) {
  for (const Mesh& mesh : {test::flipped(torus(), 2), test::flipped(torus(), 1), test::unwelded(torus()),
                           test::unwelded(test::doubly_faced(torus()))}) {
    const Baked baked = bake(mesh, {1000, 7, 0});
    EXPECT_EQ(baked.report.samples_without_inside, 0u);
    EXPECT_EQ(baked.report.buried_samples, 0u);
    for (std::size_t i = 0; i < baked.shell.size(); ++i) {
      const Vec3 p = in_mesh_frame(baked.shell, i), n = baked.shell.normal_T[i].cast<double>();
      ASSERT_LT(test::torus_distance(p + 1e-3 * n, 0.04, 0.015), -0.9e-3);
    }
  }
}

TEST(BakeShell, SpheresBoundAllDescendantsTightly) {
  const Baked baked = bake(torus(), {3000, 7, 0});
  const Pointshell& s = baked.shell;
  std::vector<double> reach(s.size(), 0);
  // Bottom up: the set of descendants of each node, by brute force.
  std::vector<std::vector<std::uint32_t>> below(s.size());
  for (std::size_t i = s.size(); i-- > 0;) {
    for (std::uint32_t c = s.child_begin[i]; c < s.child_end[i]; ++c) {
      below[i].push_back(c);
      below[i].insert(below[i].end(), below[c].begin(), below[c].end());
    }
    for (const std::uint32_t d : below[i]) {
      reach[i] = std::max(reach[i], (s.position_T[d].cast<double>() - s.position_T[i].cast<double>()).norm());
    }
    EXPECT_GE(static_cast<double>(s.radius_m[i]), reach[i]);
    EXPECT_LE(static_cast<double>(s.radius_m[i]), reach[i] * (1 + 1e-5));
  }
  std::size_t all = s.level_begin[1];
  for (std::uint32_t i = 0; i < s.level_begin[1]; ++i) all += below[i].size();
  EXPECT_EQ(all, s.size());  // every point once
}

TEST(BakeShell, LevelsTileAndGrowByAConstantFactor) {
  const Baked baked = bake(block(), {5000, 7, 0});
  const Pointshell& s = baked.shell;
  ASSERT_EQ(s.level_begin.size(), 8u);
  EXPECT_EQ(s.level_begin.back(), s.size());
  std::uint32_t next = s.level_begin[1];
  for (std::size_t i = 0; i < s.size(); ++i) {
    EXPECT_EQ(s.child_begin[i], next);
    next = s.child_end[i];
  }
  EXPECT_EQ(next, s.size());
  for (std::size_t l = 1; l < 7; ++l) {
    const double factor = static_cast<double>(s.level_begin[l + 1]) / s.level_begin[l];
    EXPECT_NEAR(factor, std::pow(5000, 1.0 / 7), 0.5);
  }
}

TEST(BakeShell, EveryLevelIsSpreadOverTheBody) {
  const Baked baked = bake(torus(), {4000, 7, 0});
  const Pointshell& s = baked.shell;
  const double area = 4 * M_PI * M_PI * 0.04 * 0.015;
  for (std::size_t l = 3; l < 7; ++l) {  // of the first n points, none is much nearer another than ideal packing says
    const std::size_t n = s.level_begin[l + 1];
    const double ideal = packing_spacing(area, n);
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double nearest = 1;
      for (std::size_t j = 0; j < n; ++j) {
        if (j != i) nearest = std::min(nearest, static_cast<double>((s.position_T[i] - s.position_T[j]).norm()));
      }
      EXPECT_GT(nearest, 0.35 * ideal);
      mean += nearest / static_cast<double>(n);
    }
    EXPECT_GT(mean, 0.65 * ideal);  // 0.5 for points thrown at random
  }
}

TEST(BakeShell, NoPlaceIsFartherFromAPointThanReported) {
  const Baked baked = bake(block(), {3000, 7, 0});
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3 p = kLow + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(kHigh - kLow);
    const int axis = i % 3;
    p[axis] = i % 2 ? kLow[axis] : kHigh[axis];
    double nearest = 1;
    for (std::size_t k = 0; k < baked.shell.size(); ++k)
      nearest = std::min(nearest, (in_mesh_frame(baked.shell, k) - p).norm());
    worst = std::max(worst, nearest);
  }
  EXPECT_LT(worst, 1.1 * baked.report.largest_gap_m);
  EXPECT_LT(baked.report.largest_gap_m, 1.2 * baked.report.mean_spacing_m);
  EXPECT_EQ(baked.shell.spacing_m, baked.report.largest_gap_m);
}

TEST(BakeShell, EdgesAndCornersAreCovered) {
  const Baked baked = bake(block(), {2000, 7, 0});
  const double spacing = baked.report.mean_spacing_m;
  const auto nearest = [&](const Vec3& p) {
    double d = 1;
    for (std::size_t k = 0; k < baked.shell.size(); ++k) d = std::min(d, (in_mesh_frame(baked.shell, k) - p).norm());
    return d;
  };
  for (int i = 0; i < 8; ++i) {
    const Vec3 corner((i & 1) ? kHigh.x() : kLow.x(), (i & 2) ? kHigh.y() : kLow.y(), (i & 4) ? kHigh.z() : kLow.z());
    EXPECT_LT(nearest(corner), 1e-6);
  }
  for (double t = 0; t < 1; t += 0.01) {
    EXPECT_LT(nearest(kLow + t * Vec3(kHigh.x() - kLow.x(), 0, 0)), 0.6 * spacing);
  }
}

TEST(BakeShell, MassPropertiesAreThoseOfTheSolid) {
  const Baked box = bake(block(), {500, 7, 0});
  const Vec3 side = kHigh - kLow;
  EXPECT_NEAR((box.shell.X_TM.p + 0.5 * (kLow + kHigh)).norm(), 0, 2e-4);
  EXPECT_NEAR(box.report.volume_m3, side.prod(), 0.05 * side.prod());
  for (int i = 0; i < 3; ++i) {
    const double a = side[(i + 1) % 3], b = side[(i + 2) % 3];
    EXPECT_NEAR(box.shell.inertia_shape_m2(i, i), (a * a + b * b) / 12, 0.03 * (a * a + b * b) / 12);
  }
  const Baked ring = bake(torus(), {500, 7, 0});
  const double R = 0.04, r = 0.015;
  EXPECT_NEAR(ring.shell.inertia_shape_m2(2, 2), R * R + 0.75 * r * r, 0.02 * R * R);
  EXPECT_NEAR(ring.shell.inertia_shape_m2(0, 0), R * R / 2 + 0.625 * r * r, 0.02 * R * R);
  EXPECT_NEAR(ring.shell.gyration_radius_m, std::sqrt(ring.shell.inertia_shape_m2.trace() / 3), 1e-12);
}

TEST(BakeShell, AreasAddUpToTheSurface) {
  const Baked baked = bake(block(), {1000, 7, 0});
  const double sum = std::accumulate(baked.shell.area_m2.begin(), baked.shell.area_m2.end(), 0.0);
  const Vec3 s = kHigh - kLow;
  EXPECT_NEAR(sum, 2 * (s.x() * s.y() + s.y() * s.z() + s.z() * s.x()), 1e-6);
}

TEST(BakeShell, ThePartOfASolidInsideAnotherGetsNoPoints) {
  Mesh mesh = test::box_mesh(Vec3(0, 0, 0), Vec3(0.02, 0.02, 0.02));
  test::append(mesh, test::box_mesh(Vec3(0.02, 0, 0), Vec3(0.04, 0.02, 0.02)));  // touching: no wall between them
  const Baked baked = bake(mesh, {1500, 7, 0});
  for (std::size_t i = 0; i < baked.shell.size(); ++i) {
    EXPECT_NEAR(test::box_distance(in_mesh_frame(baked.shell, i), Vec3(0, 0, 0), Vec3(0.04, 0.02, 0.02)), 0, 1e-7);
  }
}

TEST(BakeShell, APlateHasPointsOnBothFaces) {
  Mesh sheet;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.05, 0, 0), Vec3(0.05, 0.03, 0), Vec3(0, 0.03, 0)}) test::add(sheet, p);
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const Baked baked = bake(sheet, {1000, 7, 0.002});
  int above = 0;
  for (std::size_t i = 0; i < baked.shell.size(); ++i) {
    const Vec3 p = in_mesh_frame(baked.shell, i);
    EXPECT_NEAR(std::fabs(p.z()), 0.001, 1e-7);
    EXPECT_LT(p.z() * static_cast<double>(baked.shell.normal_T[i].z()), 0);
    above += p.z() > 0 ? 1 : 0;
  }
  EXPECT_NEAR(above, 500, 60);
  EXPECT_NEAR(baked.report.area_m2, 2 * 0.05 * 0.03, 1e-9);
}

/// Thin parts get points on every side, at all counts: far thinner than the spacing.
TEST(BakeShell, AThinPlateHasBothItsFacesCovered) {
  const Vec3 low(0, 0, 0), high(0.05, 0.03, 1e-4);
  for (const int points : {100, 1000, 4000}) {
    const Baked baked = bake(test::box_mesh(low, high), {points, 7, 0});
    const double spacing = baked.report.mean_spacing_m;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(low.x(), high.x()), y(low.y(), high.y());
    double worst = 0;
    for (int i = 0; i < 1000; ++i) {  // of each face, to the nearest point that faces the same way
      const double inward = i % 2 ? -1 : 1;
      const Vec3 p(x(random), y(random), i % 2 ? high.z() : low.z());
      double nearest = 1;
      for (std::size_t k = 0; k < baked.shell.size(); ++k) {
        if (static_cast<double>(baked.shell.normal_T[k].z()) * inward < 0.3) continue;
        nearest = std::min(nearest, (in_mesh_frame(baked.shell, k) - p).norm());
      }
      worst = std::max(worst, nearest);
    }
    EXPECT_LT(worst, 1.3 * spacing) << points;
    EXPECT_LT(baked.report.largest_gap_m, 1.2 * spacing) << points;
  }
}

TEST(BakeShell, AWireIsCoveredAllRoundAtAllCounts) {
  const double radius = 1e-4, length = 0.02;
  Mesh mesh = test::box_mesh(Vec3(-0.05, -0.05, -0.05), Vec3(0.05, 0.05, -length));
  test::append(mesh, test::cylinder_mesh(radius, 0.6 * length, 48));  // 48 sides: no edge of it is sharp
  for (const int points : {100, 1000, 5000}) {
    const Baked baked = bake(mesh, {points, 7, 0});
    const double spacing = baked.report.mean_spacing_m;
    EXPECT_EQ(baked.shell.size(), static_cast<std::size_t>(points));
    // Along the wire, from each of four sides.
    for (const Vec3& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
      for (double z = -0.5 * length; z <= 0.6 * length; z += 0.05 * length) {
        double nearest = 1;
        for (std::size_t k = 0; k < baked.shell.size(); ++k) {
          const Vec3 p = in_mesh_frame(baked.shell, k);
          if (std::hypot(p.x(), p.y()) > 1.01 * radius) continue;
          if (baked.shell.normal_T[k].cast<double>().dot(side) > -0.3) continue;  // faces elsewhere
          nearest = std::min(nearest, std::fabs(p.z() - z));
        }
        EXPECT_LT(nearest, 1.5 * spacing) << points << " points, at " << z << " from " << side.transpose();
      }
    }
  }
}

TEST(BakeShell, ASpacingDecidesTheCount) {
  for (const double spacing : {1.5e-3, 3e-3}) {
    const Baked baked = bake(block(), {.points = 7, .spacing_m = spacing});
    EXPECT_NEAR(baked.report.mean_spacing_m, spacing, 0.01 * spacing);
    EXPECT_LT(baked.report.largest_gap_m, 1.2 * spacing);
  }
  EXPECT_EQ(bake(block(), {.spacing_m = 1}).shell.size(), 100u);
  EXPECT_THROW(bake(block(), {.spacing_m = 1e-6}), SetupError);
  // Only the outside counts: a box half in another needs as many points as their union.
  Mesh two = test::box_mesh(Vec3(0, 0, 0), Vec3(0.02, 0.02, 0.02));
  test::append(two, test::box_mesh(Vec3(0.01, 0.003, 0.003), Vec3(0.03, 0.017, 0.017)));
  const auto wanted = static_cast<double>(packing_count(6 * 0.02 * 0.02 + 4 * 0.01 * 0.014, 1e-3));
  EXPECT_NEAR(static_cast<double>(bake(two, {.spacing_m = 1e-3}).shell.size()), wanted, 0.02 * wanted);
}

TEST(BakeShell, FewPointsAndOneLevelWork) {
  EXPECT_EQ(bake(block(), {100, 7, 0}).shell.size(), 100u);
  const Baked flat = bake(block(), {300, 1, 0});
  EXPECT_EQ(flat.shell.level_begin.size(), 2u);
  EXPECT_EQ(flat.shell.radius_m.front(), 0);
}

}  // namespace
}  // namespace tact::contact
