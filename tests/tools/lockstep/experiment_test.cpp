#include "lockstep/experiment.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "fault/fault.hpp"

namespace tact::lockstep {
namespace {

Experiment pressing() {
  AnalyticScene scene = flat_face(25);
  Experiment experiment;
  experiment.session.scene = std::move(scene.spec);
  experiment.bodies = std::move(scene.bodies);
  experiment.motion_WM = std::move(scene.motion_WM);
  return experiment;
}

TEST(RunExperiment, SaysTheSameEveryTimeAndKnowsTheGoal) {
  Experiment experiment = pressing();
  experiment.session.scene.goal_X_WM = Pose{};  // the surface
  const auto report_of = [&] {
    Lockstep rig(experiment);
    return run_experiment(rig, experiment.session);
  };
  const report::SessionReport report = report_of();
  EXPECT_EQ(report::to_json(report), report::to_json(report_of()));
  EXPECT_TRUE(report.goal_reached);
  EXPECT_NEAR(report.stats.force_max_n, 10, 1);
  EXPECT_EQ(report.stats.contacts_max, 25u);
  EXPECT_EQ(report.stats.ticks, static_cast<std::uint64_t>(std::lround(report.duration_s * report.rate_hz)));
  EXPECT_TRUE(report.faults.empty());
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_EQ(report.notes.front().find("felt in free motion: 1.17 kg"), 0u) << report.notes.front();
}

TEST(RunExperiment, EachTickIsARowOfTheTable) {
  const Experiment experiment = pressing();
  Lockstep rig(experiment);
  std::size_t rows = 0;
  const auto commas = [](const std::string& line) { return std::count(line.begin(), line.end(), ','); };
  const auto report = run_experiment(rig, experiment.session, [&](const TickTrace& trace) {
    ++rows;
    ASSERT_EQ(commas(trace_row(trace)), commas(trace_columns()));
  });
  EXPECT_EQ(rows, report.stats.ticks);
}

TEST(RunExperiment, WithoutAMotionThereIsNothingToPlay) {
  Experiment experiment = pressing();
  experiment.motion_WM = {};
  Lockstep rig(experiment);
  EXPECT_THROW(run_experiment(rig, experiment.session), SetupError);
}

}  // namespace
}  // namespace tact::lockstep
