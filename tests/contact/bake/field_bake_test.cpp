#include "contact/bake/worker/field_bake.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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
  EXPECT_GT(errors.samples, 1000);
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
  EXPECT_GT(baked.report.error_samples, 5000u);
  EXPECT_EQ(baked.report.sign_mismatches, 0u);
  EXPECT_NEAR(baked.report.error_largest_m / baked.field.voxel_m(), errors.value, 0.1);
  EXPECT_LT(baked.report.error_rms_m, 0.1 * baked.field.voxel_m());
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
      ASSERT_EQ(baked.field.sample(p).value_m, wanted.sample(p).value_m);
    }
  }
}

TEST(BakeField, OverlappingTouchingAndNestedSolids) {
  // Touching boxes are one body: no wall between them.
  Mesh touching = test::box_mesh(Vec3(0, 0, 0), Vec3(0.02, 0.02, 0.02));
  test::append(touching, test::box_mesh(Vec3(0.02, 0, 0), Vec3(0.04, 0.02, 0.02)));
  const auto long_box = [](const Vec3& p) { return test::box_distance(p, Vec3(0, 0, 0), Vec3(0.04, 0.02, 0.02)); };
  EXPECT_EQ(compare(bake(touching, 64).field, long_box).wrong_sign, 0);
  // A hollow sphere: the cavity is outside, whatever the orientation of its wall.
  Mesh hollow = test::sphere_mesh(Vec3::Zero(), 0.03, 40);
  test::append(hollow, test::sphere_mesh(Vec3::Zero(), 0.015, 30));
  const auto shell = [](const Vec3& p) { return std::max(p.norm() - 0.03, 0.015 - p.norm()); };
  EXPECT_EQ(compare(bake(hollow, 64).field, shell).wrong_sign, 0);
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
  EXPECT_EQ(baked.report.surface_without_inside, 0);
  // Without a thickness it has no inside, and the report says so.
  const Baked thin = bake(sheet, 100);
  EXPECT_GT(thin.report.surface_without_inside, 0.9);
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

TEST(BakeField, CancelsWhenAsked) {
  const Soup soup = clean_soup(fine_torus());
  FieldReport report;
  int calls = 0;
  EXPECT_THROW(bake_field(
                   soup, {128, 4, 0}, [&](const char*, double) { return ++calls < 5; }, report),
               Cancelled);
}

TEST(BakeField, ScaleAndPlaceDoNotMatter) {
  for (const double scale : {1e-3, 1.0, 1e3}) {
    Mesh mesh = test::torus_mesh(0.04, 0.015, 100, 60);
    for (auto& v : mesh.vertices) v = (v + Eigen::Vector3f(0.3f, -0.2f, 0.1f)) * static_cast<float>(scale);
    const Baked baked = bake(mesh, 64);
    const Errors errors =
        compare(baked.field, [&](const Vec3& p) { return scale * torus_m(p / scale - Vec3(0.3, -0.2, 0.1)); });
    EXPECT_EQ(errors.wrong_sign, 0);
    EXPECT_LT(errors.value, 0.15);
    EXPECT_EQ(baked.report.jumping_blocks, 0u);
  }
}

}  // namespace
}  // namespace tact::contact
