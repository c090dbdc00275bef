#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "common/session/temp_folder.hpp"
#include "session/scene_keys.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

TEST(SceneKey, TextSetsEveryKindOfValue) {
  SceneSpec scene;
  set_scene_key(scene, "contact.law", "global");
  set_scene_key(scene, "contact.stiffness_n_per_m", "500");
  set_scene_key(scene, "coupling.saturation", "off");
  set_scene_key(scene, "coupling.rotation", "locked");
  set_scene_key(scene, "tool.points", "25269");
  set_scene_key(scene, "start.position_m", "0.1, -0.2,3e-1");
  set_scene_key(scene, "goal.rotation_wxyz", "0,1,0,0");
  set_scene_key(scene, "obstacle.params.height_m", "0.02");
  EXPECT_EQ(scene.contact.law, "global");
  EXPECT_EQ(scene.contact.stiffness_n_per_m, 500);
  EXPECT_FALSE(scene.coupling.saturation);
  EXPECT_TRUE(scene.coupling.rotation_locked);
  EXPECT_EQ(scene.points, 25269);
  EXPECT_EQ(scene.start_X_WM.p, Vec3(0.1, -0.2, 0.3));
  ASSERT_TRUE(scene.goal_X_WM.has_value());
  EXPECT_EQ(scene.goal_X_WM->q.x(), 1);
  EXPECT_EQ(scene.obstacle.shape_params.at("height_m"), 0.02);
}

TEST(SceneKey, RefusedTextChangesNothingAndSaysWhatIsExpected) {
  SceneSpec scene;
  EXPECT_EQ(setup_error([&] { set_scene_key(scene, "contact.law", "globl"); }),
            "contact.law: found \"globl\", expected one of none global adaptive-3dof adaptive-6dof potential");
  EXPECT_EQ(setup_error([&] { set_scene_key(scene, "tool.points", "-3"); }),
            "tool.points: found \"-3\", expected a whole number from 100 to 1000000");
  for (const char* bad : {"", "x", "nan", "inf", "1e9", "-1", "5 N", "0x10"}) {
    EXPECT_NE(setup_error([&] { set_scene_key(scene, "contact.stiffness_n_per_m", bad); }), "no error") << bad;
  }
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "tool.points", "200.5"); }), "no error");
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "coupling.saturation", "maybe"); }), "no error");
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "start.position_m", "1,2"); }), "no error");
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "start.position_m", "1,2,nan"); }), "no error");
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "start.rotation_wxyz", "1,1,0,0"); }), "no error");
  EXPECT_EQ(scene.contact.law, "potential");
  EXPECT_EQ(scene.points, SceneSpec{}.points);
  EXPECT_TRUE(scene.coupling.saturation);
}

TEST(SceneKey, UnknownKeyNamesTheNearestOne) {
  SceneSpec scene;
  EXPECT_EQ(setup_error([&] { set_scene_key(scene, "contact.lav", "none"); }),
            "contact.lav: found this unknown key, expected a known key; did you mean contact.law?");
  EXPECT_EQ(setup_error([&] { set_scene_key(scene, "saturation", "on"); }),
            "saturation: found this unknown key, expected a known key; did you mean coupling.saturation?");
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "zzzzzz", "1"); }).find("README"), std::string::npos);
  EXPECT_NE(setup_error([&] { set_scene_key(scene, "scripts.solve.hnad", "a.csv"); }).find("scripts.solve.hand?"),
            std::string::npos);
  EXPECT_TRUE(scene.scripts.empty());
}

TEST(SceneKey, TheLastSaidOfTwoThatExcludeEachOtherHolds) {
  SceneSpec scene;
  set_scene_key(scene, "contact.stiffness_n_per_m", "500");
  set_scene_key(scene, "contact.f_max_n", "12");
  EXPECT_EQ(scene.contact.stiffness_n_per_m, 0);
  scene.tool.shape = "alpha";
  scene.tool.shape_params["lift_m"] = 0.1;
  set_scene_key(scene, "tool.mesh", "/tmp/some.obj");
  EXPECT_TRUE(scene.tool.shape.empty());
  EXPECT_TRUE(scene.tool.shape_params.empty());
  set_scene_key(scene, "tool.unit", "mm");
  set_scene_key(scene, "tool.shape", "box");
  EXPECT_TRUE(scene.tool.mesh.empty());
  EXPECT_TRUE(scene.tool.unit.empty());
}

TEST(MachineKey, TextSetsAndRefuses) {
  MachineSpec machine;
  set_machine_key(machine, "device.mode", "impedance");
  set_machine_key(machine, "device.rate_hz", "250");
  set_machine_key(machine, "view.enabled", "off");
  set_machine_key(machine, "view.bind", "::1");
  EXPECT_EQ(machine.mode, "impedance");
  EXPECT_EQ(machine.rate_hz, 250);
  EXPECT_FALSE(machine.view);
  EXPECT_EQ(machine.bind, "::1");
  EXPECT_EQ(setup_error([&] { set_machine_key(machine, "transport", "tcp"); }),
            "transport: found \"tcp\", expected one of shm udp");
  EXPECT_NE(setup_error([&] { set_machine_key(machine, "view.port", "65536"); }), "no error");
  EXPECT_NE(setup_error([&] { set_machine_key(machine, "view.bind", "localhost"); }), "no error");
  EXPECT_NE(setup_error([&] { set_machine_key(machine, "view.token", "short"); }), "no error");
  EXPECT_NE(setup_error([&] { set_machine_key(machine, "contact.law", "none"); }), "no error");
}

TEST(Readme, DocumentsEveryKey) {
  std::ifstream in(TACT_SOURCE_DIR "/common/session/README.md");
  std::stringstream readme;
  readme << in.rdbuf();
  SceneSpec scene;
  session::make_room(scene, "scripts.NAME.hand");
  scene.scripts["NAME"];
  scene.obstacle.shape_params["NAME"] = scene.tool.shape_params["NAME"] = 0;
  MachineSpec machine;
  auto keys = session::scene_keys(scene, "/");
  session::append(keys, session::machine_keys(machine, "/"));
  for (const auto& key : keys) {
    EXPECT_NE(readme.str().find("`" + key.name + "`"), std::string::npos) << key.name;
  }
}

}  // namespace
}  // namespace tact
