#include "cli/run_options.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "fault/fault.hpp"

namespace tact::cli {
namespace {
namespace fs = std::filesystem;

class RunOptionsTest : public ::testing::Test {
 protected:
  RunOptionsTest() { fs::create_directories(folder_); }
  ~RunOptionsTest() override { fs::remove_all(folder_); }

  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// A scene of our own with a script that ends at (0, 0, 0.2).
  RunOptions options() {
    write("hand.csv", "time_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0.1,1,0,0,0\n2,0,0,0.2,1,0,0,0\n");
    RunOptions o;
    o.scene = write("little.toml",
                    "name = \"little\"\n[obstacle]\nshape = \"box\"\n[tool]\nshape = \"box\"\n"
                    "[contact]\nlaw = \"global\"\n[scripts.lift]\nhand = \"hand.csv\"\nhand_force_max_n = 7\n")
                  .string();
    return o;
  }
  static std::string error_of(const RunOptions& o) {
    try {
      resolve(o);
    } catch (const SetupError& e) {
      return e.what();
    }
    return "no error";
  }
  static void expect_words(const std::string& text, std::initializer_list<const char*> words) {
    for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << " in: " << text;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("tact_options_" + std::to_string(::getpid()));
};

TEST_F(RunOptionsTest, SettingsStandAboveFilesAndTheLastOneHolds) {
  RunOptions o = options();
  o.machine_file = write("machine.toml", "transport = \"udp\"\n[device]\nrate_hz = 2000\n");
  EXPECT_EQ(resolve(o).scene.contact.law, "global");
  o.settings = {{"--law", "contact.law", "none"},
                {"--set", "contact.law", "adaptive-6dof"},
                {"--saturation", "coupling.saturation", "off"},
                {"--rate", "device.rate_hz", "500"},
                {"--view", "view.enabled", "off"}};
  const Session session = resolve(o);
  EXPECT_EQ(session.scene.contact.law, "adaptive-6dof");
  EXPECT_FALSE(session.scene.coupling.saturation);
  EXPECT_EQ(session.machine.rate_hz, 500);
  EXPECT_EQ(session.machine.transport, "udp");
  EXPECT_FALSE(session.machine.view);
}

TEST_F(RunOptionsTest, AScriptBringsItsHandAndItsLastPoseIsTheGoal) {
  RunOptions o = options();
  o.settings = {{"--script", "run.script", "lift"}};
  const Session session = resolve(o);
  EXPECT_EQ(scripted_hand(session)->hand_csv, folder_ / "hand.csv");
  EXPECT_EQ(scripted_hand(session)->hand_force_max_n, 7);
  ASSERT_TRUE(session.scene.goal_X_WM);
  EXPECT_EQ(session.scene.goal_X_WM->p.z(), 0.2);
}

TEST_F(RunOptionsTest, AHandFileSaysWhereTheToolStartsAndWhereItShouldArrive) {
  RunOptions o = options();
  o.settings = {{"--hand", "run.hand", folder_ / "hand.csv"}};
  const Session session = resolve(o);
  EXPECT_EQ(session.scene.start_X_WM.p.z(), 0.1);
  EXPECT_EQ(session.scene.goal_X_WM->p.z(), 0.2);
}

TEST_F(RunOptionsTest, TheCommandLineStandsAboveTheRunTablesOfMachineAndScene) {
  RunOptions o = options();
  std::ofstream(o.scene, std::ios::app) << "[run]\nscript = \"lift\"\nfor_s = 3\nreport = \"scene.json\"\n";
  o.machine_file = write("machine.toml", "[run]\nreport = \"machine.json\"\nplot = \"machine.png\"\n");
  o.settings = {{"--for", "run.for_s", "2min"}, {"--plot", "run.plot", "here.png"}};
  const Session session = resolve(o);
  EXPECT_EQ(session.run.script, "lift");
  EXPECT_EQ(session.run.for_s, 120);
  EXPECT_EQ(session.run.report, folder_ / "machine.json");
  EXPECT_EQ(session.run.plot, fs::current_path() / "here.png");
  EXPECT_EQ(session.scene.goal_X_WM->p.z(), 0.2);
}

TEST_F(RunOptionsTest, AnUnknownScriptIsAnsweredWithTheKnownOnes) {
  RunOptions o = options();
  o.settings = {{"--script", "run.script", "fly"}};
  expect_words(error_of(o), {"run.script", "fly", "lift"});
}

TEST_F(RunOptionsTest, OwnMeshesNeedNoSceneButAUnit) {
  RunOptions o;
  o.obstacle = write("a.stl", "solid a\nendsolid a\n");
  expect_words(error_of(o), {"scene", "--tool"});
  o.tool = write("b.stl", "solid b\nendsolid b\n");
  expect_words(error_of(o), {"--unit", "mm"});
  o.unit = "furlong";
  expect_words(error_of(o), {"unit", "furlong", "inch"});
  o.unit = "mm";
  const Session session = resolve(o);
  EXPECT_EQ(session.scene.obstacle.mesh, o.obstacle);
  EXPECT_EQ(session.scene.tool.unit, "mm");
  EXPECT_EQ(session.scene.name, "own");
}

TEST_F(RunOptionsTest, OneOwnMeshReplacesThatBodyOfAScene) {
  RunOptions o = options();
  o.tool = write("b.stl", "solid b\nendsolid b\n");
  o.unit = "cm";
  const Session session = resolve(o);
  EXPECT_EQ(session.scene.tool.mesh, o.tool);
  EXPECT_TRUE(session.scene.tool.shape.empty());
  EXPECT_EQ(session.scene.obstacle.shape, "box");
}

TEST_F(RunOptionsTest, AUnitWithoutAMeshIsRefused) {
  RunOptions o = options();
  o.unit = "mm";
  expect_words(error_of(o), {"--unit"});
}

TEST_F(RunOptionsTest, AWrongSettingNamesOptionAndKey) {
  RunOptions o = options();
  o.settings = {{"--law", "contact.law", "magic"}};
  expect_words(error_of(o), {"--law", "contact.law", "magic", "potential"});
  o.settings = {{"--rate", "device.rate_hz", "fast"}};
  expect_words(error_of(o), {"--rate", "device.rate_hz", "fast"});
}

TEST_F(RunOptionsTest, SessionNamesDifferUnlessGivenAndAreChecked) {
  RunOptions o = options();
  const Session first = resolve(o), second = resolve(o);
  EXPECT_EQ(first.name.rfind("little-", 0), 0u);
  EXPECT_NE(first.name, second.name);
  EXPECT_NE(first.id, second.id);
  EXPECT_NE(first.machine.token, second.machine.token);
  o.session = "Mine!";
  expect_words(error_of(o), {"--session", "Mine!"});
}

TEST_F(RunOptionsTest, TheResolvedSessionSurvivesItsFile) {
  RunOptions o = options();
  o.settings = {{"--script", "run.script", "lift"},
                {"--for", "run.for_s", "250ms"},
                {"--stiffness", "contact.stiffness_n_per_m", "1234.5"}};
  Session session = resolve(o);
  session.run_dir = folder_;
  save_session(session, folder_ / "session.toml");
  const Session read = load_session(folder_ / "session.toml");
  EXPECT_EQ(read.name, session.name);
  EXPECT_EQ(read.id, session.id);
  EXPECT_EQ(read.scene.contact.stiffness_n_per_m, 1234.5);
  EXPECT_EQ(read.machine.token, session.machine.token);
  EXPECT_EQ(read.run.script, "lift");
  EXPECT_EQ(read.run.for_s, 0.25);
}

TEST(SetOption, IsKeyEqualsValue) {
  const Setting s = parse_set("obstacle.mesh=a=b.stl");
  EXPECT_EQ(s.key, "obstacle.mesh");
  EXPECT_EQ(s.value, "a=b.stl");
  EXPECT_THROW(parse_set("contact.p"), SetupError);
  EXPECT_THROW(parse_set("=3"), SetupError);
}

}  // namespace
}  // namespace tact::cli
