#include "field/distance_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "fault/fault.hpp"
#include "field/field_builder.hpp"
#include "field/field_clearance.hpp"

namespace tact {
namespace {

constexpr double kPi = 3.14159265358979323846;

double sphere(const Vec3& p) { return (p - Vec3(0.01, -0.02, 0.03)).norm() - 0.05; }

double box(const Vec3& p) {
  const Vec3 q = p.cwiseAbs() - Vec3(0.04, 0.03, 0.02);
  return q.cwiseMax(0).norm() + std::min(0.0, q.maxCoeff());
}

double torus(const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 0.04, p.z()) - 0.015; }

DistanceField sphere_field(double h) {
  return build_field(Vec3(-0.04, -0.07, -0.02), Vec3(0.06, 0.03, 0.08), h, sphere);
}
DistanceField box_field(double h) { return build_field(Vec3(-0.04, -0.03, -0.02), Vec3(0.04, 0.03, 0.02), h, box); }
DistanceField torus_field(double h) {
  return build_field(Vec3(-0.055, -0.055, -0.015), Vec3(0.055, 0.055, 0.015), h, torus);
}

Vec3 random_in(std::mt19937& random, const Vec3& lo, const Vec3& hi) {
  std::uniform_real_distribution<double> unit(0, 1);
  const Vec3 t(unit(random), unit(random), unit(random));
  return lo + t.cwiseProduct(hi - lo);
}

struct Errors {
  double value = 0, angle = 0;
  int samples = 0;
};

template <class F>
Errors errors_in_band(const DistanceField& field, F&& distance, double within_m) {
  std::mt19937 random(1);
  Errors worst;
  for (int i = 0; i < 200000; ++i) {
    const Vec3 p = random_in(random, field.min_O(), field.max_O());
    const double exact = distance(p);
    if (std::fabs(exact) > within_m) continue;
    const auto s = field.sample(p);
    EXPECT_TRUE(s.in_band);
    constexpr double e = 1e-7;
    const Vec3 g((distance(p + Vec3(e, 0, 0)) - distance(p - Vec3(e, 0, 0))) / (2 * e),
                 (distance(p + Vec3(0, e, 0)) - distance(p - Vec3(0, e, 0))) / (2 * e),
                 (distance(p + Vec3(0, 0, e)) - distance(p - Vec3(0, 0, e))) / (2 * e));
    worst.value = std::max(worst.value, std::fabs(s.value_m - exact));
    worst.angle = std::max(worst.angle, (s.gradient - g).norm());
    ++worst.samples;
  }
  return worst;
}

TEST(DistanceField, SphereErrorIsOfSecondOrderAndItsGradientOfFirst) {
  const Errors coarse = errors_in_band(sphere_field(0.002), sphere, 0.003);
  const Errors fine = errors_in_band(sphere_field(0.001), sphere, 0.003);
  ASSERT_GT(fine.samples, 1000);
  // Trilinear interpolation of |p| errs by at most 3 * h^2 / (8 (R - 0.003)): curvature 1/r in two directions.
  EXPECT_LT(coarse.value, 2.1 * 0.002 * 0.002 / (8 * 0.047) + 1e-6);
  EXPECT_GT(std::log2(coarse.value / fine.value), 1.6);  // rounding to 16 bits takes its part
  EXPECT_GT(std::log2(coarse.angle / fine.angle), 0.8);
}

TEST(DistanceField, TorusErrorIsOfSecondOrder) {
  const Errors coarse = errors_in_band(torus_field(0.002), torus, 0.003);
  const Errors fine = errors_in_band(torus_field(0.001), torus, 0.003);
  EXPECT_LT(coarse.value, 1e-4);
  EXPECT_GT(std::log2(coarse.value / fine.value), 1.6);
  EXPECT_GT(std::log2(coarse.angle / fine.angle), 0.8);
}

TEST(DistanceField, FlatFacesAreExactToRounding) {
  const DistanceField field = box_field(0.001);
  for (double x = -0.03; x < 0.03; x += 0.00037) {
    const auto s = field.sample(Vec3(x, 0.001, 0.0213));
    EXPECT_NEAR(s.value_m, 0.0013, 1e-7);
    EXPECT_NEAR((s.gradient - Vec3(0, 0, 1)).norm(), 0, 1e-3);
  }
}

TEST(DistanceField, GradientIsTheDerivativeOfTheValueInsideACell) {
  const double h = 0.002;
  const DistanceField field = torus_field(h);
  std::mt19937 random(2);
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = random_in(random, field.min_O(), field.max_O());
    const Vec3 u = (p - field.min_O()) / h;
    const double e = 1e-3;
    bool in_one_cell = true;
    for (int k = 0; k < 3; ++k) in_one_cell = in_one_cell && std::floor(u[k] - e) == std::floor(u[k] + e);
    const auto s = field.sample(p);
    if (!in_one_cell || !s.in_band || std::fabs(s.value_m) > 0.9 * field.band_m()) continue;
    for (int k = 0; k < 3; ++k) {
      const Vec3 step = e * h * Vec3::Unit(k);
      const double slope = (field.sample(p + step).value_m - field.sample(p - step).value_m) / (2 * e * h);
      EXPECT_NEAR(s.gradient[k], slope, 1e-9);
    }
    ++checked;
  }
  EXPECT_GT(checked, 1000);
}

TEST(DistanceField, ValuesAreContinuousAcrossCellsAndBlocks) {
  const DistanceField field = torus_field(0.002);
  const double e = 1e-9;
  double last = field.sample(field.min_O() + Vec3(e, 0.0551, 0.017)).value_m;
  const double step = 0.00001;
  for (double x = step; x < (field.max_O() - field.min_O()).x() - e; x += step) {
    const double value = field.sample(field.min_O() + Vec3(x, 0.0551, 0.017)).value_m;
    EXPECT_LE(std::fabs(value - last), 1.75 * step);
    last = value;
  }
}

TEST(DistanceField, DeepInsideIsClampedAndFlagged) {
  const DistanceField field = sphere_field(0.001);
  const auto s = field.sample(Vec3(0.01, -0.02, 0.03));
  EXPECT_EQ(s.value_m, -field.band_m());
  EXPECT_FALSE(s.in_band);
  EXPECT_EQ(s.gradient.norm(), 0);
  const auto far = field.sample(Vec3(10, 0, 0));
  EXPECT_EQ(far.value_m, field.band_m());
  EXPECT_FALSE(far.in_band);
}

TEST(DistanceField, InBandMeansWithinTheBand) {
  const DistanceField field = box_field(0.001);
  std::mt19937 random(3);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 p = random_in(random, field.min_O(), field.max_O());
    const auto s = field.sample(p);
    EXPECT_LE(std::fabs(s.value_m), field.band_m());
    const double exact = std::fabs(box(p));
    if (std::fabs(exact - field.band_m()) > field.voxel_m()) {
      EXPECT_EQ(s.in_band, exact < field.band_m());
    }
  }
}

TEST(DistanceField, LowerBoundIsNeverAboveTheDistance) {
  for (const auto& [field, distance] : {std::pair{sphere_field(0.002), &sphere}, std::pair{box_field(0.001), &box},
                                        std::pair{torus_field(0.0015), &torus}}) {
    std::mt19937 random(4);
    double slack = 0;
    for (int i = 0; i < 100000; ++i) {
      const double grow = i % 4 == 0 ? 50 : 1.2;
      const Vec3 centre = 0.5 * (field.min_O() + field.max_O()), half = 0.5 * (field.max_O() - field.min_O());
      const Vec3 p = random_in(random, centre - grow * half, centre + grow * half);
      const double exact = distance(p), bound = field.lower_bound(p);
      if (exact > 0) {
        EXPECT_LE(bound, exact);
      } else {
        EXPECT_LE(bound, 0);
      }
      const bool in_grid = (p - field.min_O()).minCoeff() > 0 && (field.max_O() - p).minCoeff() > 0;
      if (in_grid && exact > 0) slack = std::max(slack, exact - bound);
    }
    EXPECT_LT(slack, 14 * field.voxel_m());  // and it is of use: within twice half a block's diagonal
  }
}

/// Before a plane the bound of a block loses what |v|^2 differs between the block's corners and the point: at most 32
/// squared cells across the plane's normal. Tilts are stored with 8 bits.
TEST(DistanceField, FarFromAPlaneTheLowerBoundLosesLittle) {
  const double h = 0.002;
  const DistanceField field =
      build_field(Vec3::Constant(-0.1), Vec3::Constant(0.1), h, [](const Vec3& p) { return p.z() + 0.09; });
  std::mt19937 random(12);
  double least = 1e9;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = random_in(random, field.min_O(), field.max_O());
    const double d = (p.z() + 0.09) / h, bound = field.lower_bound(p) / h;
    if (d < 20) continue;
    EXPECT_LE(bound, d);
    EXPECT_GE(bound, std::sqrt(d * d - 32) - 0.1);
    least = std::min(least, d - bound);
  }
  EXPECT_LT(least, 0.1);
}

/// clearances() promises no more than probe(), and, far from the surface, no less but where less is enough.
void expect_single_precision_agrees(const DistanceField& field, const Vec3& p, double clearance_m, double enough_m) {
  const double h = field.voxel_m();
  constexpr std::size_t kCount = kPlacesAtOnce, kLast = kCount - 1;
  float u[3][kCount], enough[kCount], all[kCount], clear[kCount], clear_all[kCount];
  for (std::size_t k = 0; k < kCount; ++k) {
    for (int i = 0; i < 3; ++i) u[i][k] = static_cast<float>((p[i] - field.min_O()[i]) / h);
    enough[k] = static_cast<float>(enough_m / h);
    all[k] = std::numeric_limits<float>::infinity();
  }
  const ClearanceView view(field);
  clearances(view, {u[0], u[1], u[2], kCount}, enough, clear);
  clearances(view, {u[0], u[1], u[2], kCount}, all, clear_all);
  // The place is rounded too; where the promise jumps, at a block's border, it may belong to the neighbour.
  const Vec3 rounded = field.min_O() + h * Vec3(static_cast<double>(u[0][kLast]), static_cast<double>(u[1][kLast]),
                                                static_cast<double>(u[2][kLast]));
  const double expected = std::max(clearance_m, field.probe(rounded).clearance_m) / h;
  EXPECT_LE(static_cast<double>(clear_all[kLast] - kClearanceSlack), expected + 1e-6 * expected);
  EXPECT_LE(clear[kLast], clear_all[kLast]);
  if (clear[kLast] < clear_all[kLast]) {
    EXPECT_GT(clear[kLast], enough[kLast]);
  }
  const bool in_grid = (rounded - field.min_O()).minCoeff() > 0 && (field.max_O() - rounded).minCoeff() > 0;
  if (in_grid && std::fabs(clearance_m - field.probe(rounded).clearance_m) < 1e-4 * h &&
      clearance_m > 1.5 * field.band_m()) {
    EXPECT_GE(static_cast<double>(clear_all[kLast] + kClearanceSlack), expected - 1e-5 * std::fabs(expected) - 1e-4);
  }
}

/// Where the surface is flat the bound of a part of a block is the value itself, but for rounding. Near it: where a
/// part reaches beyond the range its corners are clamped.
TEST(DistanceField, ClearancesBeforeAPlaneAreThoseOfProbe) {
  const double h = 0.002;
  const Vec3 n = Vec3(0.1, -0.15, 1).normalized();
  const DistanceField field =
      build_field(Vec3::Constant(-0.05), Vec3::Constant(0.05), h, [&](const Vec3& p) { return n.dot(p); });
  const ClearanceView view(field);
  std::mt19937 rng(12);
  std::uniform_real_distribution<double> place(-0.04, 0.04), height(-0.8 * h, 0.8 * h);
  float u[3][kPlacesAtOnce], clear[kPlacesAtOnce];
  const std::vector<float> all(kPlacesAtOnce, std::numeric_limits<float>::infinity());
  for (int trial = 0; trial < 500; ++trial) {
    Vec3 p[kPlacesAtOnce];
    for (std::size_t k = 0; k < kPlacesAtOnce; ++k) {
      const Vec3 any(place(rng), place(rng), place(rng));
      p[k] = any + (height(rng) - n.dot(any)) * n;
      for (int i = 0; i < 3; ++i) u[i][k] = static_cast<float>((p[k][i] - field.min_O()[i]) / h);
    }
    clearances(view, {u[0], u[1], u[2], kPlacesAtOnce}, all.data(), clear);
    for (std::size_t k = 0; k < kPlacesAtOnce; ++k) {
      EXPECT_NEAR(static_cast<double>(clear[k]), field.probe(p[k]).clearance_m / h, 3e-3);
    }
  }
}

/// The promise a traversal relies on, against brute force: no negative sample within clearance of p.
void expect_clearance_holds(const DistanceField& field, int seed) {
  std::mt19937 random(static_cast<unsigned>(seed));
  std::vector<Vec3> negative;
  for (int i = 0; i < 300000 && negative.size() < 3000; ++i) {
    const Vec3 q = random_in(random, field.min_O(), field.max_O());
    if (field.sample(q).value_m < 0) negative.push_back(q);
  }
  ASSERT_GT(negative.size(), 100u);
  const Vec3 centre = 0.5 * (field.min_O() + field.max_O()), half = 0.5 * (field.max_O() - field.min_O());
  for (int i = 0; i < 3000; ++i) {
    const double grow = i % 4 == 0 ? 5 : 1;
    const Vec3 p = random_in(random, centre - grow * half, centre + grow * half);
    const auto probe = field.probe(p);
    EXPECT_EQ(probe.value_m, field.sample(p).value_m);
    expect_single_precision_agrees(field, p, probe.clearance_m, 0.002 * (i % 10));
    for (const Vec3& q : negative) ASSERT_GE((p - q).norm(), probe.clearance_m);
  }
}

TEST(DistanceField, ClearanceHoldsForSoundBodies) {
  expect_clearance_holds(sphere_field(0.002), 5);
  expect_clearance_holds(box_field(0.001), 6);
  expect_clearance_holds(torus_field(0.0015), 7);
}

TEST(DistanceField, ClearanceHoldsWhereTheSignJumps) {
  // A closed-looking sphere whose sign is wrong in a wedge, and a plane without thickness: what a bake of bad soup may
  // leave behind.
  const auto wedge = [](const Vec3& p) { return std::atan2(p.y(), p.x()) > 2 ? -std::fabs(sphere(p)) : sphere(p); };
  FieldParts parts = sample_distance(make_grid(Vec3(-0.04, -0.07, -0.02), Vec3(0.06, 0.03, 0.08), 0.002), wedge);
  const FieldTally tally = finish(parts);
  EXPECT_GT(tally.jumps, 0u);
  EXPECT_GE(tally.doubtful, tally.jumps);  // one side of a jump is wrong
  expect_clearance_holds(make_field(std::move(parts)), 8);
}

TEST(DistanceField, SoundBodiesHaveNoJumps) {
  FieldParts parts = sample_distance(make_grid(Vec3(-0.04, -0.03, -0.02), Vec3(0.04, 0.03, 0.02), 0.001), box);
  const FieldTally tally = finish(parts);
  EXPECT_EQ(tally.jumps, 0u);
  EXPECT_EQ(tally.doubtful, 0u);
  EXPECT_LT(tally.stored, parts.grid.block_count());
}

TEST(DistanceField, OneStepBetweenNeighboursIsRoundingAndTwoAreAJump) {
  const FieldParts sound = sample_distance(make_grid(Vec3(-0.04, -0.03, -0.02), Vec3(0.04, 0.03, 0.02), 0.001), box);
  for (const int steps : {1, 2}) {
    FieldParts parts = sound;
    for (FieldBlock& block : parts.blocks) {
      auto& q = block.q[static_cast<std::size_t>(FieldBlock::index(kBlockCells, 4, 4))];
      q = static_cast<std::int16_t>(q - steps);
    }
    EXPECT_EQ(finish(parts).jumps > 0, steps == 2);
    if (steps == 1) expect_clearance_holds(make_field(std::move(parts)), 10);
  }
}

TEST(DistanceField, BodiesCutByTheGridAreServed) {
  const auto half_space = [](const Vec3& p) { return p.z(); };
  const DistanceField field = build_field(Vec3(-0.05, -0.05, -0.02), Vec3(0.05, 0.05, 0.02), 0.002, half_space);
  EXPECT_NEAR(field.sample(Vec3(0.01, 0.02, -0.001)).value_m, -0.001, 1e-6);
  expect_clearance_holds(field, 9);
}

TEST(DistanceField, ManyPointsAtOnceGetTheSameBitsAsOneByOne) {
  std::mt19937 rng(11);
  std::uniform_real_distribution<double> place(-0.2, 0.2), near(-0.06, 0.06);
  // A sound body, and one whose sign jumps and is doubtful: stored, far, inside and outside the grid, not finite.
  const auto jumping = [](const Vec3& p) { return (p.x() > 0.013 ? -1 : 1) * std::fabs(p.norm() - 0.04); };
  const Vec3 box = Vec3::Constant(0.05);
  for (const DistanceField& field : {build_field(-box, box, 0.001, [](const Vec3& p) { return p.norm() - 0.04; }),
                                     build_field(-box, box, 0.0013, jumping, 3)}) {
    for (const std::size_t n : {0u, 1u, 7u, 8u, 63u, 64u, 65u, 130u, 2000u}) {
      std::vector<double> x(n), y(n), z(n), value(n), clearance(n), gx(n), gy(n), gz(n);
      std::vector<std::uint8_t> flags(n);
      for (std::size_t i = 0; i < n; ++i) {
        auto& any = i % 3 == 0 ? place : near;
        x[i] = any(rng), y[i] = any(rng), z[i] = any(rng);
        if (i % 50 == 10) y[i] = std::nan("");
        if (i % 50 == 20) z[i] = -HUGE_VAL;
        if (i % 50 == 30) x[i] = 1e300;
      }
      const DistanceField::Points points{x.data(), y.data(), z.data(), n};
      field.probe(points, value.data(), clearance.data());
      for (std::size_t i = 0; i < n; ++i) {
        const auto one = field.probe(Vec3(x[i], y[i], z[i]));
        ASSERT_EQ(value[i], one.value_m);
        ASSERT_EQ(clearance[i], one.clearance_m);
      }
      field.sample(points, {value.data(), gx.data(), gy.data(), gz.data(), flags.data()});
      for (std::size_t i = 0; i < n; ++i) {
        const auto one = field.sample(Vec3(x[i], y[i], z[i]));
        ASSERT_EQ(value[i], one.value_m);
        ASSERT_EQ(Vec3(gx[i], gy[i], gz[i]), one.gradient);
        ASSERT_EQ((flags[i] & DistanceField::kInBand) != 0, one.in_band);
        ASSERT_EQ((flags[i] & DistanceField::kDoubtful) != 0, one.doubtful);
      }
    }
  }
}

TEST(DistanceField, PointsThatAreNotFiniteAreOutside) {
  const DistanceField field = sphere_field(0.002);
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
    const Vec3 p(0, bad, 0);
    EXPECT_EQ(field.sample(p).value_m, field.band_m());
    EXPECT_FALSE(field.sample(p).in_band);
    EXPECT_LE(field.lower_bound(p), 0);
    EXPECT_LE(field.probe(p).clearance_m, 0);
  }
}

TEST(DistanceField, ImpossibleGridsAreRefused) {
  EXPECT_THROW(make_grid(Vec3(0, 0, 0), Vec3(1, 1, 1), 1e-5), SetupError);
  EXPECT_THROW(make_grid(Vec3(0, 0, 0), Vec3(1, std::nan(""), 1), 0.1), SetupError);
  EXPECT_THROW(make_grid(Vec3(0, 0, 0), Vec3(1, 1, 1), 0), SetupError);
}

TEST(DistanceField, VolumeOfNegativeSamplesIsThatOfTheSphere) {
  const DistanceField field = sphere_field(0.001);
  std::mt19937 random(10);
  const Vec3 lo(-0.04, -0.07, -0.02), hi(0.06, 0.03, 0.08);
  int inside = 0;
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) inside += field.sample(random_in(random, lo, hi)).value_m < 0 ? 1 : 0;
  EXPECT_NEAR(inside / double(kSamples), kPi / 6, 0.005);
}

}  // namespace
}  // namespace tact
