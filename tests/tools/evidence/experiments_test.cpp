#include "evidence/experiments.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace tact::evidence {
namespace {

/// Every experiment in its quick form: `tact report --quick`.
class QuickExperiment : public ::testing::TestWithParam<Experiment> {
 protected:
  static std::vector<bench::Report::Table> tables_of(const Experiment& experiment, std::size_t& claims) {
    bench::Report report;
    report.begin(experiment.name);
    experiment.run({.quick = true}, report);
    claims = report.sections().back().all<bench::Report::Claim>().size();
    return report.sections().back().all<bench::Report::Table>();
  }
};

TEST_P(QuickExperiment, SaysWhatItFoundAndSaysTheSameAgain) {
  std::size_t claims = 0;
  const auto tables = tables_of(GetParam(), claims);
  ASSERT_FALSE(tables.empty());
  for (const auto& table : tables) {
    EXPECT_FALSE(table.rows.empty());
    for (const auto& row : table.rows) ASSERT_EQ(row.size(), table.columns.size());
  }
  if (std::string(GetParam().name).starts_with("fig-")) {
    EXPECT_EQ(claims, 1u) << "a figure says whether it holds";
  }
  // Seeds are fixed and the rig knows no clock. Two would take minutes and are made of the presses of fig-2.
  const std::string name = GetParam().name;
  const bool repeats = std::any_of(tables.begin(), tables.end(), [](const auto& t) { return !t.times; });
  if (!repeats || name == "stability" || name == "judgement") return;
  const auto again = tables_of(GetParam(), claims);
  ASSERT_EQ(again.size(), tables.size());
  for (std::size_t i = 0; i < tables.size(); ++i) {
    if (!tables[i].times) {
      EXPECT_EQ(again[i].rows, tables[i].rows);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, QuickExperiment, ::testing::ValuesIn(experiments().begin(), experiments().end()),
                         [](const ::testing::TestParamInfo<Experiment>& tested) {
                           std::string name = tested.param.name;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(Experiments, HaveNamesOfTheirOwn) {
  std::set<std::string> names;
  for (const Experiment& e : experiments()) EXPECT_TRUE(names.insert(e.name).second) << e.name;
}

}  // namespace
}  // namespace tact::evidence
