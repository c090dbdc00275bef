#include <gtest/gtest.h>

#include <set>

#include "scenes/stored_motions.hpp"
#include "session/session.hpp"
#include "shapes/shapes.hpp"

namespace tact {
namespace {

double apart(const Pose& a, const Pose& b) { return (a.p - b.p).norm() + a.q.angularDistance(b.q); }

TEST(Scenes, AllThatComeWithTheProgramLoadAndTheirShapesAndMotionsExist) {
  std::set<std::string> names;
  for (const auto& file : scene_files()) {
    const SceneSpec scene = load_scene(file);
    names.insert(scene.name);
    EXPECT_FALSE(scene.title.empty()) << file;
    for (const BodySpec* body : {&scene.obstacle, &scene.tool}) {
      if (!body->shape.empty()) check_shape(body->shape, body->shape_params);
    }
    EXPECT_FALSE(scene.scripts.empty()) << file;
    for (const auto& [name, script] : scene.scripts) {
      const HandMotion motion = load_hand_motion(script.hand_csv);
      EXPECT_FALSE(script.description.empty()) << file << name;
      EXPECT_LT(apart(motion.X_WM.front(), scene.start_X_WM), 3e-6) << file << name;
      if (scene.goal_X_WM) {
        EXPECT_LT(apart(motion.X_WM.back(), *scene.goal_X_WM), 3e-6) << file << name;
      }
    }
  }
  EXPECT_EQ(names, (std::set<std::string>{"alpha", "cone", "engine", "landing-gear", "peg", "peg-round", "two-walls",
                                          "wedge"}));
}

TEST(Scenes, KeepTheDimensionsTheyPromise) {
  const auto scene = [](const std::string& name) {
    return load_scene(std::filesystem::path(TACT_SCENES_DIR) / (name + ".toml"));
  };
  const SceneSpec cone = scene("cone");
  const auto& gap = cone.obstacle.shape_params;
  const double voxel = (gap.at("length_m") + gap.at("approach_m")) / cone.field_resolution;
  EXPECT_NEAR((cone.tool.shape_params.at("height_m") - gap.at("gap_m")) / voxel, 4, 1e-9);  // 2 on each side

  const SceneSpec walls = scene("two-walls");
  const auto& w = walls.obstacle.shape_params;
  const auto& box = walls.tool.shape_params;
  const double a = w.at("length_a_m") * w.at("thickness_a_m"), b = w.at("length_b_m") * w.at("thickness_b_m");
  EXPECT_NEAR(a / b, 1000. / 14, 1e-9);
  const double x = box.at("size_x_m"), y = box.at("size_y_m"), z = box.at("size_z_m");
  EXPECT_NEAR(walls.points * (a + b) / (2 * (x * y + y * z + z * x)), 1014, 1e-6);  // blue noise: points go with area
  EXPECT_GT(x / 2, w.at("span_m") / 2 + w.at("thickness_a_m") / 2);
  EXPECT_GT(y, w.at("length_a_m"));

  const SceneSpec wedge = scene("wedge");
  const auto &groove = wedge.obstacle.shape_params, &nose = wedge.tool.shape_params;
  EXPECT_EQ(groove.at("half_angle_deg"), nose.at("half_angle_deg"));  // both sides lie flat on the walls
  EXPECT_LT(nose.at("nose_m"), groove.at("depth_m"));
  EXPECT_LT(nose.at("length_m"), groove.at("length_m"));

  for (const char* name : {"peg", "peg-round"}) {
    const SceneSpec peg = scene(name);
    EXPECT_NEAR(peg.obstacle.shape_params.at("hole_width_m") - peg.tool.shape_params.at("width_m"), 0.001, 1e-12);
    EXPECT_LT(peg.start_X_WM.p.z() + peg.tool.shape_params.at("height_m"), peg.obstacle.shape_params.at("depth_m"));
  }
  const auto& p = scene("peg").tool.shape_params;
  const double face = p.at("width_m") * p.at("height_m"), end = p.at("width_m") * p.at("width_m");
  EXPECT_NEAR(scene("peg").points * face / (4 * face + 2 * end), 178, 0.5);
}

TEST(Scenes, StoredMotionsAreWhatTheGeneratorMakes) {
  for (const auto& [name, made] : scenes::stored_motions()) {
    const HandMotion stored = load_hand_motion(std::filesystem::path(TACT_SCENES_DIR) / name);
    ASSERT_EQ(stored.time_s.size(), made.time_s.size()) << name;
    for (std::size_t i = 0; i < made.time_s.size(); ++i) {
      ASSERT_NEAR(stored.time_s[i], made.time_s[i], 1e-9) << name << " row " << i;
      ASSERT_LT(apart(stored.X_WM[i], made.X_WM[i]), 3e-6) << name << " row " << i;
    }
  }
}

TEST(Scenes, ScriptsStartAndEndAtRestAndStayWithinAHandsSpeed) {
  for (const auto& [name, motion] : scenes::stored_motions()) {
    for (std::size_t i = 1; i < motion.time_s.size(); ++i) {
      const double dt = motion.time_s[i] - motion.time_s[i - 1];
      EXPECT_LT((motion.X_WM[i].p - motion.X_WM[i - 1].p).norm() / dt, 0.16) << name;
      EXPECT_LT(motion.X_WM[i].q.angularDistance(motion.X_WM[i - 1].q) / dt, 1.0) << name;
    }
    EXPECT_LT(apart(motion.X_WM[0], motion.X_WM[1]), 1e-9) << name;
    EXPECT_LT(apart(motion.X_WM.end()[-1], motion.X_WM.end()[-2]), 1e-9) << name;
  }
}

}  // namespace
}  // namespace tact
