#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "contact/bake/worker/field_bake.hpp"
#include "contact/bake/worker/import.hpp"
#include "support/process.hpp"
#include "test_meshes.hpp"

/// Meshes of Debian's libcgal-demo, occt-misc and assimp-testmodels: what people really have. Signs are right or
/// declared doubtful; the judge is the generalized winding number of the file's own triangles, by solid angles.
namespace tact::contact {
namespace {

const std::filesystem::path kCgal = "/usr/share/doc/libcgal-dev/data.tar.gz";
const std::filesystem::path kStl = "/usr/share/opencascade/data/stl";
const std::filesystem::path kEngine = "/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb";

double winding_number(const Mesh& mesh, const Vec3& p) {
  double angle = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]].cast<double>() - p, b = mesh.vertices[t[1]].cast<double>() - p,
               c = mesh.vertices[t[2]].cast<double>() - p;
    const double x = a.norm(), y = b.norm(), z = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y);
  }
  return angle / (4 * M_PI);
}

struct Verdict {
  int judged = 0, wrong = 0, declared = 0;  ///< declared: wrong, but in a doubtful block
  FieldReport report;
  SoupReport soup;
};

/// Random places near the surface, but half a voxel off it, where the winding number is nearly whole. With `one_in`,
/// one triangle in so many is missing of what is baked.
Verdict judge(const std::filesystem::path& file, int resolution, int places, int one_in = 0) {
  const Mesh mesh = import_mesh(file, "mm");
  const Soup soup = clean_soup(one_in > 0 ? test::torn(mesh, one_in, 1) : mesh);
  Verdict v;
  const DistanceField field = make_field(bake_field(soup, {resolution, 4, 0}, {}, v.report));
  v.soup = soup.report;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < places; ++i) {
    const auto& t = mesh.triangles[std::uniform_int_distribution<std::size_t>(0, mesh.triangles.size() - 1)(random)];
    const Vec3 p =
        mesh.vertices[t[0]].cast<double>() + 2 * field.voxel_m() * Vec3(normal(random), normal(random), normal(random));
    const auto s = field.sample(p);
    const double w = winding_number(mesh, p);
    if (std::fabs(s.value_m) < 0.5 * field.voxel_m() || std::fabs(w - std::round(w)) > 0.1) continue;
    ++v.judged;
    if ((std::fabs(w) > 0.5) == (s.value_m < 0)) continue;
    ++(s.doubtful ? v.declared : v.wrong);
  }
  std::printf("%-24s %6zu triangles, %3zu parts (%zu open): %4d judged, %d wrong, %d wrong but declared\n",
              file.filename().c_str(), mesh.triangles.size(), v.soup.components, v.soup.open_components, v.judged,
              v.wrong, v.declared);
  return v;
}

class RealMeshes : public testing::Test {
 protected:
  std::filesystem::path cgal(const std::string& name) {
    if (!std::filesystem::exists(kCgal)) return {};
    const std::string member = "data/meshes/" + name;
    test::Process tar({"/usr/bin/tar", "xzf", kCgal.string(), "-C", scratch_.path().string(), member},
                      scratch_.path() / "log");
    EXPECT_EQ(tar.wait(std::chrono::seconds{60}), 0) << tar.output();
    return scratch_.path() / member;
  }
  test::ScratchDir scratch_;
};

TEST_F(RealMeshes, ClosedScansAndCadPartsAreRight) {
  for (const char* name : {"armadillo.off", "anchor_dense.off", "knot2.off", "bones.off", "couplingdown.off"}) {
    const auto file = cgal(name);
    if (file.empty()) GTEST_SKIP() << "install libcgal-demo";
    const Verdict v = judge(file, 64, 150);
    EXPECT_GT(v.judged, 50) << name;
    EXPECT_EQ(v.wrong + v.declared, 0) << name;
    EXPECT_EQ(v.report.jumping_blocks, 0u) << name;
  }
}

TEST_F(RealMeshes, OpenOnesAreRightOrDeclared) {
  for (const char* name : {"mech-holes-shark.off", "elephant-with-holes.off", "lion-head.off"}) {
    const auto file = cgal(name);
    if (file.empty()) GTEST_SKIP() << "install libcgal-demo";
    const Verdict v = judge(file, 64, 200);
    EXPECT_EQ(v.wrong, 0) << name;
    EXPECT_GT(v.report.signs.doubtful_blocks + v.report.jumping_blocks, 0u) << name;
  }
}

TEST_F(RealMeshes, WithTrianglesMissingTheyAreRightOrDeclaredAndFewAreDeclared) {
  for (const char* name : {"bull.off", "bones.off", "camel.off"}) {
    const auto file = cgal(name);
    if (file.empty()) GTEST_SKIP() << "install libcgal-demo";
    for (const int one_in : {50, 20, 5}) {
      const Verdict v = judge(file, 96, 250, one_in);
      EXPECT_EQ(v.wrong, 0) << name << " " << one_in;
      if (one_in == 50) {
        EXPECT_EQ(v.declared, 0) << name;
        EXPECT_LT(v.report.signs.doubtful_blocks, v.report.blocks_stored / 4) << name;
      }
    }
  }
}

TEST_F(RealMeshes, AssembliesOfManyPartsAreTheirUnion) {
  if (!std::filesystem::exists(kEngine) || !std::filesystem::exists(kStl)) {
    GTEST_SKIP() << "install assimp-testmodels and occt-misc";
  }
  const Verdict engine = judge(kEngine, 96, 150), motor = judge(kStl / "motor.stl", 96, 300);
  EXPECT_GT(engine.report.solids.overlaps, 10u);
  EXPECT_GT(engine.report.solids.solids, 50u);
  EXPECT_LE(engine.wrong, engine.judged / 50);  // its open parts have no winding number to speak of
  EXPECT_GT(motor.report.solids.overlaps, 10u);
  EXPECT_EQ(motor.wrong, 0);
}

}  // namespace
}  // namespace tact::contact
