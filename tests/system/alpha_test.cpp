// The alpha puzzle ([P] fig. 8) on the real processes: solved by its script, not by force.
#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "support/tact_run.hpp"

namespace tact::test {
namespace {

struct Case {
  std::string script, law, mode;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.script << ", " << c.law << ", " << c.mode; }
};

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const char* script : {"solve", "lean"}) {
    for (const char* law : {"potential", "adaptive-6dof"}) {
      for (const char* mode : {"pseudo-admittance", "impedance"}) all.push_back({script, law, mode});
    }
  }
  return all;
}

std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  return identifier(info.param.script + "_" + info.param.law + "_" + info.param.mode);
}
std::string cheat_name(const ::testing::TestParamInfo<std::tuple<std::string, std::string>>& info) {
  return identifier(std::get<0>(info.param) + "_" + std::get<1>(info.param));
}

class AlphaSolve : public ::testing::TestWithParam<Case> {};

TEST_P(AlphaSolve, ReachesTheGoalWithUnderHalfAVoxelOfQuasiStaticPenetration) {
  TactRun run(
      {"alpha", "--script", GetParam().script, "--law", GetParam().law, "--mode", GetParam().mode, "--view", "off"});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const auto report = run.report();
  EXPECT_TRUE(report["goal"]["reached"].get<bool>()) << report.dump(2);
  EXPECT_LT(report["penetration_voxels"]["quasi_static_max"].get<double>(), 0.5) << report.dump(2);
  if (GetParam().script == "lean") {
    EXPECT_GT(report["contacts"]["max"].get<int>(), 0);
  }
  EXPECT_TRUE(report["shared_memory_proven"].get<bool>());
  EXPECT_GT(report["wrench"]["fresh"].get<double>(), 0.9 * report["ticks"].get<double>()) << report.dump(2);
}

INSTANTIATE_TEST_SUITE_P(ScriptsLawsAndModes, AlphaSolve, ::testing::ValuesIn(cases()), case_name);

class AlphaCheat : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(AlphaCheat, IsBlockedBySaturationAgainstTheSameHandOfTwentyNewton) {
  TactRun run({"alpha", "--script", "cheat", "--law", std::get<0>(GetParam()), "--mode", std::get<1>(GetParam()),
               "--saturation", "on", "--view", "off"});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const auto report = run.report();
  EXPECT_FALSE(report["goal"]["reached"].get<bool>()) << report.dump(2);
  EXPECT_GT(report["contacts"]["max"].get<int>(), 0);
  EXPECT_GT(report["pull_n"]["max"].get<double>(), 9.0) << "the hand really pulled, up to saturation";
  EXPECT_LT(report["penetration_voxels"]["quasi_static_max"].get<double>(), 0.5) << report.dump(2);
}

INSTANTIATE_TEST_SUITE_P(LawsAndModes, AlphaCheat,
                         ::testing::Combine(::testing::Values("potential", "adaptive-3dof", "adaptive-6dof"),
                                            ::testing::Values("pseudo-admittance", "impedance")),
                         cheat_name);

// [P] fig. 8: unsaturated at k = 500 N/m, averaging over all contacts lets the alpha slip at a smaller pull than the
// Gauss map does. That the adaptive law *holds* there does not repeat on this scene: the strands are about 3 voxels
// (1.5 mm) too near on each side, so 500 N/m a contact cannot resist more than a few newton under any law.
TEST(AlphaCheatUnsaturated, GlobalScalingSlipsAtASmallerPullThanTheAdaptiveLaws) {
  const auto pull_at_slip = [](const std::string& law) {
    TactRun run(
        {"alpha", "--script", "cheat", "--law", law, "--stiffness", "500", "--saturation", "off", "--view", "off"});
    EXPECT_EQ(run.wait(), 0) << run.output();
    const auto report = run.report();
    EXPECT_TRUE(report["goal"]["reached"].get<bool>()) << law << report.dump(2);
    return report["pull_n"]["max"].get<double>();
  };
  const double global = pull_at_slip("global");
  EXPECT_GT(pull_at_slip("adaptive-6dof"), 1.2 * global);
  EXPECT_GT(pull_at_slip("adaptive-3dof"), 1.2 * global);
}

}  // namespace
}  // namespace tact::test
