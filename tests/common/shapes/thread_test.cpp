#include "shapes/thread.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/shapes/closed_surface.hpp"
#include "math/exp_log.hpp"
#include "shapes/shapes.hpp"

namespace tact::shapes {
namespace {

using std::numbers::pi;

const Thread kM16{0.016, 0.002, 1e-4}, kNut{0.016, 0.002, 0};

/// Distance of p from the thread's surface, along the radius: the closed form, not the mesh.
double off_surface(const Thread& thread, const Vec3& p) {
  return std::hypot(p.x(), p.y()) - thread.radius(std::atan2(p.y(), p.x()), p.z());
}

TEST(Thread, DiametersAreThoseOfIso) {
  // ISO 724, M16: pitch diameter 14.701 mm, minor diameter 13.835 mm.
  EXPECT_NEAR(kNut.root_m(), 13.835e-3, 1e-6);
  EXPECT_NEAR(kNut.radius(0, 0), 8e-3, 1e-12);
  EXPECT_NEAR(kNut.radius(0, 1e-3), 13.835e-3 / 2, 1e-6);
  EXPECT_NEAR(kNut.radius(0, 0.5e-3), 14.701e-3 / 2, 1e-6);  // where thread and gap are equally wide
  EXPECT_NEAR(kM16.crest_m(), 15.9e-3, 1e-12);
  // The flank: 30 degrees from the radius.
  EXPECT_NEAR((kNut.radius(0, 0.4e-3) - kNut.radius(0, 0.6e-3)) * std::tan(pi / 6), 0.2e-3, 1e-9);
}

TEST(Thread, BoltAndNutAreClosedAndHaveTheirVolume) {
  for (const double length : {0.013, 0.0291, 0.004}) {  // whole and broken numbers of pitches
    const double sides = 192, chords = std::sin(2 * pi / sides) / (2 * pi / sides);
    const double hexagon = std::sqrt(3.0) / 2 * 0.024 * 0.024;
    const Mesh b = bolt(kM16, length, 0.024, 0.01, 192), n = nut(kNut, 0.024, length, 192);
    expect_closed(b, "bolt");
    expect_closed(n, "nut");
    EXPECT_NEAR(volume(b), kM16.section_m2() * chords * length + hexagon * 0.01, 2e-4 * volume(b));
    EXPECT_NEAR(volume(n), (hexagon - kNut.section_m2() * chords) * length, 2e-4 * volume(n));
  }
}

TEST(Thread, TurningIsShiftingByThePitch) {
  const Mesh mesh = nut(kNut, 0.024, 0.02, 96);
  for (const double turn : {2 * pi / 96, 0.3, 2.0, -1.1, 2 * pi}) {
    const Pose screw{Vec3(0, 0, 0.002 * turn / (2 * pi)), exp_so3(Vec3(0, 0, turn))};
    const Pose wrong{-screw.p, screw.q};
    double farthest = 0, farthest_wrong = 0;
    int seen = 0;
    for (const auto& v : mesh.vertices) {
      const Vec3 p = v.cast<double>();
      if (p.z() < 0.003 || p.z() > 0.017 || std::hypot(p.x(), p.y()) > 0.0081) continue;  // ends and hexagon
      ++seen;
      farthest = std::max(farthest, std::fabs(off_surface(kNut, screw * p)));
      farthest_wrong = std::max(farthest_wrong, std::fabs(off_surface(kNut, wrong * p)));
    }
    EXPECT_GT(seen, 2000);
    EXPECT_LT(farthest, 1e-8) << turn;
    if (turn != 2 * pi) {
      EXPECT_GT(farthest_wrong, 1e-5) << turn;  // a left-handed one
    }
  }
}

/// Corner to corner, so that the mesh itself, not only its corners, is the same after a turn by a column.
TEST(Thread, TheMeshMapsToItselfColumnByColumn) {
  const int sides = 96;
  const Mesh mesh = bolt(kM16, 0.02, 0.024, 0.01, sides);
  const Pose screw{Vec3(0, 0, 0.002 / sides), exp_so3(Vec3(0, 0, 2 * pi / sides))};
  const auto middle = [&](const auto& t) {
    Vec3 sum = Vec3::Zero();
    for (const auto v : t) sum += mesh.vertices[v].template cast<double>() / 3;
    return sum;
  };
  std::vector<Vec3> middles;
  for (const auto& t : mesh.triangles) middles.push_back(middle(t));
  int seen = 0;
  for (const Vec3& p : middles) {
    if (p.z() < 0.003 || p.z() > 0.005) continue;
    ++seen;
    double nearest = 1;
    for (const Vec3& q : middles) nearest = std::min(nearest, (screw * p - q).norm());
    ASSERT_LT(nearest, 1e-8);
  }
  EXPECT_GT(seen, 500);
}

/// The bolt between the flanks of the nut: as far to each side as the closed form says, and no farther.
TEST(Thread, AxialPlayIsWhereTheFlanksMeet) {
  const double half = kM16.axial_play_m() / 2;
  EXPECT_NEAR(kM16.axial_play_m(), 1e-4 / std::sqrt(3.0), 1e-12);
  for (const double shift : {-half, half}) {
    for (const double past : {-1e-7, 1e-7}) {
      double deepest = -1;
      for (int i = 0; i < 4000; ++i) {
        const double z = 0.002 * i / 4000, s = shift + std::copysign(past, past * shift);
        deepest = std::max(deepest, kM16.radius(0, z - s) - kNut.radius(0, z));
      }
      EXPECT_EQ(deepest > 0, past > 0) << shift;
    }
  }
}

TEST(Thread, ShapesRefuseWhatIsNoThread) {
  EXPECT_THROW(make_shape("bolt", {{"pitch_m", 0.012}}), std::exception);
  EXPECT_THROW(make_shape("nut", {{"sides_count", 100}}), std::exception);
  EXPECT_THROW(make_shape("nut", {{"width_m", 0.016}}), std::exception);
}

}  // namespace
}  // namespace tact::shapes
