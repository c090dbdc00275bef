#include <gtest/gtest.h>

#include <cstdlib>
#include <ctime>
#include <filesystem>

#include "scene_builders.hpp"
#include "view/render/field_slice.hpp"
#include "view/render/gauss_map.hpp"
#include "view/render/ray_tracer.hpp"
#include "view/render/sheet.hpp"
#include "view/render/strips.hpp"

namespace tact::view {
namespace {

using testing::box;
using testing::sphere;

const Mesh kNoMesh;

bool bluish(const Color& c) { return c[0] > c[2] + 25; }
bool reddish(const Color& c) { return c[2] > c[0] + 40; }

int count(const Image& image, bool (*is)(const Color&)) {
  int n = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) n += is(image.at(x, y)) ? 1 : 0;
  }
  return n;
}

Camera looking_down(double distance_m) {
  Camera camera;
  camera.yaw_rad = 0;
  camera.pitch_rad = 0;
  camera.distance_m = distance_m;
  return camera;
}

TEST(RayTracer, ASpheresOutlineHasTheRightArea) {
  RayTracer tracer(kNoMesh, sphere(0.1f, 96), 1);
  const Camera camera = looking_down(1);
  Image image(320, 240);
  tracer.trace(camera, {}, image);
  // The outline is where the cone of tangents passes: tan of its half angle over that of the half picture.
  const double tangent = std::tan(std::asin(0.1 / 1.0)), half_px = 120 / std::tan(camera.fov_y_rad / 2);
  EXPECT_NEAR(count(image, reddish), M_PI * std::pow(tangent * half_px, 2),
              0.02 * M_PI * std::pow(tangent * half_px, 2));
}

TEST(RayTracer, TheNearerBodyHidesTheFartherOne) {
  RayTracer tracer(box({0.1f, 0.1f, 0.1f}), box({0.05f, 0.05f, 0.05f}), 1);
  const Camera camera = looking_down(1);  // from +x
  Image image(320, 240);
  tracer.trace(camera, {{}, {Vec3(0.3, 0, 0), Quat::Identity()}, {}}, image);
  EXPECT_TRUE(reddish(image.at(160, 120)));
  tracer.trace(camera, {{}, {Vec3(-0.3, 0, 0), Quat::Identity()}, {}}, image);
  EXPECT_TRUE(bluish(image.at(160, 120)));
  EXPECT_EQ(count(image, reddish), 0);
}

TEST(RayTracer, BodiesGoWhereTheirPosesPutThem) {
  RayTracer tracer(kNoMesh, box({0.01f, 0.01f, 0.01f}, {0.05f, 0, 0}), 1);
  const Camera camera = looking_down(1);
  // The box sits at (0.05, 0, 0) of a mesh frame that is turned by 90 degrees about z and moved up.
  const Pose X_WM{Vec3(0, 0, 0.04), Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitZ()))};
  Image image(320, 240);
  tracer.trace(camera, {{}, X_WM, {}}, image);
  const Eigen::Vector2d p = camera.project(X_WM * Vec3(0.05, 0, 0), 320, 240);
  EXPECT_TRUE(reddish(image.at(static_cast<int>(p.x()), static_cast<int>(p.y()))));
  EXPECT_FALSE(reddish(image.at(160, 120)));
}

TEST(RayTracer, ShadowsFallFromTheToolOntoTheObstacle) {
  RayTracer tracer(box({0.001f, 0.3f, 0.3f}), box({0.002f, 0.03f, 0.03f}), 1);
  const Camera camera = looking_down(1);
  Image far_away(320, 240), near_by(320, 240);
  tracer.trace(camera, {{}, {Vec3(-5, 0, 0), Quat::Identity()}, {}}, far_away);
  tracer.trace(camera, {{}, {Vec3(0.1, 0, 0), Quat::Identity()}, {}}, near_by);
  int darker = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x)
      darker += bluish(near_by.at(x, y)) && near_by.at(x, y)[0] < far_away.at(x, y)[0] - 30 ? 1 : 0;
  }
  EXPECT_GT(darker, 200);
}

TEST(RayTracer, AnArrowIsDrawnAndShinesThroughABody) {
  RayTracer tracer(box({0.1f, 0.1f, 0.1f}), kNoMesh, 1);
  const Camera camera = looking_down(1);
  Image without(320, 240), with(320, 240);
  tracer.trace(camera, {}, without);
  const std::vector<Arrow> inside{{Vec3(0, -0.05, 0), Vec3(0, 0.05, 0), 0.006, 0.02, {38, 38, 214}}};
  tracer.trace(camera, {{}, {}, inside}, with);
  const Color before = without.at(160, 120), after = with.at(160, 120);
  EXPECT_GT(after[2], before[2] + 20);
  const std::vector<Arrow> in_front{{Vec3(0.2, -0.05, 0), Vec3(0.2, 0.05, 0), 0.006, 0.02, {38, 38, 214}}};
  tracer.trace(camera, {{}, {}, in_front}, with);
  EXPECT_TRUE(reddish(with.at(160, 120)));
  EXPECT_EQ(without.at(20, 20), with.at(20, 20));
}

TEST(RayTracer, PicturesOfAnySizeAndEmptyScenesAreDrawn) {
  RayTracer tracer(kNoMesh, kNoMesh, 1);
  for (const auto& [w, h] : {std::pair{1, 1}, {7, 3}, {33, 17}}) {
    Image image(w, h, {1, 2, 3});
    tracer.trace(Camera{}, {}, image);
    EXPECT_GT(image.at(w - 1, h - 1)[0], 100);
  }
}

TEST(RayTracer, BoundsHoldBothBodies) {
  RayTracer tracer(box({1, 1, 1}), box({1, 1, 1}), 1);
  Vec3 centre;
  double radius = 0;
  tracer.bounds({{}, {Vec3(4, 0, 0), Quat::Identity()}, {}}, centre, radius);
  EXPECT_LT((centre - Vec3(2, 0, 0)).norm(), 1e-6);
  EXPECT_NEAR(radius, std::sqrt(9 + 1 + 1), 1e-6);
}

TEST(ContactArrows, PointAlongTheNormalAndGrowWithForce) {
  ViewScene scene;
  scene.info.voxel_m = 1;  // no line to the hand
  scene.contact_set.contacts = {testing::contact(Vec3(1, 0, 0), Vec3::UnitZ(), 1, 1e-4),
                                testing::contact(Vec3(2, 0, 0), Vec3::UnitY(), 4, 1e-4)};
  const auto arrows = contact_arrows(scene, 0.1);
  ASSERT_EQ(arrows.size(), 2u);
  const auto length = [](const Arrow& a) { return (a.tip_W - a.tail_W).norm(); };
  EXPECT_EQ(arrows[0].tail_W, Vec3(1, 0, 0));
  EXPECT_NEAR((arrows[0].tip_W - arrows[0].tail_W).normalized().z(), 1, 1e-12);
  EXPECT_NEAR(length(arrows[1]), 0.1, 1e-12);
  EXPECT_LT(length(arrows[0]), length(arrows[1]));
}

TEST(ContactArrows, AreTheStrongestWhenThereAreTooMany) {
  ViewScene scene;
  scene.info.voxel_m = 1;
  for (int i = 0; i < 500; ++i)
    scene.contact_set.contacts.push_back(testing::contact(Vec3(i, 0, 0), Vec3::UnitZ(), (i * 37) % 500, 1e-4));
  const auto arrows = contact_arrows(scene, 0.1, 10);
  ASSERT_EQ(arrows.size(), 10u);
  for (const Arrow& arrow : arrows) EXPECT_GE((static_cast<int>(arrow.tail_W.x()) * 37) % 500, 490);
}

TEST(GaussMap, DotsSitAtTheirDirections) {
  ViewScene scene;
  const Camera camera = looking_down(1);  // from +x: y to the right, z up
  const double s = std::sqrt(0.5);
  // N = (s, s, 0) at r = (0, 0, 0.1): r x N = 0.1 (-s, s, 0), on the far side.
  scene.contact_set.contacts = {
      testing::contact(Vec3(0, 0, 0.1), Vec3(s, s, 0), 1, 1e-4),
      testing::contact(Vec3(0.0, 0.1, 0), Vec3(0, s, s), 1, 1e-4)};  // r x N = 0.1 (s, 0, 0): the middle
  const Image map = draw_gauss_map(scene, camera, 300);
  EXPECT_TRUE(reddish(map.at(static_cast<int>(150 + 0.42 * 300 * s), 150)));
  EXPECT_TRUE(reddish(map.at(static_cast<int>(150 + 0.42 * 300 * s), static_cast<int>(150 - 0.42 * 300 * s))));
  EXPECT_TRUE(bluish(map.at(150, 150)));
  EXPECT_FALSE(reddish(map.at(static_cast<int>(150 - 0.42 * 300 * s), 150)));
  bool far_side = false;
  const Eigen::Vector2d p = gauss_map_pixel(Vec3(-1, 0, 0), camera, 300, far_side);
  EXPECT_TRUE(far_side);
  EXPECT_NEAR(p.x(), 150, 1e-9);
}

TEST(GaussMap, ANormalThroughTheCentreOfMassHasNoTorqueDot) {
  ViewScene scene;
  scene.contact_set.contacts = {testing::contact(Vec3(0, 0, 0.1), Vec3::UnitZ(), 1, 1e-4)};
  const Image map = draw_gauss_map(scene, looking_down(1), 300);
  const auto torque_blue = [](const Color& c) { return c[0] > 180 && c[2] < 70; };
  EXPECT_EQ(count(map, torque_blue), 0);
}

TEST(FieldSlice, OutsideIsBlueInsideIsGreenAndTheSurfaceIsALine) {
  ViewScene scene;
  scene.info.voxel_m = 1e-3;
  SlicePlane plane;
  plane.half_side_m = 0.014;
  const auto ball = [](const Vec3& p) { return p.norm() - 0.005; };
  const Image slice = draw_field_slice(ball, plane, {}, scene, 280);  // 10 pixels a millimetre
  const Color inside = slice.at(140, 140), outside = slice.at(140 + 110, 140 + 20), surface = slice.at(140 + 50, 140);
  EXPECT_GT(inside[1], inside[0] + 40);
  EXPECT_GT(inside[1], inside[2] + 40);
  EXPECT_GT(outside[0], outside[2] + 60);
  EXPECT_LT(surface[0] + surface[1] + surface[2], 400);
  // A circle of radius 5 mm: the line is met at the same distance along the diagonal.
  const int d = static_cast<int>(std::lround(50 / std::sqrt(2)));
  const Color diagonal = slice.at(140 - d, 140 - d);
  EXPECT_LT(diagonal[0] + diagonal[1] + diagonal[2], 480);
}

TEST(FieldSlice, ShowsTheToolsCutAndTheContactsOnIt) {
  ViewScene scene;
  scene.info.voxel_m = 1e-3;
  SlicePlane plane;
  plane.half_side_m = 0.014;
  const auto far_away = [](const Vec3&) { return 1.0; };
  const auto segments = cut(box({0.004f, 0.004f, 0.004f}), Pose{Vec3(0.002, 0, 0), Quat::Identity()}, plane);
  Image slice = draw_field_slice(far_away, plane, segments, scene, 280);
  EXPECT_TRUE(reddish(slice.at(140 + 60, 140)));
  EXPECT_TRUE(reddish(slice.at(140 - 20, 150)));
  EXPECT_FALSE(reddish(slice.at(140 - 60, 140)));
  scene.contact_set.contacts = {testing::contact(Vec3(-0.006, 0.003, 0), Vec3::UnitX(), 1, 1e-4),
                                testing::contact(Vec3(-0.006, -0.008, 0.01), Vec3::UnitX(), 1, 1e-4)};
  slice = draw_field_slice(far_away, plane, segments, scene, 280);
  EXPECT_TRUE(reddish(slice.at(140 - 60, 140 - 30)));
  EXPECT_FALSE(reddish(slice.at(140 - 60, 140 + 80)));  // ten voxels off the plane
}

TEST(CrossSection, OfABoxIsItsRectangle) {
  SlicePlane plane;
  plane.half_side_m = 1;
  double length = 0;
  for (const Segment& s : cut(box({0.2f, 0.3f, 0.4f}), {}, plane)) length += (s.b - s.a).norm();
  EXPECT_NEAR(length, 4 * 0.2 + 4 * 0.3, 1e-5);
  plane.centre_O = Vec3(0, 0, 0.5);
  EXPECT_TRUE(cut(box({0.2f, 0.3f, 0.4f}), {}, plane).empty());
}

TEST(Strips, ScalesAreRound) {
  EXPECT_DOUBLE_EQ(round_scale(0.7), 1);
  EXPECT_DOUBLE_EQ(round_scale(1), 1);
  EXPECT_DOUBLE_EQ(round_scale(3), 5);
  EXPECT_DOUBLE_EQ(round_scale(42), 50);
  EXPECT_DOUBLE_EQ(round_scale(0), 1e-3);
  EXPECT_DOUBLE_EQ(round_scale(NAN), 1e-3);
}

TEST(Strips, TheNewestValueIsAtTheRightEdge) {
  ViewScene scene;
  for (int i = 0; i < 600; ++i) scene.history.add({i / 60.0, i > 540 ? 10.0f : 0.0f});
  const Image strips = draw_strips(scene, 600, 400);
  const auto red_in = [&](int x0, int x1) {
    int n = 0;
    for (int y = 0; y < 60; ++y) {
      for (int x = x0; x < x1; ++x) n += reddish(strips.at(x, y)) ? 1 : 0;
    }
    return n;
  };
  EXPECT_GT(red_in(580, 600), 0);
  EXPECT_EQ(red_in(300, 500), 0);
}

TEST(Strips, NothingYetIsDrawnEmpty) { EXPECT_EQ(draw_strips(ViewScene{}, 600, 400).width, 600); }

TEST(Sheet, IsWrittenAsAPng) {
  const auto path = std::filesystem::temp_directory_path() / ("tact_sheet_" + std::to_string(getpid()) + ".png");
  write_png(compose_sheet("a title", Image(40, 30), Image(), Image(), Image(40, 10)), path);
  EXPECT_GT(std::filesystem::file_size(path), 200u);
  std::filesystem::remove(path);
  EXPECT_ANY_THROW(write_png(Image(4, 4), "/nowhere/at/all.png"));
}

// To look at, and to see what a picture costs: TACT_SHEET=/tmp/sheet.png tests/view_render_test --gtest_filter=Sheet.*
TEST(Sheet, OfAWholeSceneCanBeLookedAt) {
  const char* named = std::getenv("TACT_SHEET");
  const std::string path = named != nullptr ? named : ::testing::TempDir() + "tact-sheet.png";
  const ViewScene scene = testing::ring_and_peg(1.0);
  const Mesh ring = testing::merged(testing::torus(0.06f, 0.02f), box({0.09f, 0.09f, 0.004f}, {0, 0, -0.03f}));
  const Mesh peg = testing::merged(box({0.025f, 0.025f, 0.06f}), box({0.06f, 0.008f, 0.008f}, {0, 0, 0.07f}));
  RayTracer tracer(ring, peg, 1);
  Vec3 centre;
  double radius = 0;
  const auto arrows = contact_arrows(scene, 0.03);
  const Placement placement{{}, scene.device.X_WM, arrows};
  tracer.bounds(placement, centre, radius);
  const Camera camera = frame_ball(centre, radius);
  const auto timed = [](const char* what, auto&& work) {
    const std::clock_t start = std::clock();  // of this process: other work on the machine does not count
    for (int i = 0; i < 20; ++i) work();
    std::printf("%-12s %6.2f ms of processor time\n", what,
                1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / 20);
  };
  Image small(640, 480), picture(960, 720), map, slice, strips;
  timed("trace", [&] { tracer.trace(camera, placement, small); });
  timed("jpeg", [&] { encode_jpeg(small, 80); });
  tracer.trace(camera, placement, picture);
  timed("gauss map", [&] { map = draw_gauss_map(scene, camera, 345); });
  SlicePlaneChooser chooser;
  const SlicePlane plane = chooser.choose(scene, camera.X_WE().R().col(2), camera.X_WE().R().col(1));
  const auto segments = cut(peg, scene.device.X_WM, plane);
  timed("slice", [&] {
    slice = draw_field_slice([](const Vec3& p) { return testing::torus_field(p, 0.06, 0.02); }, plane, segments, scene,
                             345);
  });
  timed("strips", [&] { strips = draw_strips(scene, 1325, 400); });
  write_png(compose_sheet("ring and peg: potential, k 20 kN/m", picture, map, slice, strips), path);
  EXPECT_GT(std::filesystem::file_size(path), 10'000u);
}

}  // namespace
}  // namespace tact::view
