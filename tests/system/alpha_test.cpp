// The alpha puzzle ([P] fig. 8) on the real processes: solved by its script, not by force.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/tact_run.hpp"

namespace tact::test {
namespace {

struct Case {
  std::string law, mode;
};

std::string identifier(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}
std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  return identifier(info.param.law + "_" + info.param.mode);
}
std::string law_name(const ::testing::TestParamInfo<std::string>& info) { return identifier(info.param); }

class AlphaSolve : public ::testing::TestWithParam<Case> {};

TEST_P(AlphaSolve, ReachesTheGoalWithUnderHalfAVoxelOfQuasiStaticPenetration) {
  TactRun run({"alpha", "--script", "solve", "--law", GetParam().law, "--mode", GetParam().mode, "--view", "off"});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const auto report = run.report();
  EXPECT_TRUE(report["goal"]["reached"].get<bool>()) << report.dump(2);
  EXPECT_LT(report["penetration_voxels"]["quasi_static_max"].get<double>(), 0.5) << report.dump(2);
  EXPECT_TRUE(report["shared_memory_proven"].get<bool>());
  EXPECT_GT(report["wrench"]["fresh"].get<double>(), 0.9 * report["ticks"].get<double>()) << report.dump(2);
}

INSTANTIATE_TEST_SUITE_P(LawsAndModes, AlphaSolve,
                         ::testing::Values(Case{"potential", "pseudo-admittance"}, Case{"potential", "impedance"},
                                           Case{"adaptive-6dof", "pseudo-admittance"},
                                           Case{"adaptive-6dof", "impedance"}),
                         case_name);

class AlphaCheat : public ::testing::TestWithParam<std::string> {};

TEST_P(AlphaCheat, IsBlockedBySaturationAgainstTheSameHandOfTwentyNewton) {
  TactRun run({"alpha", "--script", "cheat", "--law", GetParam(), "--saturation", "on", "--view", "off"});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const auto report = run.report();
  EXPECT_FALSE(report["goal"]["reached"].get<bool>()) << report.dump(2);
  EXPECT_GT(report["contacts"]["max"].get<int>(), 0);
  EXPECT_GT(report["force_n"]["max"].get<double>(), 5.0) << "the hand really pulled";
}

INSTANTIATE_TEST_SUITE_P(Laws, AlphaCheat, ::testing::Values("potential", "adaptive-3dof", "adaptive-6dof"),
                         law_name);

// [P] fig. 8: unsaturated, at k = 500 N/m, averaging over all contacts lets the alpha slip where the Gauss map holds it.
TEST(AlphaCheatUnsaturated, GlobalScalingSlipsWhereTheAdaptiveLawHolds) {
  const auto slips = [](const std::string& law) {
    TactRun run({"alpha", "--script", "cheat", "--law", law, "--stiffness", "500", "--saturation", "off", "--view", "off"});
    EXPECT_EQ(run.wait(), 0) << run.output();
    return run.report()["goal"]["reached"].get<bool>();
  };
  EXPECT_TRUE(slips("global"));
  EXPECT_FALSE(slips("adaptive-6dof"));
}

}  // namespace
}  // namespace tact::test
