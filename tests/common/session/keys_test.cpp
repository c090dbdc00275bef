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
            "contact.law: found \"globl\", expected one of none global cluster adaptive-3dof adaptive-6dof potential");
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

TEST(Session, AnIntegratorIsStatedOnlyWhereSomethingIsIntegrated) {
  for (const char* kind : {"direct", "static", "dynamic"}) {
    for (const char* integrator : {"auto", "implicit", "semi-implicit"}) {
      for (const char* mode : {"impedance", "pseudo-admittance"}) {
        Session session;
        session.scene.obstacle.shape = session.scene.tool.shape = "box";
        set_key(session, "coupling.kind", kind);
        set_key(session, "coupling.integrator", integrator);
        set_key(session, "device.mode", mode);
        const bool senseless =
            std::string(mode) == "impedance" && std::string(kind) != "dynamic" && std::string(integrator) != "auto";
        const std::string said = setup_error([&] { check_session(session); });
        EXPECT_EQ(said != "no error", senseless) << mode << " " << kind << " " << integrator << ": " << said;
        if (senseless) {
          for (const char* part : {"coupling.integrator: found", "device.mode", "coupling.kind", integrator, kind}) {
            EXPECT_NE(said.find(part), std::string::npos) << said;
          }
        }
      }
    }
  }
}

/// A session is saved as TOML, which is UTF-8: what could not be read back is not taken, a file's name of old either.
TEST(SceneKey, TextThatIsNotUtf8IsRefused) {
  SceneSpec scene;
  set_scene_key(scene, "title", "Kürbis \xe2\x82\xac \xf0\x9f\x8e\x83");
  EXPECT_EQ(scene.title, "Kürbis \xe2\x82\xac \xf0\x9f\x8e\x83");
  for (const char* bad : {"\xff", "K\xfcrbis", "\xc3(", "\xe2\x82", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_NE(setup_error([&] { set_scene_key(scene, "title", bad); }).find("not UTF-8"), std::string::npos) << bad;
    EXPECT_NE(setup_error([&] { set_scene_key(scene, "tool.mesh", bad); }).find("not UTF-8"), std::string::npos) << bad;
  }
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

TEST(SessionKey, TextSetsAndRefusesKeysOfSceneMachineAndRun) {
  Session session;
  MachineSpec& machine = session.machine;
  set_key(session, "device.mode", "impedance");
  set_key(session, "device.rate_hz", "250");
  set_key(session, "view.enabled", "off");
  set_key(session, "view.bind", "::1");
  set_key(session, "contact.law", "none");
  set_key(session, "run.report", "/reports/a.json");
  EXPECT_EQ(machine.mode, "impedance");
  EXPECT_EQ(machine.rate_hz, 250);
  EXPECT_FALSE(machine.view);
  EXPECT_EQ(machine.bind, "::1");
  EXPECT_EQ(session.scene.contact.law, "none");
  EXPECT_EQ(session.run.report, "/reports/a.json");
  EXPECT_EQ(setup_error([&] { set_key(session, "transport", "tcp"); }),
            "transport: found \"tcp\", expected one of shm udp");
  EXPECT_EQ(setup_error([&] { set_key(session, "rate_hz", "500"); }),
            "rate_hz: found this unknown key, expected a known key; did you mean device.rate_hz?");
  EXPECT_NE(setup_error([&] { set_key(session, "view.port", "65536"); }), "no error");
  EXPECT_NE(setup_error([&] { set_key(session, "view.bind", "localhost"); }), "no error");
  EXPECT_NE(setup_error([&] { set_key(session, "view.token", "short"); }), "no error");
}

TEST(SessionKey, ADevicesLibraryIsANameForTheLoaderOrAPath) {
  Session session;
  set_key(session, "device.library", "libVirtuoseAPI.so");
  EXPECT_EQ(session.machine.virtuose.library, "libVirtuoseAPI.so");
  set_key(session, "device.library", "lib/../virtuoseAPI.so");
  EXPECT_EQ(session.machine.virtuose.library, (std::filesystem::current_path() / "virtuoseAPI.so").string());
  set_key(session, "device.address", "10.0.0.2#53210");
  EXPECT_EQ(session.machine.virtuose.address, "10.0.0.2#53210");
  EXPECT_NE(setup_error([&] { set_key(session, "device.address", ""); }), "no error");
  EXPECT_NE(setup_error([&] { set_key(session, "device.timeout_s", "0.2"); }), "no error");
  EXPECT_NE(setup_error([&] { set_key(session, "device.indexing", "some"); }), "no error");
}

TEST(SessionKey, AParameterMessageReachesTheSceneOnly) {
  SceneSpec scene;
  for (const char* key : {"device.rate_hz", "run.script", "run.report"}) {
    EXPECT_NE(setup_error([&] { set_scene_key(scene, key, "500"); }).find("unknown key"), std::string::npos) << key;
  }
}

TEST(RunKey, ADurationIsANumberOfSecondsOrTextWithAUnit) {
  Session session;
  const auto seconds = [&](const char* text) {
    set_key(session, "run.for_s", text);
    return session.run.for_s;
  };
  EXPECT_DOUBLE_EQ(seconds("20s"), 20);
  EXPECT_DOUBLE_EQ(seconds("1.5"), 1.5);
  EXPECT_DOUBLE_EQ(seconds("250ms"), 0.25);
  EXPECT_DOUBLE_EQ(seconds("2min"), 120);
  EXPECT_DOUBLE_EQ(seconds("1h"), 3600);
  EXPECT_DOUBLE_EQ(seconds("0"), 0);
  for (const char* wrong : {"", "s", "-1s", "nan", "inf", "20 seconds", "1e99"}) {
    EXPECT_EQ(setup_error([&] { seconds(wrong); }),
              "run.for_s: found \"" + std::string(wrong) +
                  "\", expected a time from 0 to 1e+06 s such as 500ms, 20s, 2min or 1h (0: no end of its own)");
  }
}

TEST(RunKey, OfScriptAndHandTheLastOneSaidMovesTheHand) {
  Session session;
  session.scene.scripts["press"] = {"/scenes/press.csv", "", 7};
  EXPECT_FALSE(scripted_hand(session).has_value());
  set_key(session, "run.script", "press");
  EXPECT_EQ(scripted_hand(session)->hand_csv, "/scenes/press.csv");
  EXPECT_EQ(scripted_hand(session)->hand_force_max_n, 7);
  set_key(session, "run.hand", "own.csv");
  EXPECT_TRUE(session.run.script.empty());
  EXPECT_EQ(scripted_hand(session)->hand_csv, std::filesystem::current_path() / "own.csv");
  EXPECT_EQ(scripted_hand(session)->hand_force_max_n, ScriptSpec{}.hand_force_max_n);
  set_key(session, "run.script", "press");
  EXPECT_EQ(scripted_hand(session)->hand_csv, "/scenes/press.csv");
  set_key(session, "run.script", "");
  EXPECT_FALSE(scripted_hand(session).has_value());
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
  RunSpec run;
  auto keys = session::scene_keys(scene, "/");
  session::append(keys, session::machine_keys(machine, "/"));
  session::append(keys, session::run_keys(run, "/"));
  for (const auto& key : keys) {
    EXPECT_NE(readme.str().find("`" + key.name + "`"), std::string::npos) << key.name;
  }
}

TEST(MachineKey, PlaybackNeedsARecordingThatIsThereAndNothingElseThatMovesTheHand) {
  const TempFolder folder;
  Session s;
  s.scene.obstacle.shape = s.scene.tool.shape = "box";
  s.machine.device = "playback";
  EXPECT_NE(setup_error([&] { check_session(s); }).find("device.recording: found nothing"), std::string::npos);
  s.machine.recording = folder.path() / "none.tick";
  EXPECT_NE(setup_error([&] { check_session(s); }).find("device.recording: found no file"), std::string::npos);
  s.machine.recording = folder.write("r.tick", "");
  EXPECT_EQ(setup_error([&] { check_session(s); }), "no error");
  s.run.hand_csv = folder.write("hand.csv", "");
  EXPECT_NE(setup_error([&] { check_session(s); }).find("the recording moves the handle"), std::string::npos);
  s.run.hand_csv.clear();
  s.machine.simulated.events = folder.path() / "none.csv";
  EXPECT_NE(setup_error([&] { check_session(s); }).find("device.events: found no file"), std::string::npos);
}

}  // namespace
}  // namespace tact
