#include <gtest/gtest.h>

#include <climits>

#include "common/session/temp_folder.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

constexpr const char* kMinimal = "[obstacle]\nshape = \"box\"\n[tool]\nshape = \"cone\"\n";

std::string load_error(const std::string& content) {
  TempFolder folder;
  const auto file = folder.write("scene.toml", content);
  std::string text = setup_error([&] { load_scene(file); });
  const std::string prefix = folder.path().string() + "/";
  for (auto at = text.find(prefix); at != text.npos; at = text.find(prefix)) text.erase(at, prefix.size());
  return text;
}

TEST(Scene, LoadsWithDefaultsAndTakesItsNameFromTheFile) {
  TempFolder folder;
  const SceneSpec scene = load_scene(folder.write("two-boxes.toml", kMinimal));
  EXPECT_EQ(scene.name, "two-boxes");
  EXPECT_EQ(scene.file, folder.path() / "two-boxes.toml");
  EXPECT_EQ(scene.contact.law, "potential");
  EXPECT_FALSE(scene.goal_X_WM.has_value());
}

TEST(Scene, ReadsTablesScriptsAndParameters) {
  TempFolder folder;
  folder.write("press.csv", "");
  const SceneSpec scene = load_scene(folder.write("s.toml", std::string(kMinimal) + R"(
[obstacle.params]
size_x_m = 1
size_y_m = 0.25
[start]
position_m = [0, 1, 2.5]
[contact]
stiffness_n_per_m = 4000
[scripts.press]
hand = "press.csv"
description = "down"
hand_force_max_n = 12
)"));
  EXPECT_EQ(scene.obstacle.shape_params.at("size_x_m"), 1);
  EXPECT_EQ(scene.start_X_WM.p, Vec3(0, 1, 2.5));
  EXPECT_EQ(scene.contact.stiffness_n_per_m, 4000);
  EXPECT_EQ(scene.scripts.at("press").hand_csv, folder.path() / "press.csv");
  EXPECT_EQ(scene.scripts.at("press").hand_force_max_n, 12);
}

TEST(Scene, MeshPathsAreRelativeToTheSceneFile) {
  TempFolder folder;
  folder.write("part.stl", "x");
  const SceneSpec scene =
      load_scene(folder.write("s.toml", "obstacle = { mesh = \"../" + folder.path().filename().string() +
                                            "/part.stl\", unit = \"mm\" }\ntool.shape = \"cone\"\n"));
  EXPECT_EQ(scene.obstacle.mesh, folder.path() / "part.stl");
}

TEST(Scene, EveryMistakeIsOneErrorNamingFileKeyFoundAndExpected) {
  const std::string m = kMinimal;
  EXPECT_EQ(
      load_error(m + "[contact]\nlow = \"none\"\n"),
      "scene.toml: contact.low: found this unknown key at line 6, expected a known key; did you mean contact.law?");
  EXPECT_EQ(
      load_error("[contatc]\nlaw = \"none\"\n"),
      "scene.toml: contatc.law: found this unknown key at line 2, expected a known key; did you mean contact.law?");
  EXPECT_EQ(load_error(m + "[contact]\nlaw = 3\n"),
            "scene.toml: contact.law: found 3 at line 6, expected one of none global cluster adaptive-3dof "
            "adaptive-6dof potential");
  EXPECT_EQ(load_error(m + "points = 5\n"),
            "scene.toml: tool.points: found 5 at line 5, expected a whole number from 100 to 1000000");
  EXPECT_EQ(load_error(m + "points = 500.0\n"),
            "scene.toml: tool.points: found 500.0 at line 5, expected a whole number from 100 to 1000000");
  EXPECT_EQ(load_error(m + "points = \"many\"\n"),
            "scene.toml: tool.points: found \"many\" at line 5, expected a whole number from 100 to 1000000");
  EXPECT_EQ(load_error(m + "points = 2022-01-01\n"),
            "scene.toml: tool.points: found a date or time at line 5, expected a whole number from 100 to 1000000");
  EXPECT_EQ(load_error(m + "[coupling]\nmass_kg = nan\n"),
            "scene.toml: coupling.mass_kg: found nan at line 6, expected a number from 0.001 to 20 (kg)");
  EXPECT_EQ(load_error(m + "[coupling]\nmass_kg = true\n"),
            "scene.toml: coupling.mass_kg: found true at line 6, expected a number from 0.001 to 20 (kg)");
  EXPECT_EQ(load_error(m + "[start]\nposition_m = [1, \"a\", 2]\n"),
            "scene.toml: start.position_m: found a list that is not of numbers at line 6, "
            "expected three numbers [x, y, z] within 10 km (m)");
  EXPECT_EQ(load_error(m + "[start]\nrotation_wxyz = [1, 1, 0, 0]\n"),
            "scene.toml: start.rotation_wxyz: found [1, 1, 0, 0] at line 6, "
            "expected four numbers [w, x, y, z] of norm 1 within 0.001");
  EXPECT_EQ(load_error(m + "[contact]\nstiffness_n_per_m = 1\nf_max_n = 10\n"),
            "scene.toml: contact.stiffness_n_per_m: found f_max_n stated as well, "
            "expected one of them: F_max = k x_max links them");
  EXPECT_EQ(load_error(m + "points = 500\nspacing_voxels = 2\n"),
            "scene.toml: tool.spacing_voxels: found points stated as well, "
            "expected one of them: both say how dense the pointshell is");
  EXPECT_EQ(load_error("obstacle.shape = \"box\"\n"),
            "scene.toml: tool: found neither shape nor mesh, expected one of them");
  EXPECT_EQ(load_error(m + "mesh = \"a.obj\"\n"), "scene.toml: tool: found both shape and mesh, expected one of them");
  EXPECT_EQ(load_error(m + "unit = \"mm\"\n"),
            "scene.toml: tool.unit: found a unit, expected none: shapes are in metres");
  EXPECT_EQ(load_error("obstacle.mesh = \"a.obj\"\ntool.shape = \"box\"\n"),
            "scene.toml: obstacle.unit: found nothing, expected one of m mm cm inch: the unit of the mesh file");
  EXPECT_EQ(load_error("obstacle.mesh = \"a.obj\"\nobstacle.unit = \"feet\"\n"),
            "scene.toml: obstacle.unit: found \"feet\" at line 2, expected one of m mm cm inch");
  EXPECT_EQ(load_error("obstacle = {mesh = \"no.obj\", unit = \"mm\"}\ntool.shape = \"box\"\n"),
            "scene.toml: obstacle.mesh: found no file \"no.obj\", expected an existing file");
  EXPECT_EQ(load_error(m + "[scripts.go]\nhand = \"no.csv\"\n"),
            "scene.toml: scripts.go.hand: found no file \"no.csv\", expected an existing file");
  EXPECT_EQ(load_error(m + "[scripts.go]\ndescription = \"x\"\n"),
            "scene.toml: scripts.go.hand: found nothing, expected a path to a CSV file of poses");
  EXPECT_EQ(load_error(m + "[scripts.Go]\nhand = \"no.csv\"\n").find("scene.toml: scripts.Go.hand: found this unknown"),
            0u);
  EXPECT_EQ(load_error("title = \"a\"\ntitle = \"b\"\n").find("scene.toml: line 2: found "), 0u);
  EXPECT_EQ(load_error("title = \n").find("scene.toml: line 1: found "), 0u);
  EXPECT_EQ(load_error(std::string("\xff\xfe\x00", 3)).find("scene.toml: line 1: found "), 0u);
  EXPECT_EQ(load_error(""), "scene.toml: obstacle: found neither shape nor mesh, expected one of them");
}

/// Small files that made the loader run out of stack or memory, or compare for minutes.
TEST(Scene, HostileFilesAreOneShortErrorAtOnce) {
  const auto times = [](int n, const std::string& text) {
    std::string out;
    while (n-- > 0) out += text;
    return out;
  };
  const std::string m = kMinimal;
  EXPECT_EQ(load_error(m + times(60000, "a.") + "a = 1\n"),
            "scene.toml: line 5: found more than 64 dots, expected shorter keys or text");
  EXPECT_EQ(load_error(m + "[" + times(60000, "a.") + "a]\nb = 1\n"),
            "scene.toml: line 5: found more than 64 dots, expected shorter keys or text");
  EXPECT_EQ(load_error(m + "x = [\n" + times(200, "{" + times(60, "a.") + "a = [\n")).find("scene.toml: line "), 0u);
  EXPECT_EQ(load_error(m + times(20, "a.") + "a = 1\n"),
            "scene.toml: tool." + times(14, "a.") +
                "a: found more than 16 tables within each other at line 5, "
                "expected a known key");
  EXPECT_EQ(load_error(times(200000, "#")), "scene.toml: found more than 128 KiB, expected a configuration, not data");
  EXPECT_EQ(load_error(times(120000, "a") + " = 1\n"),
            "scene.toml: " + times(120, "a") +
                "... (120000 bytes): found this unknown key at line 1, expected a known key (they are listed in "
                "common/session/README.md)");
  EXPECT_EQ(load_error("\"a\\nb\" = 1\n").find("scene.toml: a\\x0ab: found this unknown key"), 0u);
  EXPECT_EQ(load_error("tool.shape = \"" + times(65, "a") + "\"\n").find("scene.toml: tool.shape: found \""), 0u);
  EXPECT_EQ(load_error("title = \"" + times(1001, "a") + "\"\n").find("scene.toml: title: found \""), 0u);
  EXPECT_EQ(load_error("title = 1\n" + times(3000, "title = 1\n")).find("scene.toml: line 2: found "), 0u);
  EXPECT_EQ(load_error("tool.mesh = \"" + times(120000, "#") + "\"\n").find("scene.toml: tool.mesh: found \"####"), 0u);
  EXPECT_EQ(load_error(m + "params.\"" + times(60000, "\\n") + "\" = 1\n").size() < 1000, true);
  std::string many = "tool.shape = \"box\"\n";
  for (int i = 0; i < 3500; ++i) many += "scripts.a" + std::to_string(i) + ".hand_force_max_n = 1\n";
  EXPECT_EQ(load_error(many), "scene.toml: obstacle: found neither shape nor mesh, expected one of them");
}

/// A path that was short enough in the scene file must not be too long once it is absolute.
TEST(Scene, APathNoSystemCallTakesIsRefusedWhereItStands) {
  TempFolder folder;
  const std::string absolute = folder.path().string() + "/";
  const std::string longest(PATH_MAX - 1 - absolute.size(), 'a');
  const auto error = [&](const std::string& path) {
    return load_error("tool.shape = \"box\"\nobstacle = { unit = \"m\", mesh = \"" + path + "\" }\n");
  };
  EXPECT_EQ(error(longest).find("scene.toml: obstacle.mesh: found no file \""), 0u);
  EXPECT_EQ(error(longest + "a").find("scene.toml: obstacle.mesh: found \"aaaa"), 0u);
}

TEST(Scene, MissingFileAndFolderAreNamed) {
  TempFolder folder;
  EXPECT_EQ(setup_error([&] { load_scene("/nowhere/a.toml"); }),
            "/nowhere/a.toml: found no such file, expected a readable TOML file");
  EXPECT_EQ(setup_error([&] { load_scene(folder.path()); }),
            folder.path().string() + ": found something that is not a file, expected a readable TOML file");
}

TEST(Scene, FileNameThatIsNoSceneNameIsRefused) {
  TempFolder folder;
  const auto file = folder.write("My Scene.toml", kMinimal);
  EXPECT_EQ(setup_error([&] { load_scene(file); }),
            file.string() + ": name: found \"My Scene\", expected 1 to 24 of the characters a-z, 0-9 and -");
}

TEST(Machine, LoadsAndRefuses) {
  TempFolder folder;
  Session session;
  load_machine(folder.write("m.toml",
                            "transport = \"udp\"\n[device]\nmode = \"impedance\"\n[view]\nport = 0\n"
                            "[cache]\ndir = \"c\"\n"),
               session);
  const MachineSpec& m = session.machine;
  EXPECT_EQ(m.transport, "udp");
  EXPECT_EQ(m.port, 0);
  EXPECT_EQ(m.cache_dir, folder.path() / "c");
  const auto bad = folder.write("bad.toml", "[device]\nrate = 1000\n");
  EXPECT_EQ(setup_error([&] { load_machine(bad, session); }), bad.string() +
                                                                  ": device.rate: found this unknown key at line 2, "
                                                                  "expected a known key; did you mean device.rate_hz?");
}

TEST(Machine, TheDefaultFileSaysWhatTheProgramDoesAnyway) {
  Session session;
  load_machine(TACT_SOURCE_DIR "/deploy/machines/default.toml", session);
  const MachineSpec& m = session.machine;
  const MachineSpec d;
  EXPECT_EQ(m.device, d.device);
  EXPECT_EQ(m.mode, d.mode);
  EXPECT_EQ(m.rate_hz, d.rate_hz);
  EXPECT_EQ(m.transport, d.transport);
  EXPECT_EQ(m.force_limit_n, d.force_limit_n);
  EXPECT_EQ(m.torque_limit_nm, d.torque_limit_nm);
  EXPECT_EQ(m.force_slope_n_per_s, d.force_slope_n_per_s);
  EXPECT_EQ(m.torque_slope_nm_per_s, d.torque_slope_nm_per_s);
  EXPECT_EQ(m.cpu_coupling, d.cpu_coupling);
  EXPECT_EQ(m.cpu_contact, d.cpu_contact);
  EXPECT_EQ(m.view, d.view);
  EXPECT_EQ(m.port, d.port);
  EXPECT_EQ(m.bind, d.bind);
}

constexpr const char* kPress = "[scripts.press]\nhand = \"press.csv\"\n";

TEST(RunTable, OfASceneFileSaysWhatIsPlayedWithPathsRelativeToTheFile) {
  TempFolder folder;
  folder.write("press.csv", "");
  Session session;
  load_scene(
      folder.write("s.toml", std::string(kMinimal) + kPress +
                                 "[run]\nscript = \"press\"\nfor_s = 2.5\nreport = \"r.json\"\nplot = \"/p.png\"\n"),
      session);
  EXPECT_EQ(session.run.script, "press");
  EXPECT_EQ(session.run.for_s, 2.5);
  EXPECT_EQ(session.run.report, folder.path() / "r.json");
  EXPECT_EQ(session.run.plot, "/p.png");
  EXPECT_EQ(scripted_hand(session)->hand_csv, folder.path() / "press.csv");
}

TEST(RunTable, OfAMachineFileStandsAboveTheSceneFiles) {
  TempFolder folder;
  folder.write("press.csv", "");
  folder.write("own.csv", "");
  Session session;
  load_scene(folder.write("s.toml", std::string(kMinimal) + kPress + "[run]\nscript = \"press\"\nfor_s = 3\n"),
             session);
  load_machine(folder.write("m.toml", "[run]\nhand = \"own.csv\"\nreport = \"out/r.json\"\n"), session);
  EXPECT_TRUE(session.run.script.empty());
  EXPECT_EQ(session.run.hand_csv, folder.path() / "own.csv");
  EXPECT_EQ(session.run.for_s, 3);
  EXPECT_EQ(session.run.report, folder.path() / "out" / "r.json");
}

TEST(RunTable, EveryMistakeIsOneErrorNamingFileKeyFoundAndExpected) {
  const std::string m = kMinimal;
  EXPECT_EQ(load_error(m + "[run]\nscript = 3\n"),
            "scene.toml: run.script: found 3 at line 6, expected the name of a script of the scene, or \"\" for none");
  EXPECT_EQ(load_error(m + "[run]\nscript = \"a\"\nhand = \"b.csv\"\n"),
            "scene.toml: run.hand: found run.script stated as well, expected one of them: both move the hand");
  EXPECT_EQ(load_error(m + "[run]\nfor_s = \"soon\"\n"),
            "scene.toml: run.for_s: found \"soon\" at line 6, "
            "expected a time from 0 to 1e+06 s such as 500ms, 20s, 2min or 1h (0: no end of its own)");
  EXPECT_EQ(load_error(m + "[run]\nreport = true\n"),
            "scene.toml: run.report: found true at line 6, expected a path to a JSON file");
  EXPECT_EQ(load_error(m + "[run]\nraport = \"a\"\n"),
            "scene.toml: run.raport: found this unknown key at line 6, expected a known key; did you mean run.report?");
}

TEST(RunTable, AScriptOrHandThatIsNotThereIsNamedWithTheFileThatSaysSo) {
  TempFolder folder;
  folder.write("press.csv", "");
  Session session;
  const auto scene = folder.write("s.toml", std::string(kMinimal) + kPress + "[run]\nhand = \"no.csv\"\n");
  load_scene(scene, session);
  EXPECT_EQ(setup_error([&] { check_session(session); }), scene.string() + ": run.hand: found no file \"" +
                                                              (folder.path() / "no.csv").string() +
                                                              "\", expected an existing file");
  const auto machine = folder.write("m.toml", "[run]\nscript = \"fly\"\n");
  load_machine(machine, session);
  EXPECT_EQ(setup_error([&] { check_session(session); }),
            machine.string() + ": run.script: found \"fly\", expected one of press");
}

TEST(RunTable, WhatTheCommandLineSaysReplacesWhatNeverWasThere) {
  TempFolder folder;
  folder.write("press.csv", "");
  Session session;
  load_scene(folder.write("s.toml", std::string(kMinimal) + kPress + "[run]\nhand = \"no.csv\"\n"), session);
  load_machine(folder.write("m.toml", "[run]\nscript = \"fly\"\n"), session);
  set_key(session, "run.script", "press");
  check_session(session);
  set_key(session, "run.script", "jump");
  EXPECT_EQ(setup_error([&] { check_session(session); }), "run.script: found \"jump\", expected one of press");
}

TEST(Scene, ReachMustSpanAFewDirections) {
  const std::string error = load_error(std::string(kMinimal) + "[contact]\nreach_deg = 30\n");
  EXPECT_NE(error.find("contact.reach_deg: found 30, expected 39 or more with 64 directions"), std::string::npos)
      << error;
  EXPECT_EQ(load_error(std::string(kMinimal) + "[contact]\nreach_deg = 30\ndirections = 162\n"), "no error");
}

}  // namespace
}  // namespace tact
