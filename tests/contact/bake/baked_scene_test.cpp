// Real files through the real child process.
#include "contact/bake/baked_scene.hpp"

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "contact/bake/content_key.hpp"
#include "contact/model/pointshell.hpp"
#include "fault/fault.hpp"
#include "field/distance_field.hpp"
#include "mesh/mesh.hpp"
#include "support/process.hpp"
#include "test_meshes.hpp"

namespace tact::contact {
namespace {

constexpr const char* kBake = TACT_BAKE_PROGRAM;

void write_obj(const Mesh& mesh, const std::filesystem::path& path) {
  std::ofstream file(path);
  file.precision(9);
  for (const auto& v : mesh.vertices) file << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : mesh.triangles) file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
}

class BakedSceneTest : public testing::Test {
 protected:
  void SetUp() override {
    cache_ = scratch_.path() / "cache";
    scene_.name = "test";
    scene_.obstacle.mesh = file("block.obj");
    scene_.obstacle.unit = "mm";
    scene_.tool.shape = "box";
    scene_.field_resolution = 32;
    scene_.points = 300;
    write_obj(test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 20)), scene_.obstacle.mesh);
  }

  std::filesystem::path file(const std::string& name) const { return scratch_.path() / name; }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(file(name), std::ios::binary) << text;
    scene_.obstacle.mesh = file(name);
  }
  BakedScene bake(const std::string& program = kBake) const { return ensure_baked(scene_, cache_, {}, program); }

  /// The one error a bake ends in; it must name the mesh file.
  std::string refusal(const std::string& program = kBake) const {
    try {
      bake(program);
    } catch (const SetupError& error) {
      EXPECT_NE(std::string(error.what()).find(scene_.obstacle.mesh.string()), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << "one line";
      return error.what();
    }
    return "accepted";
  }
  void expect_only_locks() const {
    for (const auto& entry : std::filesystem::directory_iterator(cache_))
      EXPECT_EQ(entry.path().extension(), ".lock") << entry.path();
  }
  std::string script(const std::string& body) const {
    const auto path = scratch_.path() / "stand-in";
    std::ofstream(path) << "#!/bin/sh\n" << body << '\n';
    ::chmod(path.c_str(), 0755);
    return path.string();
  }

  test::ScratchDir scratch_;
  std::filesystem::path cache_;
  SceneSpec scene_;
};

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(BakedSceneTest, BakesOnceAndThenFindsItInTheCache) {
  std::set<std::string> stages;
  const BakedScene first = ensure_baked(
      scene_, cache_,
      [&](const BakeStep& step) {
        EXPECT_TRUE(step.fraction >= 0 && step.fraction <= 1);
        stages.insert(step.part + " " + step.stage);
        return true;
      },
      kBake);
  EXPECT_TRUE(stages.count("obstacle distances") == 1 && stages.count("tool blue noise") == 1);
  EXPECT_FALSE(first.obstacle.from_cache);
  EXPECT_GT(first.obstacle.bake_seconds, 0);
  EXPECT_GT(first.obstacle.bake_peak_bytes, 1u << 20);
  const DistanceField field = DistanceField::open(first.obstacle.data, first.obstacle.hash);
  EXPECT_NEAR(field.voxel_m(), 0.05 / 32, 1e-9);  // the unit was mm
  EXPECT_NEAR(field.sample(Vec3(0.025, 0.015, 0.021)).value_m, 0.001, 1e-6);
  EXPECT_LT(field.sample(Vec3(0.025, 0.015, 0.01)).value_m, 0);
  EXPECT_EQ(load_mesh(first.obstacle.mesh).triangles.size(), 12u);
  EXPECT_EQ(load_pointshell(first.tool.data, first.tool.hash).size(), 300u);
  EXPECT_GT(first.largest_gap_voxels, 0);

  const BakedScene second = bake("/no/such/program");  // nothing to bake, so nothing is started
  EXPECT_TRUE(second.obstacle.from_cache && second.tool.from_cache);
  EXPECT_EQ(second.obstacle.hash, first.obstacle.hash);
  EXPECT_EQ(second.field_error_max_m, first.field_error_max_m);
}

TEST_F(BakedSceneTest, TheKeyFollowsTheContentNotTheName) {
  const std::uint64_t key = obstacle_key(scene_);
  const auto other = [&](auto&& change) {
    SceneSpec changed = scene_;
    change(changed);
    return obstacle_key(changed);
  };
  EXPECT_EQ(other([](SceneSpec&) {}), key);
  EXPECT_EQ(other([](SceneSpec& s) {
              s.name = "another";
              s.points = 7;
              s.contact.p = 3;
            }),
            key);
  EXPECT_EQ(other([&](SceneSpec& s) {
              s.obstacle.mesh = file("copy.obj");
              std::filesystem::copy_file(scene_.obstacle.mesh, s.obstacle.mesh);
            }),
            key);
  EXPECT_NE(other([](SceneSpec& s) { s.obstacle.unit = "m"; }), key);
  EXPECT_NE(other([](SceneSpec& s) { s.field_resolution = 33; }), key);
  EXPECT_NE(other([](SceneSpec& s) { s.obstacle.sheet_thickness_m = 1e-3; }), key);
  std::ofstream(scene_.obstacle.mesh, std::ios::app) << "\n";
  EXPECT_NE(obstacle_key(scene_), key);
  const std::uint64_t tool = tool_key(scene_, 0);
  scene_.points = 301;
  EXPECT_NE(tool_key(scene_, 0), tool);
  EXPECT_EQ(tool_key(scene_, 1e-3), [&] {
    scene_.points = 302;  // counts no longer
    return tool_key(scene_, 1e-3);
  }());
  EXPECT_NE(tool_key(scene_, 1e-3), tool_key(scene_, 2e-3));
}

TEST_F(BakedSceneTest, ASpacingIsCountedInVoxelsOfTheObstacle) {
  scene_.spacing_voxels = 2;
  const BakedScene coarse = bake();
  const auto spacing_m = [](const BakedScene& baked) {
    const auto report = nlohmann::json::parse(std::ifstream(baked.tool.report));
    return report.at("shell").at("mean_spacing_m").get<double>();
  };
  EXPECT_NEAR(spacing_m(coarse), 2 * coarse.voxel_m, 0.02 * coarse.voxel_m);
  scene_.field_resolution = 64;  // half the voxel, so four times the points
  const BakedScene fine = bake();
  EXPECT_NEAR(spacing_m(fine), 2 * fine.voxel_m, 0.02 * fine.voxel_m);
  EXPECT_NEAR(static_cast<double>(fine.points), 4.0 * static_cast<double>(coarse.points),
              0.02 * static_cast<double>(fine.points));
  scene_.spacing_voxels = 4;  // 4 fine voxels are 2 coarse ones
  const BakedScene same = bake("/no/such/program");
  EXPECT_EQ(same.tool.hash, coarse.tool.hash);
}

/// The tool by itself: its voxel comes from the obstacle's report in the same cache.
TEST_F(BakedSceneTest, ASpacingNeedsTheObstacleFirst) {
  std::ofstream(file("scene.toml")) << "obstacle = { shape = \"box\", field_cells = 16 }\n"
                                       "tool = { shape = \"cone\", spacing_voxels = 1.5 }\n";
  const auto run = [&](const char* part) {
    test::Process process({kBake, "--scene", file("scene.toml").string(), "--cache", cache_.string(), "--part", part},
                          file("bake.log"));
    const std::optional<int> code = process.wait(std::chrono::seconds(60));
    return std::pair(code.value_or(-1), process.output());
  };
  const auto [code, text] = run("tool");
  EXPECT_EQ(code, 2);
  EXPECT_TRUE(says(text, "tool.spacing_voxels counts in: bake the obstacle first")) << text;
  EXPECT_EQ(run("both").first, 0);
  EXPECT_EQ(run("tool").first, 0);
}

TEST_F(BakedSceneTest, AWallThatMayPassBetweenThePointsIsSaid) {
  for (const char* side : {"size_x_m", "size_y_m", "size_z_m"}) scene_.tool.shape_params[side] = 0.02;
  const auto warned = [&] {
    for (const std::string& warning : bake().tool.warnings) {
      if (says(warning, "widest hole between its points")) return true;
    }
    return false;
  };
  EXPECT_FALSE(warned());
  write_obj(test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 0.5)), file("sheet.obj"));
  scene_.obstacle.mesh = file("sheet.obj");
  EXPECT_NEAR(bake().thinnest_wall_m.value_or(0), 0.5e-3, 1e-8);
  EXPECT_TRUE(warned());
  EXPECT_TRUE(warned());  // from the cache too
  scene_.obstacle.mesh = file("block.obj");
  EXPECT_FALSE(warned());
}

TEST_F(BakedSceneTest, WhatCouldNotBeMeasuredIsNotZero) {
  const BakedScene measured = bake();
  EXPECT_GT(measured.field_error_max_m.value_or(0), 0);
  auto report = nlohmann::json::parse(std::ifstream(measured.obstacle.report));
  report["field"]["error_largest_m"] = report["field"]["thinnest_wall_mm"] = nullptr;
  std::ofstream(measured.obstacle.report) << report;
  const BakedScene unknown = bake("/no/such/program");
  EXPECT_FALSE(unknown.field_error_max_m || unknown.thinnest_wall_m);
  EXPECT_TRUE(unknown.field_error_rms_m.has_value());
}

TEST_F(BakedSceneTest, DamagedFilesAreBakedAnew) {
  const BakedScene first = bake();
  for (const auto& path : {first.obstacle.data, first.obstacle.mesh, first.obstacle.report, first.tool.data}) {
    std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
    const BakedScene again = bake();
    EXPECT_NO_THROW(DistanceField::open(again.obstacle.data, again.obstacle.hash));
    EXPECT_NO_THROW(load_pointshell(again.tool.data, again.tool.hash));
    EXPECT_NO_THROW(load_mesh(again.obstacle.mesh));
  }
}

TEST_F(BakedSceneTest, AReportThatLacksSomethingIsMadeAnew) {
  const BakedScene first = bake();
  auto report = nlohmann::json::parse(std::ifstream(first.obstacle.report));
  report["field"].erase("voxel_m");
  std::ofstream(first.obstacle.report) << report;
  const BakedScene again = bake();
  EXPECT_EQ(again.voxel_m, first.voxel_m);
  EXPECT_FALSE(again.obstacle.from_cache);
  EXPECT_TRUE(again.tool.from_cache);
  ASSERT_FALSE(again.obstacle.warnings.empty());
  EXPECT_TRUE(says(again.obstacle.warnings.back(), "/field/voxel_m: found nothing"));
}

TEST_F(BakedSceneTest, TwoAtOnceShareOneBake) {
  BakedScene a, b;
  std::thread other([&] { a = bake(); });
  b = bake();
  other.join();
  EXPECT_NE(a.obstacle.from_cache, b.obstacle.from_cache);
  EXPECT_EQ(a.obstacle.hash, b.obstacle.hash);
}

TEST_F(BakedSceneTest, NothingButTheCacheIsLeft) {
  bake();
  for (const auto& entry : std::filesystem::directory_iterator(cache_)) {
    const std::string extension = entry.path().extension();
    EXPECT_TRUE(extension == ".field" || extension == ".shell" || extension == ".mesh" || extension == ".json" ||
                extension == ".lock")
        << entry.path();
  }
}

TEST_F(BakedSceneTest, MissingEmptyAndUnknownFilesAreRefused) {
  scene_.obstacle.mesh = file("missing.obj");
  EXPECT_TRUE(says(refusal(), "cannot read the mesh file"));
  write("empty.stl", "");
  EXPECT_TRUE(says(refusal(), "empty"));
  write("part.step", "ISO-10303-21;");
  EXPECT_TRUE(says(refusal(), "unknown mesh format \".step\""));
}

TEST_F(BakedSceneTest, AWrongShapeIsToldWithTheSceneFileAndTheBody) {
  const auto told = [&] {
    try {
      bake();
    } catch (const SetupError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  scene_.tool.shape_params = {{"size_x_m", -1}};
  EXPECT_TRUE(says(told(), "tool: shape box: size_x_m: found -1, expected a number from 1e-06 to 1000")) << told();
  scene_.file = "/scenes/a.toml";
  scene_.tool.shape = "boxx";
  EXPECT_EQ(told().find("/scenes/a.toml: tool: shape: found \"boxx\", expected one of "), 0u) << told();
}

TEST_F(BakedSceneTest, AMeshWithoutAUnitIsRefused) {
  scene_.obstacle.unit = "";
  EXPECT_TRUE(says(refusal(), "unit"));
}

TEST_F(BakedSceneTest, TruncatedAndHostileFilesAreRefused) {
  std::string stl(84 + 50, '\0');
  stl[80] = 100;  // announces 100 triangles, holds one
  write("truncated.stl", stl);
  EXPECT_NE(refusal(), "accepted");
  stl.assign(84, '\0');
  stl[80] = stl[81] = stl[82] = stl[83] = '\xff';  // 4 billion
  write("boast.stl", stl);
  EXPECT_NE(refusal(), "accepted");
  write("noise.glb", "glTF\x02" + std::string(500, '\x7f'));
  EXPECT_NE(refusal(), "accepted");
  write("noise.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n");
  EXPECT_NE(refusal(), "accepted");
  write("noise.dae", "<COLLADA><library_geometries>");
  EXPECT_NE(refusal(), "accepted");
  write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n");
  EXPECT_NE(refusal(), "accepted");
}

TEST_F(BakedSceneTest, VerticesThatAreNotFiniteAreRefused) {
  write("nan.obj", "v 0 0 0\nv 1 0 0\nv nan 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
  EXPECT_TRUE(says(refusal(), "finite"));
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\ninf 1 0\n3 0 1 2\n";
  write("inf.ply", ply);
  EXPECT_NE(refusal(), "accepted");
}

TEST_F(BakedSceneTest, MeshesWithoutTrianglesOrExtentAreRefused) {
  write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\np 1 2 3\n");
  EXPECT_NE(refusal(), "accepted");
  write("flat.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
  EXPECT_NE(refusal(), "accepted");
  write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_TRUE(says(refusal(), "degenerate"));
}

TEST_F(BakedSceneTest, HugeCoordinatesAreRefused) {
  Mesh far = test::box_mesh(Vec3(0, 0, 0), Vec3(1, 1, 1));
  for (auto& v : far.vertices) v.x() += 1e6f;
  write_obj(far, file("far.obj"));
  scene_.obstacle.mesh = file("far.obj");
  EXPECT_TRUE(says(refusal(), "too far"));
  write("big.obj", "v 0 0 0\nv 1e20 0 0\nv 0 1e20 0\nv 0 0 1e20\nf 1 2 3\nf 1 2 4\n");
  EXPECT_TRUE(says(refusal(), "check the unit"));
}

TEST_F(BakedSceneTest, ACrashOfTheChildIsOneClearError) {
  EXPECT_TRUE(says(refusal(script("kill -SEGV $$")), "crashed (Segmentation fault)"));
  EXPECT_TRUE(says(refusal(script("kill -KILL $$")), "killed (out of memory?)"));
  EXPECT_TRUE(says(refusal(script("exit 3")), "left with code 3"));
  EXPECT_TRUE(says(refusal(script("echo '{\"part\":\"obstacle\"'; echo noise; kill -ABRT $$")), "crashed (Aborted)"));
}

TEST_F(BakedSceneTest, AChildThatLiesAboutSuccessIsFoundOut) {
  try {
    bake(script("exit 0"));
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_TRUE(says(error.what(), "do not read back")) << error.what();
  }
}

TEST_F(BakedSceneTest, AMissingProgramIsOneClearError) {
  try {
    bake("/no/such/program");
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_TRUE(says(error.what(), "cannot start the bake")) << error.what();
  }
}

#ifndef TACT_SANITIZED
TEST_F(BakedSceneTest, LackOfMemoryIsOneClearError) {
  scene_.field_resolution = 1024;
  const std::string message = refusal(script("ulimit -v 120000; exec " + std::string(kBake) + " \"$@\""));
  EXPECT_TRUE(says(message, "memory") || says(message, "crashed")) << message;
}
#endif

TEST_F(BakedSceneTest, AFullDiskIsOneClearError) {
  // A limit on the file size fails the write as a full disk does.
  std::string message;
  try {
    bake(script("trap '' XFSZ; ulimit -f 8; exec " + std::string(kBake) + " \"$@\""));
  } catch (const SetupError& error) {
    message = error.what();
  }
  EXPECT_TRUE(says(message, "cannot write")) << message;
}

TEST_F(BakedSceneTest, AnUnwritableCacheIsOneClearError) {
  std::ofstream(scratch_.path() / "cache") << "a file";
  try {
    bake();
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_TRUE(says(error.what(), "cache folder")) << error.what();
  }
}

TEST_F(BakedSceneTest, CancellingKillsTheChild) {
  scene_.field_resolution = 400;
  int calls = 0;
  EXPECT_THROW(ensure_baked(
                   scene_, cache_, [&](const BakeStep&) { return ++calls < 3; }, kBake),
               SetupError);
  expect_only_locks();
  scene_.field_resolution = 32;
  EXPECT_NO_THROW(bake());  // and leaves the cache usable
}

TEST_F(BakedSceneTest, CancellingDoesNotWaitForASilentChild) {
  int calls = 0;
  const std::string silent =
      script("echo '{\"part\":\"obstacle\",\"stage\":\"far field\",\"fraction\":0}'; exec sleep 1000");
  EXPECT_THROW(ensure_baked(
                   scene_, cache_, [&](const BakeStep&) { return ++calls < 3; }, silent),
               SetupError);
}

TEST_F(BakedSceneTest, AnInterruptedChildIsACancelledBakeAndItsLeftoversGo) {
  try {
    bake(script("touch $4/$(ls $4 | grep lock | sed s/lock/field.a1b2c3/); kill -INT $$"));
    FAIL();
  } catch (const SetupError& error) {
    EXPECT_STREQ(error.what(), "bake: cancelled");
  }
  expect_only_locks();
}

/// The real child, killed while it computes.
TEST_F(BakedSceneTest, AChildKilledMidWayLeavesNothingAndTheNextBakeIsWhole) {
  scene_.field_resolution = 200;
  std::string message;
  try {
    ensure_baked(
        scene_, cache_,
        [&](const BakeStep& step) {
          if (step.stage != "distances") return true;
          std::ifstream children("/proc/thread-self/children");
          for (pid_t child = 0; children >> child;) ::kill(child, SIGKILL);
          return true;
        },
        kBake);
  } catch (const SetupError& error) {
    message = error.what();
  }
  EXPECT_TRUE(says(message, "was killed")) << message;
  expect_only_locks();
  EXPECT_NO_THROW(bake());
}

/// A server killed while its child bakes: the child goes too, and the next server finds the lock free.
TEST_F(BakedSceneTest, AServerKilledMidWayIsSucceededByTheNext) {
  scene_.field_resolution = 400;
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t server = ::fork();
  if (server == 0) {
    try {
      ensure_baked(
          scene_, cache_,
          [&](const BakeStep& step) { return step.stage != "distances" || ::write(ready[1], "x", 1) == 1; }, kBake);
    } catch (...) {
    }
    ::_exit(0);
  }
  ASSERT_GT(server, 0);
  ::close(ready[1]);
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  ::kill(server, SIGKILL);
  ::waitpid(server, nullptr, 0);
  ::close(ready[0]);
  const BakedScene next = bake();
  EXPECT_FALSE(next.obstacle.from_cache);
  EXPECT_EQ(DistanceField::open(next.obstacle.data, next.obstacle.hash).voxel_m(), next.voxel_m);
}

TEST_F(BakedSceneTest, TwoProcessesAtOnceShareOneBake) {
  const pid_t child = ::fork();
  if (child == 0) {
    try {
      ::_exit(bake().obstacle.from_cache ? 11 : 10);
    } catch (...) {
      ::_exit(12);
    }
  }
  ASSERT_GT(child, 0);
  const bool from_cache = bake().obstacle.from_cache;
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_EQ(WEXITSTATUS(status), from_cache ? 10 : 11);
}

TEST_F(BakedSceneTest, AFullCacheDiskIsOneClearErrorAndLeavesNothing) {
  std::filesystem::create_directories(cache_);
  if (::mount("tmpfs", cache_.c_str(), "tmpfs", 0, "size=64k") != 0) GTEST_SKIP() << "needs root to mount a small disk";
  std::string message;
  try {
    bake();
  } catch (const SetupError& error) {
    message = error.what();
  }
  expect_only_locks();
  EXPECT_EQ(::umount2(cache_.c_str(), MNT_DETACH), 0);
  EXPECT_TRUE(says(message, "cannot write: No space left on device")) << message;
}

TEST_F(BakedSceneTest, AnErrorBoundChoosesTheResolution) {
  scene_.field_error_mm = 0.4;
  const BakedScene baked = bake();
  EXPECT_LE(baked.field_error_max_m.value_or(1), 0.4e-3);
  EXPECT_GT(baked.field_error_max_m.value_or(0), 0.1e-3);  // and no finer than need be
  const auto report = nlohmann::json::parse(std::ifstream(baked.obstacle.report));
  EXPECT_NEAR(0.05 / report.at("field").at("resolution").get<double>(), baked.voxel_m, 1e-9);
  EXPECT_NEAR(report.at("field").at("thinnest_wall_the_grid_honours_mm").get<double>(), 1e3 * baked.voxel_m, 1e-9);
  scene_.field_error_mm = 1e-4;
  EXPECT_TRUE(says(refusal(), "needs more than 4096 cells"));
}

TEST_F(BakedSceneTest, AnErrorBoundSaysWhereItPromisesNothing) {
  scene_.field_error_mm = 5;
  const auto warnings = [&] {
    return nlohmann::json::parse(std::ifstream(bake().obstacle.report)).at("warnings").dump();
  };
  EXPECT_FALSE(says(warnings(), "field_error_mm"));
  Mesh tray = test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 20));
  tray.triangles.resize(10);
  scene_.obstacle.mesh = file("tray.obj");
  write_obj(tray, scene_.obstacle.mesh);
  EXPECT_TRUE(says(warnings(), "obstacle.field_error_mm promises nothing"));
}

/// A glTF whose node turns and moves its part, in a file beside it.
TEST_F(BakedSceneTest, NodeTransformsAreApplied) {
  const Mesh box = test::box_mesh(Vec3(0, 0, 0), Vec3(1, 2, 3));
  {
    std::ofstream bin(file("box.bin"), std::ios::binary);
    bin.write(reinterpret_cast<const char*>(box.vertices.data()),
              static_cast<std::streamsize>(12 * box.vertices.size()));
    bin.write(reinterpret_cast<const char*>(box.triangles.data()),
              static_cast<std::streamsize>(12 * box.triangles.size()));
  }
  const std::string gltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
    "nodes":[{"children":[1],"translation":[10,0,0]},{"mesh":0,"rotation":[0,0,0.7071067811865476,0.7071067811865476]}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
    "buffers":[{"uri":"box.bin","byteLength":240}],
    "bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":144}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3","min":[0,0,0],"max":[1,2,3]},
                 {"bufferView":1,"componentType":5125,"count":36,"type":"SCALAR"}]})";
  write("box.gltf", gltf);
  scene_.obstacle.unit = "cm";
  const BakedScene baked = bake();
  Eigen::Vector3f low = Eigen::Vector3f::Constant(1e9f), high = -low;
  for (const auto& v : load_mesh(baked.obstacle.mesh).vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  EXPECT_NEAR((low - Eigen::Vector3f(0.08f, 0, 0)).norm(), 0, 1e-6);  // turned by 90 degrees about z, then moved
  EXPECT_NEAR((high - Eigen::Vector3f(0.10f, 0.01f, 0.03f)).norm(), 0, 1e-6);
  // The vertices live in another file: it is part of the content.
  const std::uint64_t key = obstacle_key(scene_);
  std::ofstream(file("box.bin"), std::ios::binary | std::ios::app) << "x";
  EXPECT_NE(obstacle_key(scene_), key);
}

TEST_F(BakedSceneTest, EveryFormatGivesTheSameBody) {
  const Mesh box = test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 20));
  std::ofstream stl(file("block.stl")), ply(file("block.ply"));
  stl << "solid b\n";
  for (const auto& t : box.triangles) {
    stl << "facet normal 0 0 0\nouter loop\n";
    for (const auto i : t) stl << "vertex " << box.vertices[i].transpose() << '\n';
    stl << "endloop\nendfacet\n";
  }
  stl << "endsolid b\n";
  ply << "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\nelement face "
         "12\n"
         "property list uchar int vertex_indices\nend_header\n";
  for (const auto& v : box.vertices) ply << v.transpose() << '\n';
  for (const auto& t : box.triangles) ply << "3 " << t[0] << ' ' << t[1] << ' ' << t[2] << '\n';
  stl.close();
  ply.close();
  const DistanceField wanted = DistanceField::open(bake().obstacle.data);
  for (const char* name : {"block.stl", "block.ply"}) {
    scene_.obstacle.mesh = file(name);
    const BakedScene baked = bake();
    EXPECT_TRUE(baked.obstacle.warnings.empty());
    const DistanceField field = DistanceField::open(baked.obstacle.data);
    for (double x = -0.005; x < 0.055; x += 0.0007) {
      EXPECT_EQ(field.sample(Vec3(x, 0.3 * x, 0.019)).value_m, wanted.sample(Vec3(x, 0.3 * x, 0.019)).value_m);
    }
  }
}

TEST_F(BakedSceneTest, WhatWasRepairedOrDoubtfulIsSaid) {
  write_obj(test::unwelded(test::doubly_faced(test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 20)))), file("double.obj"));
  scene_.obstacle.mesh = file("double.obj");
  const BakedScene twice = bake();
  ASSERT_EQ(twice.obstacle.warnings.size(), 1u);
  EXPECT_TRUE(says(twice.obstacle.warnings[0], "12 of 24 triangles were coincident copies (12 turned over)"));
  Mesh open = test::box_mesh(Vec3(0, 0, 0), Vec3(50, 30, 20));
  open.triangles.resize(10);
  write_obj(open, file("open.obj"));
  scene_.obstacle.mesh = file("open.obj");
  const BakedScene holed = bake();
  ASSERT_GE(holed.obstacle.warnings.size(), 2u);
  EXPECT_TRUE(says(holed.obstacle.warnings[0], "1 of 1 parts are open (4 boundary edges)"));
}

TEST_F(BakedSceneTest, TheProgramExplainsItself) {
  test::Process help({kBake, "--help"}, file("help.log"));
  EXPECT_EQ(help.wait(std::chrono::seconds(20)), 0);
  EXPECT_TRUE(says(help.output(), "--scene") && says(help.output(), "Example"));
  test::Process nothing({kBake, "--cache", cache_.string()}, file("nothing.log"));
  EXPECT_EQ(nothing.wait(std::chrono::seconds(20)), 2);
  EXPECT_TRUE(says(nothing.output(), "--scene FILE"));
}

}  // namespace
}  // namespace tact::contact
