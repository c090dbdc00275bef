#include "contact/bake/worker/field_bake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "math/exp_log.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

struct Baked {
  DistanceField field;
  FieldReport report;
  SoupReport soup;
};

Baked bake(const Mesh& mesh, int resolution, double sheet_thickness_m = 0) {
  Baked baked;
  const Soup soup = clean_soup(mesh);
  baked.soup = soup.report;
  baked.field = make_field(bake_field(soup, {resolution, 4, sheet_thickness_m}, {}, baked.report));
  return baked;
}

struct Errors {
  double value = 0, gradient = 0;
  int wrong_sign = 0, samples = 0;
};

template <class F>
Errors compare(const DistanceField& field, F&& distance, double within_voxels = 3.5) {
  const double h = field.voxel_m();
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  Errors errors;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 p =
        field.min_O() + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(field.max_O() - field.min_O());
    const double exact = distance(p);
    const auto s = field.sample(p);
    if (std::fabs(exact) > h && (exact < 0) != (s.value_m < 0)) ++errors.wrong_sign;
    if (std::fabs(exact) > within_voxels * h) continue;
    const double e = 1e-3 * h;
    Vec3 g;
    for (int k = 0; k < 3; ++k) {
      g[k] = (distance(p + e * Vec3::Unit(k)) - distance(p - e * Vec3::Unit(k))) / (2 * e);
    }
    errors.value = std::max(errors.value, std::fabs(s.value_m - exact) / h);
    errors.gradient = std::max(errors.gradient, (s.gradient - g).norm());
    ++errors.samples;
  }
  EXPECT_TRUE(within_voxels <= 0 || errors.samples > 1000);
  return errors;
}

const Vec3 kLow(-0.01, -0.02, 0.005), kHigh(0.04, 0.01, 0.03);
double box_m(const Vec3& p) { return test::box_distance(p, kLow, kHigh); }
double torus_m(const Vec3& p) { return test::torus_distance(p, 0.04, 0.015); }
double cylinder_m(const Vec3& p) { return test::cylinder_distance(p, 0.02, 0.03); }
Mesh fine_torus() { return test::torus_mesh(0.04, 0.015, 400, 200); }

TEST(BakeField, BoxIsRightToHalfAVoxelAtEdgesAndExactOnFaces) {
  const Baked baked = bake(test::box_mesh(kLow, kHigh), 64);
  const Errors errors = compare(baked.field, box_m);
  EXPECT_EQ(errors.wrong_sign, 0);
  EXPECT_LT(errors.value, 0.5);  // trilinear cells cut the edges and the medial planes inside
  EXPECT_EQ(baked.report.jumping_blocks, 0u);
  EXPECT_EQ(baked.report.signs.doubtful_blocks, 0u);
  EXPECT_NEAR(baked.field.sample(Vec3(0.0151, -0.0049, 0.0301)).value_m, 0.0001, 2e-7);
}

TEST(BakeField, TorusAndCylinderFollowTheirClosedForms) {
  const Baked torus = bake(fine_torus(), 64);
  const Errors a = compare(torus.field, torus_m);
  EXPECT_EQ(a.wrong_sign, 0);
  EXPECT_LT(a.value, 0.08);
  EXPECT_LT(a.gradient, 0.3);
  const Baked cylinder = bake(test::cylinder_mesh(0.02, 0.03, 720), 96);
  const Errors b = compare(cylinder.field, cylinder_m);
  EXPECT_EQ(b.wrong_sign, 0);
  EXPECT_LT(b.value, 0.5);
}

TEST(BakeField, ErrorFallsWithTheSquareOfTheVoxel) {
  const Mesh mesh = fine_torus();
  const Errors coarse = compare(bake(mesh, 32).field, torus_m, 2), fine = compare(bake(mesh, 64).field, torus_m, 2);
  // In voxels: a second-order error halves when the voxel does.
  EXPECT_GT(std::log2(coarse.value / fine.value), 0.7);
  EXPECT_GT(std::log2(coarse.gradient / fine.gradient), 0.7);
}

TEST(BakeField, ItsOwnErrorReportAgreesWithTheClosedForm) {
  const Baked baked = bake(test::box_mesh(kLow, kHigh), 64);
  const Errors errors = compare(baked.field, box_m, 4);
  EXPECT_GT(baked.report.quality.error_samples, 5000u);
  EXPECT_EQ(baked.report.quality.sign_mismatches, 0u);
  EXPECT_NEAR(baked.report.quality.error_largest_m / baked.field.voxel_m(), errors.value, 0.1);
  EXPECT_LT(baked.report.quality.error_rms_m, 0.1 * baked.field.voxel_m());
}

TEST(BakeField, SpoiledSoupGivesTheSameField) {
  const Mesh sound = test::torus_mesh(0.04, 0.015, 40, 24);
  const DistanceField wanted = bake(sound, 64).field;
  const Mesh spoiled[] = {test::unwelded(sound),   test::doubly_faced(sound), test::unwelded(test::doubly_faced(sound)),
                          test::flipped(sound, 2), test::flipped(sound, 1),   test::unwelded(test::flipped(sound, 3))};
  for (const Mesh& mesh : spoiled) {
    const Baked baked = bake(mesh, 64);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p =
          wanted.min_O() + Vec3(unit(random), unit(random), unit(random)).cwiseProduct(wanted.max_O() - wanted.min_O());
      ASSERT_NEAR(baked.field.sample(p).value_m, wanted.sample(p).value_m, 1e-3 * wanted.voxel_m());  // rounding
    }
  }
}

TEST(BakeField, OverlappingTouchingAndNestedSolids) {
  // Touching boxes are one body: no wall between them.
  Mesh touching = test::box_mesh(Vec3(0, 0, 0), Vec3(0.02, 0.02, 0.02));
  test::append(touching, test::box_mesh(Vec3(0.02, 0, 0), Vec3(0.04, 0.02, 0.02)));
  const auto long_box = [](const Vec3& p) { return test::box_distance(p, Vec3(0, 0, 0), Vec3(0.04, 0.02, 0.02)); };
  EXPECT_EQ(compare(bake(touching, 64).field, long_box).wrong_sign, 0);
  // A hollow sphere: the wall of the cavity faces the other way.
  const Mesh ball = test::sphere_mesh(Vec3::Zero(), 0.03, 40), core = test::sphere_mesh(Vec3::Zero(), 0.015, 30);
  Mesh hollow = ball;
  test::append(hollow, test::flipped(core, 1));
  const auto shell = [](const Vec3& p) { return std::max(p.norm() - 0.03, 0.015 - p.norm()); };
  const Baked cavity = bake(hollow, 64);
  EXPECT_EQ(compare(cavity.field, shell).wrong_sign, 0);
  EXPECT_EQ(cavity.report.solids.cavities, 1u);
  // The whole file inside out: the same body.
  const Baked inverted = bake(test::flipped(hollow, 1), 64);
  EXPECT_EQ(compare(inverted.field, shell).wrong_sign, 0);
  EXPECT_EQ(inverted.report.solids.inverted_parts, 1u);
  // Facing as the sphere does: a ball in a ball, of which nothing shows.
  Mesh swallowed = ball;
  test::append(swallowed, core);
  const Baked solid = bake(swallowed, 64);
  const Errors errors = compare(solid.field, [](const Vec3& p) { return p.norm() - 0.03; });
  EXPECT_EQ(errors.wrong_sign, 0);
  EXPECT_LT(errors.value, 0.1);
  EXPECT_EQ(solid.report.solids.swallowed_parts, 1u);
  // No orientation to trust: alternately solid and hollow, and said so.
  Mesh mixed = ball;
  test::append(mixed, test::flipped(core, 2));
  const Baked guessed = bake(mixed, 64);
  EXPECT_EQ(compare(guessed.field, shell).wrong_sign, 0);
  EXPECT_EQ(guessed.report.solids.guessed_cavities, 1u);
}

/// Walls inside the union are forgotten: distances are to its boundary alone.
TEST(BakeField, InterpenetratingSolidsAreTheirUnionWithExactDistances) {
  const Vec3 a_low(-0.03, -0.008, -0.006), a_high(0.03, 0.008, 0.006), b_low(-0.007, -0.03, -0.01),
      b_high(0.009, 0.03, 0.012);
  Mesh cross = test::box_mesh(a_low, a_high);
  test::append(cross, test::flipped(test::box_mesh(b_low, b_high), 1));  // one of them inside out
  const Baked baked = bake(cross, 96);
  EXPECT_EQ(baked.report.solids.overlaps, 1u);
  EXPECT_EQ(baked.report.solids.inverted_parts, 1u);
  EXPECT_EQ(baked.report.jumping_blocks, 0u);
  std::vector<Vec3> boundary;  // the union's, sampled: an independent distance inside
  const double step = 0.0002;
  const auto sample_box = [&](const Vec3& low, const Vec3& high, const Vec3& other_low, const Vec3& other_high) {
    for (int axis = 0; axis < 3; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const double side : {low[axis], high[axis]}) {
        for (double s = low[u]; s <= high[u] + 1e-9; s += step) {
          for (double t = low[v]; t <= high[v] + 1e-9; t += step) {
            Vec3 p;
            p[axis] = side;
            p[u] = s;
            p[v] = t;
            if (test::box_distance(p, other_low, other_high) > -1e-9) boundary.push_back(p);
          }
        }
      }
    }
  };
  sample_box(a_low, a_high, b_low, b_high);
  sample_box(b_low, b_high, a_low, a_high);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-0.014, 0.014);
  const double h = baked.field.voxel_m();
  int compared = 0;
  for (int i = 0; i < 1500; ++i) {
    const Vec3 p(unit(random), unit(random), unit(random));
    const double simple = std::min(test::box_distance(p, a_low, a_high), test::box_distance(p, b_low, b_high));
    const auto s = baked.field.sample(p);
    if (std::fabs(simple) > h) {
      EXPECT_EQ(simple < 0, s.value_m < 0) << p.transpose();
    }
    if (!s.in_band) continue;
    double exact = 1;
    for (const Vec3& q : boundary) exact = std::min(exact, (p - q).norm());
    EXPECT_NEAR(std::fabs(s.value_m), exact, 0.5 * h + step) << p.transpose();
    ++compared;
  }
  EXPECT_GT(compared, 500);
}

TEST(BakeField, ManyOverlappingSpheresAreTheirUnion) {
  Mesh mesh;
  std::vector<Vec3> centres;
  std::mt19937 random(12);
  std::uniform_real_distribution<double> unit(-0.02, 0.02);
  for (unsigned i = 0; i < 12; ++i) {
    centres.emplace_back(unit(random), unit(random), unit(random));
    const Mesh sphere = test::sphere_mesh(centres.back(), 0.012, 24);
    test::append(mesh, test::unwelded(test::flipped(sphere, i % 3 == 0 ? 1 : 2)));
  }
  const Baked baked = bake(mesh, 80);
  EXPECT_GT(baked.report.solids.overlaps, 10u);
  EXPECT_EQ(baked.report.jumping_blocks, 0u);
  EXPECT_EQ(baked.report.quality.sign_mismatches, 0u);
  const auto nearest = [&](const Vec3& p) {
    double d = 1;
    for (const Vec3& c : centres) d = std::min(d, (p - c).norm() - 0.012);
    return d;
  };
  EXPECT_EQ(compare(baked.field, nearest, 0).wrong_sign, 0);
}

TEST(BakeField, BoxesThatTouchWithoutCommonCornersHaveNoWallBetween) {
  const Vec3 low(0.011, 0.013, 0.01), high(0.027, 0.023, 0.03);
  Mesh mesh = test::box_mesh(Vec3(0, 0, 0), Vec3(0.04, 0.04, 0.01));
  test::append(mesh, test::box_mesh(low, high));
  const Baked baked = bake(mesh, 80);
  EXPECT_EQ(baked.report.jumping_blocks, 0u);
  const Vec3 wall(0.019, 0.018, 0.01);  // the middle of where they touch: 5 mm from the nearest free surface
  EXPECT_LT(baked.field.sample(wall).value_m, -3.9 * baked.field.voxel_m());
  const auto nearest = [&](const Vec3& p) {
    return std::min(test::box_distance(p, Vec3(0, 0, 0), Vec3(0.04, 0.04, 0.01)), test::box_distance(p, low, high));
  };
  EXPECT_EQ(compare(baked.field, nearest, 0).wrong_sign, 0);
}

TEST(BakeField, AnOpenEndIsClosedByTheVoteAndDeclared) {
  Mesh open = test::cylinder_mesh(0.02, 0.03, 90);
  std::erase_if(open.triangles, [](const auto& t) { return t[0] == 181; });  // the top
  const Baked baked = bake(open, 64);
  EXPECT_EQ(baked.soup.open_components, 1u);
  EXPECT_EQ(baked.soup.boundary_edges, 90u);
  EXPECT_GT(baked.report.signs.leaking, 0u);
  EXPECT_GT(baked.report.signs.doubtful_blocks, 0u);
  const double h = baked.field.voxel_m();
  // Away from the missing end the sign is right, and what is doubtful lies near that end.
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  int wrong = 0, wrong_and_unsaid = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 p =
        baked.field.min_O() +
        Vec3(unit(random), unit(random), unit(random)).cwiseProduct(baked.field.max_O() - baked.field.min_O());
    const double exact = test::cylinder_distance(p, 0.0199, 0.03);
    if (std::fabs(exact) < 2 * h) continue;
    const auto s = baked.field.sample(p);
    if ((exact < 0) == (s.value_m < 0)) continue;
    ++wrong;
    if (p.z() < 0.005) ++wrong_and_unsaid;
  }
  EXPECT_EQ(wrong_and_unsaid, 0);
  EXPECT_LT(wrong, 2500);
}

/// As exporters lose triangles: the body is what it was, and what is not sure is little.
TEST(BakeField, ABodyWithAFewOfItsTrianglesMissingStaysWhatItIs) {
  const Mesh ring = test::torus_mesh(0.04, 0.015, 60, 40);  // facets of three voxels
  for (const int k : {200, 50, 20}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Baked baked = bake(test::torn(ring, k, seed), 64);
      EXPECT_EQ(baked.report.jumping_blocks, 0u);
      EXPECT_LT(baked.report.signs.doubtful_blocks, baked.report.blocks_stored / 10);
      const Errors errors = compare(baked.field, torus_m);
      EXPECT_EQ(errors.wrong_sign, 0);
      EXPECT_LT(errors.value, 0.3);
    }
  }
}

/// The tip of a cone is gone: how far it went up nobody knows, and that is said.
TEST(BakeField, AHoleThatMayHaveBeenATipIsClosedAndDeclared) {
  Mesh cone = test::cylinder_mesh(0.02, 0.03, 90);
  for (std::size_t v = 1; v < 180; v += 2) {
    cone.vertices[v].head<2>() *= 0.2f;  // 20 mm wide below, 4 mm above
  }
  const Baked sound = bake(cone, 64);
  std::erase_if(cone.triangles, [](const auto& t) { return t[0] == 181; });  // the small end
  const Baked open = bake(cone, 64);
  EXPECT_EQ(open.soup.capped_holes, 1u);
  EXPECT_EQ(sound.report.signs.doubtful_blocks, 0u);
  EXPECT_GT(open.report.signs.doubtful_blocks, 0u);
  EXPECT_TRUE(open.field.sample(Vec3(0, 0, 0.0305)).doubtful);
  EXPECT_FALSE(open.field.sample(Vec3(0, 0, -0.02)).doubtful);
  EXPECT_EQ(compare(
                open.field, [&](const Vec3& p) { return sound.field.sample(p).value_m; }, 0)
                .wrong_sign,
            0);
}

/// Two spheres without their poles, so that neither is closed: what both hold is inside, and said to be doubtful, for
/// the inner of two nested surfaces may as well be a cavity.
TEST(BakeField, OpenBodiesThatOverlapAreTheirUnion) {
  const auto barrel = [](double x) {
    Mesh sphere = test::sphere_mesh(Vec3(x, 0, 0), 0.02, 24);
    std::erase_if(sphere.triangles, [&](const auto& t) {
      return std::any_of(t.begin(), t.end(), [&](auto v) { return std::fabs(sphere.vertices[v].z()) > 0.0165f; });
    });
    return sphere;
  };
  Mesh mesh = barrel(0);
  test::append(mesh, barrel(0.02));
  const Baked baked = bake(mesh, 96);
  EXPECT_EQ(baked.soup.open_components, 2u);
  const auto distance = [](const Vec3& p) { return std::min(p.norm(), (p - Vec3(0.02, 0, 0)).norm()) - 0.02; };
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  int both = 0, inside = 0, wrong = 0, unsaid = 0;
  for (int i = 0; i < 50000; ++i) {
    const Vec3 p =
        baked.field.min_O() +
        Vec3(unit(random), unit(random), unit(random)).cwiseProduct(baked.field.max_O() - baked.field.min_O());
    if (std::fabs(p.z()) > 0.012 || std::fabs(distance(p)) < 2 * baked.field.voxel_m()) continue;
    const auto s = baked.field.sample(p);
    const bool overlap = std::max(p.norm(), (p - Vec3(0.02, 0, 0)).norm()) < 0.02 - 2 * baked.field.voxel_m();
    both += overlap ? 1 : 0;
    inside += overlap && s.value_m < 0 ? 1 : 0;
    wrong += (distance(p) < 0) != (s.value_m < 0) && !s.doubtful ? 1 : 0;
    unsaid += overlap && !s.doubtful ? 1 : 0;
  }
  EXPECT_GT(both, 500);
  EXPECT_EQ(inside, both);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(unsaid, 0);
}

/// Where a side is missing a small body is of one piece with the air about it, which is farther from any surface: the
/// few corners inside must be asked all the same.
TEST(BakeField, SmallBodiesWithoutASideAreRightOrDeclared) {
  Mesh mesh = test::box_mesh(Vec3(-0.1, -0.1, -0.1), Vec3(-0.09, -0.09, 0.1));  // sets the scale: a voxel is 2 mm
  struct Box {
    Quat R;
    Vec3 centre, half;
  };
  std::vector<Box> boxes;
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 place(i % 6, i / 6 % 6, i / 36);
    Box box{exp_so3(2 * Vec3(unit(random), unit(random), unit(random))), -Vec3::Constant(0.07) + 0.03 * place,
            0.001 * (Vec3(3.5, 3.5, 3.5) + 1.5 * Vec3(unit(random), unit(random), unit(random)))};
    Mesh small = test::box_mesh(-box.half, box.half);
    small.triangles.resize(10);
    for (auto& v : small.vertices) v = (box.R * v.cast<double>() + box.centre).cast<float>();
    test::append(mesh, small);
    boxes.push_back(std::move(box));
  }
  const Baked baked = bake(mesh, 100);
  EXPECT_EQ(baked.soup.open_components, 200u);
  const double h = baked.field.voxel_m();
  int judged = 0, inside = 0, unsaid = 0;
  for (const Box& box : boxes) {
    for (int i = 0; i < 500; ++i) {
      const Vec3 q = (box.half.maxCoeff() + 0.002) * Vec3(unit(random), unit(random), unit(random));
      const double exact = test::box_distance(q, -box.half, box.half);
      const auto s = baked.field.sample(box.R * q + box.centre);
      if (std::fabs(exact) < 0.5 * h || std::fabs(s.value_m) < 0.5 * h) continue;
      ++judged;
      inside += exact < 0 ? 1 : 0;
      unsaid += (exact < 0) != (s.value_m < 0) && !s.doubtful ? 1 : 0;
    }
  }
  EXPECT_GT(judged, 20000);
  EXPECT_GT(inside, 3000);
  EXPECT_EQ(unsaid, 0);
}

TEST(BakeField, ASheetWithAThicknessIsAPlate) {
  Mesh sheet;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.05, 0, 0), Vec3(0.05, 0.03, 0), Vec3(0, 0.03, 0)}) test::add(sheet, p);
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  const double t = 0.003;
  const auto plate = [&](const Vec3& p) {
    return (p - p.cwiseMax(Vec3(0, 0, 0)).cwiseMin(Vec3(0.05, 0.03, 0))).norm() - t / 2;
  };
  const Baked baked = bake(sheet, 100, t);
  const Errors errors = compare(baked.field, plate);
  EXPECT_EQ(errors.wrong_sign, 0);
  EXPECT_LT(errors.value, 0.51);  // the middle plane is a ridge of the distance
  EXPECT_EQ(baked.report.quality.surface_without_inside, 0);
  // Without a thickness it has no inside, and the report says so.
  const Baked thin = bake(sheet, 100);
  EXPECT_GT(thin.report.quality.surface_without_inside, 0.9);
}

/// However coarse the grid and however small the thin part, it is the body that is measured.
TEST(BakeField, TheThinnestWallAndTheNarrowestGapAreThoseOfTheBody) {
  Mesh body = test::box_mesh(Vec3(0, 0, 0), Vec3(0.1, 0.1, 0.01));
  test::append(body, test::box_mesh(Vec3(0, 0, 0.0127), Vec3(0.1, 0.1, 0.03)));       // 2.7 mm above
  test::append(body, test::box_mesh(Vec3(0.15, 0.03, 0), Vec3(0.1504, 0.04, 0.01)));  // a lug of 0.4 mm
  for (const Mesh& mesh : {body, test::flipped(body, 3), test::unwelded(test::doubly_faced(body))}) {
    const FieldQuality q = bake(mesh, 24).report.quality;
    ASSERT_TRUE(q.thinnest_wall_m && q.narrowest_gap_m);
    EXPECT_NEAR(*q.thinnest_wall_m, 0.4e-3, 1e-8);
    EXPECT_NEAR(*q.narrowest_gap_m, 2.7e-3, 1e-8);
  }
  const FieldQuality ring = bake(fine_torus(), 48).report.quality;  // the tube, and the hole across
  EXPECT_NEAR(ring.thinnest_wall_m.value_or(0), 0.03, 2e-4);
  EXPECT_NEAR(ring.narrowest_gap_m.value_or(0), 0.05, 5e-4);
  // No two faces of a tetrahedron look at each other, and nothing is outside but it.
  Mesh tetra;
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(0.05, 0, 0), Vec3(0, 0.05, 0), Vec3(0, 0, 0.05)}) test::add(tetra, p);
  tetra.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const FieldQuality none = bake(tetra, 24).report.quality;
  EXPECT_FALSE(none.thinnest_wall_m || none.narrowest_gap_m);
  // Two sheets 4 mm apart, made 1 mm thick.
  Mesh sheets;
  for (const double z : {0.0, 0.004}) {
    Mesh sheet;
    for (const Vec3& p : {Vec3(0, 0, z), Vec3(0.05, 0, z), Vec3(0.05, 0.03, z), Vec3(0, 0.03, z)}) test::add(sheet, p);
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    test::append(sheets, sheet);
  }
  const FieldQuality plates = bake(sheets, 32, 0.001).report.quality;
  EXPECT_NEAR(plates.thinnest_wall_m.value_or(0), 1e-3, 1e-8);
  EXPECT_NEAR(plates.narrowest_gap_m.value_or(0), 3e-3, 1e-8);
}

TEST(BakeField, LowerBoundsAndClearancesHoldOnBakedFields) {
  Mesh open = test::cylinder_mesh(0.02, 0.03, 90);
  std::erase_if(open.triangles, [](const auto& t) { return t[0] == 181; });
  for (const Mesh& mesh : {test::torus_mesh(0.04, 0.015, 40, 24), open}) {
    const DistanceField field = bake(mesh, 48).field;
    const Surface surface(mesh);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(-0.5, 1.5);
    const auto point = [&] {
      return Vec3(field.min_O() +
                  Vec3(unit(random), unit(random), unit(random)).cwiseProduct(field.max_O() - field.min_O()));
    };
    std::vector<Vec3> negative;
    while (negative.size() < 2000) {
      const Vec3 p = point();
      if (field.sample(p).value_m < 0) negative.push_back(p);
    }
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = point();
      EXPECT_LE(field.lower_bound(p), surface.distance(p, 1));
      const double clearance = field.probe(p).clearance_m;
      for (const Vec3& q : negative) ASSERT_GE((p - q).norm(), clearance);
    }
  }
}

TEST(BakeField, NeighboursRoundACommonCornerAtMostOneStepApart) {
  const auto apart = [](const Mesh& mesh, int resolution, double sheet_thickness_m) {
    FieldReport report;
    const FieldParts parts = bake_field(clean_soup(mesh), {resolution, 4, sheet_thickness_m}, {}, report);
    EXPECT_EQ(report.jumping_blocks, 0u);
    const auto& n = parts.grid.blocks;
    int most = 0;
    for (int i = 0; i < n[0] * n[1] * n[2]; ++i) {
      const int x = i % n[0], y = i / n[0] % n[1], z = i / (n[0] * n[1]);
      const CoarseEntry& entry = parts.coarse[parts.grid.block_index(x, y, z)];
      if (x + 1 == n[0] || !entry.stored() || !parts.coarse[parts.grid.block_index(x + 1, y, z)].stored()) continue;
      const FieldBlock &a = parts.blocks[entry.slot()],
                       &b = parts.blocks[parts.coarse[parts.grid.block_index(x + 1, y, z)].slot()];
      for (int k = 0; k < kBlockCorners * kBlockCorners; ++k) {
        const int j = k % kBlockCorners, l = k / kBlockCorners;
        most = std::max(most, std::abs(a.q[static_cast<std::size_t>(FieldBlock::index(kBlockCells, j, l))] -
                                       b.q[static_cast<std::size_t>(FieldBlock::index(0, j, l))]));
      }
    }
    return most;
  };
  Mesh rod = test::box_mesh(Vec3(0, 0, 0), Vec3(0.5, 0.01, 0.013));  // its triangles are as long as the grid
  const Eigen::AngleAxisf R(0.3f, Eigen::Vector3f(1, 2, 3).normalized());
  for (auto& v : rod.vertices) v = R * v;
  for (const int cells : {96, 500}) EXPECT_LE(apart(rod, cells, 0), 1);
  EXPECT_LE(apart(fine_torus(), 128, 0), 1);
  rod.triangles.resize(2);
  EXPECT_LE(apart(rod, 200, 0.02), 1);  // a plate
}

TEST(BakeField, CancelsWhenAsked) {
  const Soup soup = clean_soup(fine_torus());
  FieldReport report;
  int calls = 0;
  EXPECT_THROW(bake_field(
                   soup, {128, 4, 0}, [&](const char*, double) { return ++calls < 5; }, report),
               Cancelled);
}

TEST(BakeField, ScaleAndPlaceDoNotMatter) {
  for (const double scale : {1e-5, 1e-3, 1.0, 1e3, 1e5}) {  // 1.1 um to 11 km
    Mesh mesh = test::torus_mesh(0.04, 0.015, 100, 60);
    for (auto& v : mesh.vertices) v = (v + Eigen::Vector3f(0.3f, -0.2f, 0.1f)) * static_cast<float>(scale);
    const Baked baked = bake(mesh, 48);
    const Errors errors =
        compare(baked.field, [&](const Vec3& p) { return scale * torus_m(p / scale - Vec3(0.3, -0.2, 0.1)); });
    EXPECT_EQ(errors.wrong_sign, 0);
    EXPECT_LT(errors.value, 0.2);
    EXPECT_EQ(baked.report.jumping_blocks, 0u);
  }
}

}  // namespace
}  // namespace tact::contact
