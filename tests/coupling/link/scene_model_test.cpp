#include "coupling/link/scene_model.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "coupling/link/some_scene.hpp"
#include "fault/fault.hpp"
#include "math/exp_log.hpp"

namespace tact::coupling {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

/// Refused, and the message names the field.
void expect_refused(const wire::SceneInfo& info, const std::string& field) {
  try {
    scene_model(info);
    ADD_FAILURE() << field << " was taken";
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("SceneInfo." + field + ":"), std::string::npos) << e.what();
  }
}

TEST(SceneModel, KeepsTheNumbersOfTheServer) {
  wire::SceneInfo info = some_scene();
  info.X_TM.position.x = 0.25;
  info.X_TM.orientation.w = 1 + 1e-5;
  const SceneModel model = scene_model(info);
  EXPECT_EQ(model.identity, (SceneIdentity{11, 22}));
  EXPECT_EQ(model.X_TM.p.x(), 0.25);
  EXPECT_DOUBLE_EQ(model.X_TM.q.w(), 1);
  EXPECT_EQ(model.inertia_shape_m2(2, 2), 8e-4);
  EXPECT_EQ(model.voxel_m, 1e-3);
  EXPECT_EQ(model.stiffness_n_per_m, 20000);
}

TEST(SceneModel, NoLengthOrStiffnessThatIsNotPositiveOrNotFiniteIsTaken) {
  using Member = double wire::SceneInfo::*;
  const std::vector<std::pair<Member, std::string>> fields{{&wire::SceneInfo::gyration_radius_m, "gyration_radius_m"},
                                                           {&wire::SceneInfo::tool_radius_m, "tool_radius_m"},
                                                           {&wire::SceneInfo::voxel_m, "voxel_m"},
                                                           {&wire::SceneInfo::stiffness_n_per_m, "stiffness_n_per_m"},
                                                           {&wire::SceneInfo::x_max_m, "x_max_m"}};
  for (const auto& [member, name] : fields) {
    for (const double bad : {0.0, -1e-3, -kInfinity, kInfinity, kNan, 1e30, 1e-300}) {
      wire::SceneInfo info = some_scene();
      info.*member = bad;
      expect_refused(info, name);
    }
  }
}

TEST(SceneModel, NoPoseThatIsNotARotationAndAPlaceIsTaken) {
  const std::vector<std::function<double&(geometry_msgs_msg_dds__Pose_&)>> numbers{
      [](auto& X) -> double& { return X.position.x; },    [](auto& X) -> double& { return X.position.y; },
      [](auto& X) -> double& { return X.position.z; },    [](auto& X) -> double& { return X.orientation.w; },
      [](auto& X) -> double& { return X.orientation.x; }, [](auto& X) -> double& { return X.orientation.y; },
      [](auto& X) -> double& { return X.orientation.z; }};
  for (const auto& number : numbers) {
    for (const double bad : {kNan, kInfinity, -kInfinity, 1e6}) {
      wire::SceneInfo info = some_scene();
      number(info.X_TM) = bad;
      expect_refused(info, "X_TM");
      info = some_scene();
      number(info.X_WO) = bad;
      expect_refused(info, "X_WO");
    }
  }
  wire::SceneInfo info = some_scene();
  info.X_TM.orientation.w = 0;  // no rotation at all
  expect_refused(info, "X_TM");
}

TEST(SceneModel, EveryInertiaOfPointMassesIsTakenAndNoneThatNoBodyHas) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int body = 0; body < 200; ++body) {
    // Point masses in a line (needles), in a plane (plates) and in space.
    const Vec3 extent = 0.05 * Vec3(1, body % 3 > 0, body % 3 > 1);
    Mat3 I = Mat3::Zero();
    for (int i = 0; i < 10; ++i) {
      const Vec3 r = extent.cwiseProduct(Vec3(normal(random), normal(random), normal(random)));
      I += 0.1 * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    const Mat3 R = exp_so3(Vec3(normal(random), normal(random), normal(random))).toRotationMatrix();
    I = R * I * R.transpose();
    wire::SceneInfo info = some_scene();
    tact::to_wire(I, info.inertia_shape_m2);
    EXPECT_NO_THROW(scene_model(info)) << I;

    const Mat3 bad[]{-I, I * 1e20, I - 1.1 * I.trace() * Mat3::Identity(),
                     Mat3(R * Vec3(1e-3, 1e-3, 2.1e-3).asDiagonal() * R.transpose()),
                     I + 0.1 * I.trace() * (Mat3() << 0, 1, 0, 0, 0, 0, 0, 0, 0).finished()};
    for (const Mat3& no_body : bad) {
      tact::to_wire(no_body, info.inertia_shape_m2);
      expect_refused(info, "inertia_shape_m2");
    }
  }
  for (int i = 0; i < 9; ++i) {
    for (const double bad : {kNan, kInfinity, -kInfinity}) {
      wire::SceneInfo info = some_scene();
      info.inertia_shape_m2[i] = bad;
      expect_refused(info, "inertia_shape_m2");
    }
  }
  wire::SceneInfo info = some_scene();
  std::fill(std::begin(info.inertia_shape_m2), std::end(info.inertia_shape_m2), 0.0);
  expect_refused(info, "inertia_shape_m2");
}

TEST(SceneModel, OfABodyThatIsTooLargeTheUnitIsAskedForAndNotTheCache) {
  const auto said = [](const auto& change) {
    wire::SceneInfo info = some_scene();
    change(info);
    try {
      scene_model(info);
    } catch (const SetupError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  const auto asks_for_unit = [](const std::string& text) { return text.find("--unit") != std::string::npos; };
  const auto blames_cache = [](const std::string& text) { return text.find("cached") != std::string::npos; };
  const std::string large[]{said([](auto& s) { s.tool_radius_m = 2870; }), said([](auto& s) { s.voxel_m = 1e-12; }),
                            said([](auto& s) { s.X_TM.position.y = -1435; }), said([](auto& s) {
                              for (double& I : s.inertia_shape_m2) I *= 1e10;
                            })};
  for (const std::string& text : large) {
    EXPECT_TRUE(asks_for_unit(text)) << text;
    EXPECT_FALSE(blames_cache(text)) << text;
  }
  const std::string damaged[]{said([](auto& s) { s.tool_radius_m = kNan; }), said([](auto& s) { s.voxel_m = 0; }),
                              said([](auto& s) { s.X_TM.orientation.w = 0; })};
  for (const std::string& text : damaged) {
    EXPECT_FALSE(asks_for_unit(text)) << text;
    EXPECT_TRUE(blames_cache(text)) << text;
  }
}

TEST(SceneModel, AnotherSchemaIsRefused) {
  wire::SceneInfo info = some_scene();
  info.schema = wire::kSchema + 1;
  expect_refused(info, "schema");
}

}  // namespace
}  // namespace tact::coupling
