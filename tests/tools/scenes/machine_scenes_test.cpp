#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "contact/bake/worker/surface.hpp"
#include "session/session.hpp"
#include "shapes/landing_gear.hpp"
#include "shapes/shapes.hpp"

namespace tact {
namespace {

/// A scene as users get it: stored files, real triangles, exact distances.
struct MachineScene {
  SceneSpec scene;
  double voxel_m = 0;
  contact::Surface obstacle;
  std::vector<Vec3> tool_points;  ///< in M: about 3 voxels apart, on the edges of parts too

  explicit MachineScene(const std::string& name)
      : MachineScene(load_scene(std::filesystem::path(TACT_SCENES_DIR) / (name + ".toml")), 0) {}

  HandMotion script(const std::string& name) const { return load_hand_motion(scene.scripts.at(name).hand_csv); }

  /// Distance of the tool's points to the obstacle; `nearest`: where. At most `cap`.
  double clearance(const Pose& X_WM, double cap, Vec3& nearest) const {
    for (const Vec3& p : tool_points) {
      const Vec3 p_W = X_WM * p;
      const double d = obstacle.distance(p_W, cap);
      if (d < cap) {
        cap = d;
        nearest = p_W;
      }
    }
    return cap;
  }

 private:
  MachineScene(SceneSpec spec, int) : MachineScene(spec, make_shape(spec.obstacle.shape, spec.obstacle.shape_params)) {}
  MachineScene(const SceneSpec& spec, const Mesh& mesh) : scene(spec), obstacle(mesh) {
    voxel_m = obstacle.size() / scene.field_resolution;
    const Mesh tool = make_shape(scene.tool.shape, scene.tool.shape_params);
    for (std::size_t i = 0; i < tool.vertices.size(); i += 3) tool_points.push_back(tool.vertices[i].cast<double>());
    for (const auto& t : tool.triangles) {
      const Vec3 a = tool.vertices[t[0]].cast<double>(), ab = tool.vertices[t[1]].cast<double>() - a,
                 ac = tool.vertices[t[2]].cast<double>() - a;
      const double longest = std::max({ab.norm(), ac.norm(), (ab - ac).norm()});
      const int n = std::min(20, static_cast<int>(longest / (3 * voxel_m)));
      for (int i = 0; n > 1 && i <= n; ++i) {
        for (int j = 0; i + j <= n; ++j) tool_points.push_back(a + (ab * i + ac * j) / n);
      }
    }
  }
};

void expect_clear(const MachineScene& s) {
  const HandMotion insert = s.script("insert");
  double least = 1;
  for (std::size_t i = 0; i < insert.X_WM.size(); i += 20) {
    Vec3 where;
    least = std::min(least, s.clearance(insert.X_WM[i], std::min(least, 4 * s.voxel_m), where));
  }
  testing::Test::RecordProperty("clearance_voxels", std::to_string(least / s.voxel_m));
  EXPECT_GT(least / s.voxel_m, 1.2);
}

/// The straight way meets `thin` parts, and nothing else.
template <class Thin>
void expect_only_thin_parts_in_the_way(const MachineScene& s, const Thin& thin) {
  const HandMotion cheat = s.script("cheat");
  int touching = 0;
  for (std::size_t i = 0; i < cheat.X_WM.size(); i += 10) {
    for (const Vec3& p : s.tool_points) {
      const Vec3 p_W = cheat.X_WM[i] * p;
      if (thin(p_W)) {
        touching += s.obstacle.distance(p_W, 0.3 * s.voxel_m) < 0.3 * s.voxel_m;
      } else {
        ASSERT_GE(s.obstacle.distance(p_W, s.voxel_m), s.voxel_m) << cheat.time_s[i] << " s, " << p_W.transpose();
      }
    }
  }
  EXPECT_GT(touching, 100);
}

TEST(EngineScene, StarterGoesInWithMoreThanAVoxelOfRoomAndTheStraightWayIsBarredByCablesAlone) {
  const MachineScene s("engine");
  EXPECT_NEAR(s.voxel_m, 0.9e-3, 0.01e-3);
  EXPECT_EQ(s.scene.points, 56823);
  expect_clear(s);  // measured: 1.9 at the seat, 3.4 in the passage
  expect_only_thin_parts_in_the_way(s, [](const Vec3& p) { return std::abs(p.y() + 0.152) < 0.006; });  // the loom
}

TEST(LandingGearScene, ActuatorGoesInWithMoreThanAVoxelOfRoomAndTheStraightWayIsBarredByWiresAlone) {
  const MachineScene s("landing-gear");
  EXPECT_NEAR(s.voxel_m, 2.8e-3, 0.01e-3);
  EXPECT_EQ(s.scene.points, 38148);
  expect_clear(s);  // measured: 1.25 over the lugs, 2.3 between the wires
  const Vec3 passage = shapes::LandingGear::passage_centre(), in = shapes::LandingGear::approach();
  expect_only_thin_parts_in_the_way(s, [&](const Vec3& p) { return std::abs((p - passage).dot(in)) < 0.012; });
}

TEST(MachineScenes, ThinPartsAreAsManyVoxelsThickAsThePaperSays) {
  const auto thickness = [](const std::string& shape, const std::string& param, double size_m) {
    for (const auto& info : all_shapes()) {
      if (info.name != shape) continue;
      for (const auto& p : info.params) {
        if (p.name == param) return p.value / (size_m / 1024);
      }
    }
    return 0.0;
  };
  EXPECT_NEAR(thickness("engine-bay", "cable_m", 0.92), 3, 0.01);
  EXPECT_NEAR(thickness("landing-gear", "wire_m", 2.87), 2, 0.01);
}

}  // namespace
}  // namespace tact
