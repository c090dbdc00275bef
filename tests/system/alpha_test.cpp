// The alpha puzzle ([P] fig. 8) on the real processes: solved by its script, not by force. Every law and mode on the
// rig: tests/tools/lockstep/alpha_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>

#include "support/tact_run.hpp"

namespace tact::test {
namespace {

struct Case {
  std::string script, law, mode;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.script << ", " << c.law << ", " << c.mode; }
};

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  std::string name = info.param.script + "_" + info.param.law + "_" + info.param.mode;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
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

INSTANTIATE_TEST_SUITE_P(ScriptsLawsAndModes, AlphaSolve,
                         ::testing::Values(Case{"solve", "potential", "pseudo-admittance"},
                                           Case{"lean", "potential", "impedance"},
                                           Case{"lean", "adaptive-6dof", "pseudo-admittance"}),
                         case_name);

class AlphaCheat : public ::testing::TestWithParam<Case> {};

TEST_P(AlphaCheat, IsBlockedBySaturationAgainstTheSameHandOfTwentyNewton) {
  TactRun run({"alpha", "--script", "cheat", "--law", GetParam().law, "--mode", GetParam().mode, "--saturation", "on",
               "--view", "off"});
  ASSERT_EQ(run.wait(), 0) << run.output();
  const auto report = run.report();
  EXPECT_FALSE(report["goal"]["reached"].get<bool>()) << report.dump(2);
  EXPECT_GT(report["contacts"]["max"].get<int>(), 0);
  EXPECT_GT(report["pull_n"]["max"].get<double>(), 9.0) << "the hand really pulled, up to saturation";
  EXPECT_LT(report["penetration_voxels"]["quasi_static_max"].get<double>(), 0.5) << report.dump(2);
}

INSTANTIATE_TEST_SUITE_P(LawsAndModes, AlphaCheat,
                         ::testing::Values(Case{"cheat", "potential", "pseudo-admittance"},
                                           Case{"cheat", "adaptive-6dof", "impedance"}),
                         case_name);

}  // namespace
}  // namespace tact::test
