#include <gtest/gtest.h>

#include "math/exp_log.hpp"
#include "view/model/hand.hpp"
#include "view/model/slice_plane.hpp"

namespace tact::view {
namespace {

TEST(History, KeepsTheNewestInOrder) {
  History history(4);
  for (int i = 0; i < 7; ++i) history.add({static_cast<double>(i), static_cast<float>(i)});
  ASSERT_EQ(history.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(history[i].force_n, 3.0f + static_cast<float>(i));
}

TEST(History, ForgetsWhatAnotherClockSaid) {
  History history(4);
  for (int i = 0; i < 7; ++i) history.add({100.0 + i});
  history.add({1.0});
  ASSERT_EQ(history.size(), 1u);
  EXPECT_EQ(history[0].time_s, 1.0);
}

TEST(Camera, LooksAtItsTargetWithTheWorldUpright) {
  Camera camera;
  camera.target_W = Vec3(1, 2, 3);
  const Eigen::Vector2d centre = camera.project(camera.target_W, 640, 480);
  EXPECT_NEAR(centre.x(), 320, 1e-9);
  EXPECT_NEAR(centre.y(), 240, 1e-9);
  const Eigen::Vector2d above = camera.project(camera.target_W + Vec3(0, 0, 0.01), 640, 480);
  EXPECT_NEAR(above.x(), 320, 1e-9);
  EXPECT_LT(above.y(), 240);
}

TEST(Camera, PictureHeightSpansThePicture) {
  Camera camera;
  const double h = camera.picture_height_m(camera.target_W);
  const Vec3 up_W = camera.X_WE().R().col(1);
  EXPECT_NEAR(camera.project(camera.target_W + 0.5 * h * up_W, 640, 480).y(), 0, 1e-9);
  EXPECT_NEAR(camera.project(camera.target_W - 0.5 * h * up_W, 640, 480).y(), 480, 1e-9);
}

TEST(Camera, FramesAWholeBall) {
  const Camera camera = frame_ball(Vec3(0, 0, 1), 2);
  const Pose X = camera.X_WE();
  for (int i = 0; i < 100; ++i) {
    const Vec3 d = Vec3(std::sin(i), std::cos(2.3 * i), std::sin(3.7 * i)).normalized();
    const Eigen::Vector2d p = camera.project(Vec3(0, 0, 1) + 2 * d, 480, 480);
    EXPECT_GE(p.minCoeff(), 0);
    EXPECT_LE(p.maxCoeff(), 480);
  }
  EXPECT_GT((X.p - camera.target_W).norm(), 2);
}

TEST(Camera, OrbitStopsBeforeThePoleAndBehindIsOutside) {
  Camera camera;
  camera.orbit(0, 10, 1);
  EXPECT_LT(camera.pitch_rad, M_PI / 2);
  EXPECT_TRUE(camera.X_WE().finite());
  const Vec3 behind = camera.X_WE().p + camera.X_WE().R().col(2);
  EXPECT_LT(camera.project(behind, 640, 480).x(), -1e5);
}

class MouseHandTest : public ::testing::Test {
 protected:
  MouseHandTest() {
    camera.target_W = X_WH.p;
    hand.take(X_WH, X_TM, Vec3::Zero(), 1.0);
  }
  Pose X_WH{Vec3(0.1, 0.2, 0.3), exp_so3(Vec3(0.3, 0.2, 0.1))}, X_TM{Vec3(0.01, 0, 0), exp_so3(Vec3(0, 0, 1))};
  Camera camera;
  MouseHand hand;
};

TEST_F(MouseHandTest, TakingHoldMovesNothing) { EXPECT_LT(displacement(hand.X_WM(), X_WH * X_TM).norm(), 1e-12); }

TEST_F(MouseHandTest, ADragFollowsThePointerInThePicture) {
  hand.move({.dx = 0.1, .dy = 0.05}, camera);
  const Eigen::Vector2d p = camera.project(hand.X_WT().p, 640, 480);
  EXPECT_NEAR(p.x(), 320 + 48, 1e-6);
  EXPECT_NEAR(p.y(), 240 - 24, 1e-6);
}

TEST_F(MouseHandTest, TheWheelMovesAlongTheViewAxis) {
  hand.move({.dz = 0.1}, camera);
  const Vec3 moved = hand.X_WT().p - X_WH.p;
  EXPECT_NEAR(moved.normalized().dot(camera.X_WE().R().col(2)), 1, 1e-9);
}

TEST_F(MouseHandTest, TurningKeepsTheCentreOfMassAndTurnsAboutTheEyesAxis) {
  hand.move({.about_z_rad = 0.4}, camera);
  EXPECT_LT((hand.X_WT().p - X_WH.p).norm(), 1e-12);
  const Vec3 turned = log_so3(hand.X_WT().q * X_WH.q.conjugate());
  EXPECT_LT((turned - 0.4 * camera.X_WE().R().col(2)).norm(), 1e-9);
}

TEST_F(MouseHandTest, StaysWithinReachWhateverTheMouseDoes) {
  for (int i = 0; i < 100; ++i) hand.move({.dx = 9, .dz = -3}, camera);
  EXPECT_LE(hand.X_WT().p.norm(), 1.0 + 1e-9);
  EXPECT_TRUE(hand.X_WM().finite());
}

TEST_F(MouseHandTest, IgnoresWhatNoMouseDoes) {
  hand.move({.dx = 1e308}, camera);
  hand.move({.dx = NAN}, camera);
  hand.move({.about_y_rad = INFINITY}, camera);
  EXPECT_LT(displacement(hand.X_WM(), X_WH * X_TM).norm(), 1e-12);
}

ViewScene scene_with_contact(const Vec3& p_W, const Vec3& N_W) {
  ViewScene scene;
  scene.info.voxel_m = 0.001;
  scene.contact_set.contacts = {{p_W + Vec3(0.1, 0, 0), N_W, N_W, 1e-5, 1}, {p_W, N_W, N_W, 1e-4, 1}};
  return scene;
}

TEST(SlicePlaneChooser, PassesThroughTheDeepestContactAndShowsItsNormal) {
  SlicePlaneChooser chooser;
  const Vec3 p(0.01, 0.02, 0.03);
  for (int axis = 0; axis < 3; ++axis) {
    const SlicePlane plane =
        chooser.choose(scene_with_contact(p, Vec3::Unit(axis)), Vec3(1, 1, 1).normalized(), Vec3::UnitZ());
    EXPECT_LT((plane.centre_O - p).norm(), 1e-12);
    EXPECT_NEAR(plane.u_O.cross(plane.v_O).dot(Vec3::Unit(axis)), 0, 1e-12);
    EXPECT_NEAR(plane.u_O.dot(plane.v_O), 0, 1e-12);
  }
}

TEST(SlicePlaneChooser, SeesThePlaneFromTheViewersSide) {
  const Vec3 view = Vec3(-0.2, -0.3, 0.9).normalized();
  const SlicePlane plane =
      SlicePlaneChooser().choose(scene_with_contact(Vec3::Zero(), Vec3::UnitX()), view, Vec3::UnitY());
  EXPECT_GT(plane.u_O.cross(plane.v_O).dot(view), 0);
  EXPECT_GT(plane.v_O.dot(Vec3::UnitY()), 0.99);
}

TEST(SlicePlaneChooser, DoesNotFlipBetweenNearlyEqualPlanes) {
  SlicePlaneChooser chooser;
  const auto normal = [&](double tilt) {
    const SlicePlane plane = chooser.choose(scene_with_contact(Vec3::Zero(), Vec3::UnitZ()),
                                            Vec3(1 + tilt, 1 - tilt, 0).normalized(), Vec3::UnitZ());
    return Vec3(plane.u_O.cross(plane.v_O).cwiseAbs());
  };
  const Vec3 first = normal(0.05);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(normal(i % 2 == 0 ? -0.05 : 0.05), first);
}

TEST(SlicePlaneChooser, StaysWhereTheLastContactWas) {
  SlicePlaneChooser chooser;
  chooser.choose(scene_with_contact(Vec3(1, 2, 3), Vec3::UnitX()), Vec3::UnitZ(), Vec3::UnitY());
  EXPECT_EQ(chooser.choose(ViewScene{}, Vec3::UnitZ(), Vec3::UnitY()).centre_O, Vec3(1, 2, 3));
}

}  // namespace
}  // namespace tact::view
