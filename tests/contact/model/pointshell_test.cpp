#include "contact/model/pointshell.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "fault/fault.hpp"

namespace tact::contact {
namespace {

/// A root, two children, three grandchildren.
Pointshell small_shell() {
  Pointshell s;
  for (int i = 0; i < 6; ++i) {
    s.position_T.push_back(Eigen::Vector3f::Constant(0.01f * static_cast<float>(i)));
    s.normal_T.push_back(Eigen::Vector3f::UnitX());
    s.radius_m.push_back(i < 3 ? 0.1f : 0.f);
    s.area_m2.push_back(1e-4f);
  }
  s.level_begin = {0, 1, 3, 6};
  s.child_begin = {1, 3, 5, 6, 6, 6};
  s.child_end = {3, 5, 6, 6, 6, 6};
  s.X_TM.p = Vec3(1, 2, 3);
  s.X_TM.q = Quat(0.5, 0.5, -0.5, 0.5);
  s.inertia_shape_m2 << 1, 2, 3, 2, 5, 6, 3, 6, 9;
  s.gyration_radius_m = 0.3;
  s.bounding_radius_m = 0.4;
  s.spacing_m = 0.5;
  s.content_hash = 77;
  return s;
}

class PointshellFile : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::string refusal(std::uint64_t hash = 0) const {
    try {
      load_pointshell(path_, hash);
    } catch (const SetupError& error) {
      EXPECT_NE(std::string(error.what()).find(path_.string()), std::string::npos);
      return error.what();
    }
    return "accepted";
  }
  bool refused_for(const std::string& reason, std::uint64_t hash = 0) const {
    return refusal(hash).find(reason) != std::string::npos;
  }

  std::filesystem::path path_ = std::filesystem::temp_directory_path() / ("tact-shell-" + std::to_string(::getpid()));
};

TEST_F(PointshellFile, ReadsBackWhatWasWritten) {
  const Pointshell s = small_shell();
  save_pointshell(s, path_);
  const Pointshell b = load_pointshell(path_, 77);
  EXPECT_EQ(b.position_T, s.position_T);
  EXPECT_EQ(b.normal_T, s.normal_T);
  EXPECT_EQ(b.radius_m, s.radius_m);
  EXPECT_EQ(b.child_begin, s.child_begin);
  EXPECT_EQ(b.child_end, s.child_end);
  EXPECT_EQ(b.level_begin, s.level_begin);
  EXPECT_EQ(b.area_m2, s.area_m2);
  EXPECT_EQ(b.X_TM.p, s.X_TM.p);
  EXPECT_EQ(b.X_TM.q.coeffs(), s.X_TM.q.coeffs());
  EXPECT_EQ(b.inertia_shape_m2, s.inertia_shape_m2);
  EXPECT_EQ(b.gyration_radius_m, 0.3);
  EXPECT_EQ(b.bounding_radius_m, 0.4);
  EXPECT_EQ(b.spacing_m, 0.5);
  EXPECT_EQ(b.content_hash, 77u);
}

TEST_F(PointshellFile, MissingTruncatedForeignDamagedAndOtherFilesAreRefused) {
  EXPECT_TRUE(refused_for("No such file"));
  std::ofstream(path_) << std::string(200, 'x');
  EXPECT_TRUE(refused_for("foreign"));
  save_pointshell(small_shell(), path_);
  EXPECT_TRUE(refused_for("something else", 78));
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 1);
  EXPECT_TRUE(refused_for("truncated"));
  save_pointshell(small_shell(), path_);
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(150);
    file.put('\x55');
  }
  EXPECT_TRUE(refused_for("damaged"));
}

TEST_F(PointshellFile, HierarchiesThatLeadAstrayAreRefused) {
  const auto spoiled = [&](auto&& spoil) {
    Pointshell s = small_shell();
    spoil(s);
    save_pointshell(s, path_);
    return refused_for("inconsistent");
  };
  EXPECT_TRUE(spoiled([](Pointshell& s) { s.child_end[2] = 4000; }));
  EXPECT_TRUE(spoiled([](Pointshell& s) { s.child_begin[1] = 0; }));
  EXPECT_TRUE(spoiled([](Pointshell& s) { s.child_end[2] = 5; }));
  EXPECT_TRUE(spoiled([](Pointshell& s) { s.level_begin[1] = 9; }));
  EXPECT_TRUE(spoiled([](Pointshell& s) { s.level_begin[3] = 5; }));
  EXPECT_FALSE(spoiled([](Pointshell&) {}));
}

TEST_F(PointshellFile, NumbersThatAreNoneAreRefused) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
  const auto reason = [&](auto&& spoil) {
    Pointshell s = small_shell();
    spoil(s);
    save_pointshell(s, path_);
    const std::string all = refusal(), before = "the pointshell is inconsistent: ";
    const auto at = all.find(before);
    return at == all.npos ? all : all.substr(at + before.size());
  };
  const std::string end = ": delete it and bake again";
  EXPECT_EQ(reason([](Pointshell& s) { s = Pointshell{}, s.level_begin = {0, 0}; }), "no points" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.position_T[5].z() = kNan; }), "a point that is nowhere" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.radius_m[1] = -0.1f; }), "a point that is nowhere" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.area_m2[1] = kInf; }), "a point that is nowhere" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.normal_T[3].setZero(); }), "a normal that is none" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.normal_T[3].x() = kNan; }), "a normal that is none" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.X_TM.q.w() = 2; }), "its mesh frame" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.X_TM.p.x() = kInf; }), "its mesh frame" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.inertia_shape_m2(2, 0) = kNan; }), "its inertia" + end);
  EXPECT_EQ(reason([](Pointshell& s) { s.gyration_radius_m = -1; }), "its radii or spacing" + end);
}

}  // namespace
}  // namespace tact::contact
