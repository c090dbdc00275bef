#include <gtest/gtest.h>

#include <sys/stat.h>

#include <tuple>

#include "common/session/temp_folder.hpp"
#include "session/scene_keys.hpp"
#include "session/session.hpp"

namespace tact {
namespace {

Session full_session(const TempFolder& folder) {
  Session s;
  s.name = "alpha-1";
  s.id = 0xfedcba9876543210u;  // beyond a TOML integer
  s.run_dir = folder.path();
  s.run.hand_csv = folder.write("h \"odd\"\\name.csv", "");
  s.run.for_s = 0.1 + 0.2;
  s.run.report = "/reports/r.json";
  s.run.plot = "/reports/p.png";
  s.run.record = "/reports/r.tick";
  s.scene.name = "alpha";
  s.scene.title = "Two \"alphas\" \xce\xb1";
  s.scene.file = "/scenes/alpha.toml";
  s.scene.obstacle.shape = "alpha";
  s.scene.obstacle.shape_params = {{"length_m", 0.1 + 0.2}, {"turn_deg", 30}};
  s.scene.tool.mesh = folder.write("tool.stl", "");
  s.scene.tool.unit = "inch";
  s.scene.tool.sheet_thickness_m = 1e-4;
  s.scene.field_resolution = 512;
  s.scene.field_error_mm = 0.125;
  s.scene.points = 25269;
  s.scene.spacing_voxels = 1.25;
  s.scene.levels = 6;
  s.scene.X_WO = {Vec3(1.0 / 3, -2.0 / 7, 1e-9), Quat(0.1, 0.2, -0.3, 0.4).normalized()};
  s.scene.start_X_WM = {Vec3(0.5, 0, -0.25), Quat(-0.9, 0.2, 0.3, 0.1).normalized()};
  s.scene.goal_X_WM = Pose{Vec3(3, 2, 1), Quat(0, 0, 1, 0)};
  s.scene.goal_distance_mm = 1.5;
  s.scene.goal_angle_deg = 2.5;
  s.scene.contact.law = "adaptive-6dof";
  s.scene.contact.stiffness_n_per_m = 1234.5;
  s.scene.contact.f_max_n = 7;
  s.scene.contact.force_along = "normal";
  s.scene.contact.directions = 42;
  s.scene.contact.lever_unit_m = 0.2;
  s.scene.contact.cluster_voxels = 1.5;
  s.scene.contact.cluster_law = "potential";
  s.scene.coupling.saturation = false;
  s.scene.coupling.rotation_locked = true;
  s.scene.coupling.kind = "static";
  s.scene.coupling.integrator = "semi-implicit";
  s.scene.coupling.passivity_controller = true;
  s.scene.coupling.mass_kg = 0.3;
  s.scene.scripts["solve"] = {s.run.hand_csv, "the way out", 15};
  s.machine.file = "/machines/lab.toml";
  s.machine.device = "playback";
  s.machine.virtuose.library = "/opt/arm/virtuoseAPI.so";
  s.machine.virtuose.indexing = "none";
  s.machine.virtuose.damper_nm_s_per_rad = 0.25;
  s.machine.recording = "/reports/old.tick";
  s.machine.simulated = {"/e.csv", 0.5, 9, 7, "stiff", 1, 8, 3, 0.25, 1e-5, 1e-4, 3};
  s.machine.rate_hz = 1e3 / 3;
  s.machine.workspace_scale = 2.5;
  s.machine.p_WB = Vec3(0.1, -0.2, 1.0 / 3);
  s.machine.q_WB = Quat(0.5, -0.5, 0.5, 0.5);
  s.machine.view = false;
  s.machine.token = "abcdefgh";
  s.machine.cache_dir = "/var/cache/x";
  return s;
}

TEST(Session, ReadsBackExactlyWhatWasSaved) {
  TempFolder folder;
  Session saved = full_session(folder);
  save_session(saved, folder.path() / "session.toml");
  Session read = load_session(folder.path() / "session.toml");
  auto a = session::session_keys(saved, "/");
  auto b = session::session_keys(read, "/");
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    const auto x = a[i].get(), y = b[i].get();
    ASSERT_EQ(x.has_value(), y.has_value()) << a[i].name;
    if (x) {
      EXPECT_EQ(session::describe(*x), session::describe(*y)) << a[i].name;
    }
  }
  // Not through the keys: would show a key bound to the wrong member.
  EXPECT_EQ(read.id, saved.id);
  EXPECT_EQ(read.run.hand_csv, saved.run.hand_csv);
  EXPECT_EQ(read.run.for_s, saved.run.for_s);
  EXPECT_EQ(read.run.report, saved.run.report);
  EXPECT_EQ(read.run.plot, saved.run.plot);
  EXPECT_EQ(read.run.record, saved.run.record);
  EXPECT_EQ(read.scene.title, saved.scene.title);
  EXPECT_EQ(read.scene.file, saved.scene.file);
  EXPECT_EQ(read.scene.obstacle.shape_params, saved.scene.obstacle.shape_params);
  EXPECT_EQ(read.scene.tool.mesh, saved.scene.tool.mesh);
  EXPECT_EQ(read.scene.tool.unit, "inch");
  EXPECT_EQ(read.scene.X_WO.p, saved.scene.X_WO.p);
  EXPECT_EQ(read.scene.X_WO.q.coeffs(), saved.scene.X_WO.q.coeffs());
  EXPECT_EQ(read.scene.start_X_WM.q.coeffs(), saved.scene.start_X_WM.q.coeffs());
  EXPECT_EQ(read.scene.goal_X_WM->p, saved.scene.goal_X_WM->p);
  EXPECT_EQ(read.scene.contact.f_max_n, 7);
  EXPECT_EQ(read.scene.contact.force_along, "normal");
  EXPECT_EQ(read.scene.contact.directions, 42);
  EXPECT_EQ(read.scene.contact.lever_unit_m, 0.2);
  EXPECT_EQ(read.scene.contact.cluster_voxels, 1.5);
  EXPECT_EQ(read.scene.contact.cluster_law, "potential");
  EXPECT_FALSE(read.scene.coupling.saturation);
  EXPECT_TRUE(read.scene.coupling.rotation_locked);
  EXPECT_EQ(read.scene.scripts.at("solve").hand_force_max_n, 15);
  EXPECT_EQ(read.machine.rate_hz, saved.machine.rate_hz);
  EXPECT_EQ(read.scene.coupling.kind, "static");
  EXPECT_EQ(read.scene.coupling.integrator, "semi-implicit");
  EXPECT_TRUE(read.scene.coupling.passivity_controller);
  EXPECT_EQ(read.machine.workspace_scale, 2.5);
  EXPECT_EQ(read.machine.p_WB.value(), *saved.machine.p_WB);
  EXPECT_EQ(read.machine.q_WB.coeffs(), saved.machine.q_WB.coeffs());
  EXPECT_EQ(read.machine.device, "playback");
  EXPECT_EQ(read.machine.virtuose.library, "/opt/arm/virtuoseAPI.so");
  EXPECT_EQ(read.machine.virtuose.indexing, "none");
  EXPECT_EQ(read.machine.virtuose.damper_nm_s_per_rad, 0.25);
  EXPECT_EQ(read.machine.recording, saved.machine.recording);
  const SimulatedSpec &is = read.machine.simulated, &was = saved.machine.simulated;
  EXPECT_EQ(is.events, was.events);
  EXPECT_EQ(is.grip, was.grip);
  EXPECT_EQ(std::tie(is.tremor_n, is.tremor_hz, is.seed, is.coulomb_n, is.force_continuous_n, is.thermal_s),
            std::tie(was.tremor_n, was.tremor_hz, was.seed, was.coulomb_n, was.force_continuous_n, was.thermal_s));
  EXPECT_EQ(std::tie(is.workspace_m, is.quantum_m, is.quantum_rad, is.delay_ticks),
            std::tie(was.workspace_m, was.quantum_m, was.quantum_rad, was.delay_ticks));
  EXPECT_FALSE(read.machine.view);
}

TEST(Session, DefaultsRoundTripToo) {
  TempFolder folder;
  Session s;
  s.name = "x";
  s.run_dir = folder.path();
  s.scene.obstacle.shape = s.scene.tool.shape = "box";
  save_session(s, folder.path() / "s.toml");
  const Session r = load_session(folder.path() / "s.toml");
  EXPECT_FALSE(r.scene.goal_X_WM.has_value());
  EXPECT_FALSE(r.machine.p_WB.has_value());
  EXPECT_TRUE(r.machine.token.empty());
  EXPECT_TRUE(r.machine.cache_dir.empty());
  EXPECT_FALSE(scripted_hand(r).has_value());
}

/// A scene file just short enough to be read makes a session file that is longer.
TEST(Session, OfTheLongestSceneReadsBackToo) {
  TempFolder folder;
  std::string text = "obstacle.shape = \"box\"\ntool.shape = \"box\"\n";
  for (int i = 0; i < 6000; ++i) text += "tool.params.a" + std::to_string(i) + " = 1\n";
  Session s;
  load_scene(folder.write("s.toml", text), s);
  s.run_dir = folder.path();
  s.name = "x";
  save_session(s, folder.path() / "session.toml");
  EXPECT_GT(std::filesystem::file_size(folder.path() / "session.toml"), 128u << 10);
  EXPECT_EQ(load_session(folder.path() / "session.toml").scene.tool.shape_params.size(), 6000u);
}

TEST(Session, FileIsReadableByItsOwnerOnly) {
  TempFolder folder;
  save_session(full_session(folder), folder.path() / "session.toml");
  struct stat info {};
  ASSERT_EQ(::stat((folder.path() / "session.toml").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777u, 0600u);
}

TEST(Session, SavingWhereNothingCanBeMadeIsOneError) {
  TempFolder folder;
  EXPECT_EQ(
      setup_error([&] { save_session(full_session(folder), "/nowhere/s.toml"); }),
      "/nowhere/s.toml: cannot write: No such file or directory: free some space, fix the folder's permissions or "
      "choose another place");
}

TEST(Session, MissingNameUnknownKeyAndBadIdAreRefused) {
  TempFolder folder;
  const auto error = [&](const std::string& text) {
    const auto file = folder.write("s.toml", text);
    return setup_error([&] { load_session(file); }).substr(file.string().size());
  };
  EXPECT_EQ(error("run_dir = \"/tmp\"\n"), ": name: found nothing, expected the name of the session");
  EXPECT_EQ(error("id = \"18446744073709551616\"\n"),
            ": id: found \"18446744073709551616\" at line 1, expected a whole number as text");
  EXPECT_EQ(error("scene.contact.lwa = \"none\"\n"),
            ": scene.contact.lwa: found this unknown key at line 1, "
            "expected a known key; did you mean scene.contact.law?");
  EXPECT_EQ(error("name = \"Not A Name\"\n"),
            ": name: found \"Not A Name\" at line 1, expected 1 to 24 of the characters a-z, 0-9 and -");
}

}  // namespace
}  // namespace tact
