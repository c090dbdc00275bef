#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "fault/fault.hpp"
#include "report/session_report.hpp"
#include "rt/histogram.hpp"

namespace tact::report {
namespace {

Histogram wire(const rt::Histogram& h) {
  Histogram out{};
  std::copy(h.counts.begin(), h.counts.end(), out.counts);
  out.n = h.n;
  out.max_us = h.max_ns * 1e-3;
  return out;
}

TEST(Percentiles, AreRightToTheWidthOfABucketAgainstSortedValues) {
  std::mt19937 random(7);
  std::lognormal_distribution<double> durations_ns(std::log(20'000.0), 0.8);
  rt::Histogram h;
  std::vector<double> values;
  for (int i = 0; i < 20'000; ++i) {
    values.push_back(std::floor(durations_ns(random)));
    h.add(static_cast<std::int64_t>(values.back()));
  }
  std::sort(values.begin(), values.end());
  const Percentiles p = percentiles(wire(h));
  const auto expect_near = [&](double found_us, double fraction) {
    const double exact_us = values[static_cast<std::size_t>(fraction * 20'000) - 1] * 1e-3;
    EXPECT_GE(found_us, exact_us * 0.999);
    EXPECT_LE(found_us, exact_us * std::exp2(1.0 / 8) * 1.001);
  };
  expect_near(p.p50, 0.5);
  expect_near(p.p99, 0.99);
  expect_near(p.p999, 0.999);
  EXPECT_DOUBLE_EQ(p.max, values.back() * 1e-3);
}

TEST(Percentiles, OfNothingAreZero) {
  const Percentiles p = percentiles(Histogram{});
  EXPECT_EQ(p.p50, 0);
  EXPECT_EQ(p.max, 0);
}

TEST(StatsByEpoch, MergingTwoEpochsEqualsCountingThemTogether) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  struct Tick {
    double contacts, step_n, force_n;
    std::int64_t tick_ns;
  };
  std::vector<Tick> ticks;
  for (int i = 0; i < 3000; ++i) {
    ticks.push_back({100 * uniform(random), uniform(random), 10 * uniform(random),
                     static_cast<std::int64_t>(1000 + 90'000 * uniform(random))});
  }
  const auto count = [&](std::uint64_t epoch, std::size_t begin, std::size_t end) {
    Stats s{};
    rt::Histogram h;
    double squares = 0;
    s.epoch = epoch;
    for (std::size_t i = begin; i < end; ++i) {
      ++s.ticks;
      ++s.wrench_fresh;
      s.contacts_mean += ticks[i].contacts;
      s.contacts_max = std::max(s.contacts_max, static_cast<std::uint32_t>(ticks[i].contacts));
      s.force_max_n = std::max(s.force_max_n, ticks[i].force_n);
      s.port_energy_j += 0.001 * ticks[i].force_n;
      squares += ticks[i].step_n * ticks[i].step_n;
      h.add(ticks[i].tick_ns);
    }
    s.contacts_mean /= static_cast<double>(s.ticks);
    s.force_step_rms_n = std::sqrt(squares / static_cast<double>(s.ticks));
    s.tick = wire(h);
    return s;
  };
  StatsByEpoch epochs;
  epochs.see(count(1, 0, 400));
  epochs.see(count(1, 0, 1000));  // cumulative: replaces the earlier record of the same epoch
  epochs.see(count(2, 1000, 3000));
  const Stats merged = epochs.total(), whole = count(2, 0, 3000);
  EXPECT_EQ(merged.ticks, whole.ticks);
  EXPECT_EQ(merged.wrench_fresh, whole.wrench_fresh);
  EXPECT_NEAR(merged.contacts_mean, whole.contacts_mean, 1e-9);
  EXPECT_EQ(merged.contacts_max, whole.contacts_max);
  EXPECT_DOUBLE_EQ(merged.force_max_n, whole.force_max_n);
  EXPECT_NEAR(merged.force_step_rms_n, whole.force_step_rms_n, 1e-12);
  EXPECT_NEAR(merged.port_energy_j, whole.port_energy_j, 1e-9);
  EXPECT_EQ(percentiles(merged.tick).p99, percentiles(whole.tick).p99);
  EXPECT_EQ(percentiles(merged.tick).max, percentiles(whole.tick).max);
}

Pose rotated(const Vec3& p, double degrees) {
  return {p, Quat(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitZ()))};
}

TEST(GoalWatch, RemembersTheNearestPoseAndReachesWithinBothTolerances) {
  GoalWatch goal(Pose{}, 2, 5);
  EXPECT_FALSE(goal.reached());
  EXPECT_FALSE(goal.distance_mm());
  goal.see(rotated({0.001, 0, 0}, 20));  // near, but turned
  EXPECT_FALSE(goal.reached());
  EXPECT_NEAR(*goal.angle_deg(), 20, 1e-9);
  goal.see(rotated({0.0015, 0, 0}, 2.5));
  EXPECT_TRUE(goal.reached());
  goal.see(rotated({0.5, 0, 0}, 0));
  EXPECT_TRUE(goal.reached());
  EXPECT_NEAR(*goal.distance_mm(), 1.5, 1e-9);
  EXPECT_NEAR(*goal.angle_deg(), 2.5, 1e-9);
}

TEST(GoalWatch, TheOppositeQuaternionIsTheSameRotation) {
  GoalWatch goal(rotated(Vec3::Zero(), 30), 2, 5);
  Pose same = rotated(Vec3::Zero(), 30);
  same.q.coeffs() *= -1;
  goal.see(same);
  EXPECT_TRUE(goal.reached());
}

TEST(GoalWatch, WithoutAGoalNothingIsReached) {
  GoalWatch goal(std::nullopt, 2, 5);
  goal.see(Pose{});
  EXPECT_FALSE(goal.reached());
  EXPECT_FALSE(goal.distance_mm());
}

TEST(FaultLog, NotesABitWhenItAppearsAndNotWhileItStays) {
  FaultLog log;
  const auto stale = bit(Fault::wrench_stale);
  log.see(1.0, "coupling", stale);
  log.see(1.1, "coupling", stale);
  log.see(2.5, "coupling", 0);
  log.see(2.6, "coupling", stale);
  log.see(2.7, "coupling", 0);
  log.see(2.8, "coupling", stale);  // again within a second: not another line
  ASSERT_EQ(log.events().size(), 2u);
  EXPECT_EQ(log.events()[0].name, "wrench_stale");
  EXPECT_DOUBLE_EQ(log.events()[1].time_s, 2.6);
}

TEST(FaultLog, IsBoundedAndSaysSo) {
  FaultLog log;
  for (int i = 0; i < 2000; ++i) log.note(i, "service_ended", "");
  EXPECT_EQ(log.events().size(), FaultLog::kCapacity);
  EXPECT_EQ(log.events().back().name, "list_full");
}

TEST(Report, JsonHasEveryDocumentedKey) {
  SessionReport report;
  report.voxel_m = 0.002;
  report.stats.penetration_max_m = 0.001;
  report.faults.push_back({1.5, "wrench_stale", "a \"quoted\" \xff detail"});
  const auto json = nlohmann::json::parse(to_json(report));
  for (const char* key : {"duration_s", "rate_hz", "transport", "shared_memory_proven", "ticks", "port_energy_j"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  const std::vector<std::pair<std::string, std::vector<std::string>>> groups{
      {"wrench", {"fresh", "late", "stale"}},
      {"loop_jitter_us", {"p50", "p99", "p999", "max"}},
      {"tick_us", {"p50", "p99", "p999", "max"}},
      {"round_trip_us", {"p50", "p99", "p999", "max"}},
      {"contact_compute_us", {"p50", "p99", "p999", "max"}},
      {"contacts", {"mean", "max"}},
      {"penetration_mm", {"quasi_static_max", "max"}},
      {"penetration_voxels", {"quasi_static_max", "max"}},
      {"force_n", {"max"}},
      {"torque_nm", {"max"}},
      {"pull_n", {"max"}},
      {"force_step_n", {"rms", "max"}},
      {"net_stiffness_n_per_m", {"max"}},
      {"passivity_controller", {"ticks", "dissipated_j"}},
      {"static_coupling", {"residual_max_n", "unsolved_ticks"}},
      {"goal", {"reached", "distance_mm", "angle_deg"}}};
  for (const auto& [group, keys] : groups) {
    for (const auto& key : keys) EXPECT_TRUE(json[group].contains(key)) << group << "." << key;
  }
  EXPECT_DOUBLE_EQ(json["penetration_voxels"]["max"], 0.5);
  EXPECT_TRUE(json["goal"]["distance_mm"].is_null());
  EXPECT_EQ(json["faults"][0]["name"], "wrench_stale");
  EXPECT_DOUBLE_EQ(json["faults"][0]["time_s"], 1.5);
}

TEST(Report, TheTableShowsEachKindOfFaultOnceWithItsFirstTime) {
  SessionReport report;
  for (int i = 1; i <= 3; ++i) report.faults.push_back({1.0 * i, "wrench_late", "reported by coupling"});
  report.faults.push_back({2.5, "service_ended", "contact"});
  const std::string table = to_table(report);
  EXPECT_NE(table.find("1.00 s  wrench_late: reported by coupling (3 times)"), std::string::npos) << table;
  EXPECT_NE(table.find("2.50 s  service_ended: contact\n"), std::string::npos) << table;
  EXPECT_EQ(table.find("2.00 s"), std::string::npos) << table;
}

TEST(Plot, IsAPngEvenOfAnAwkwardTitle) {
  const auto png = std::filesystem::path(testing::TempDir()) / "it's a plot.png";
  std::vector<Sample> samples;
  for (int i = 0; i < 100; ++i) samples.push_back({0.01 * i, std::sin(0.1 * i) + 1, 0.01 * i, 50, 3u});
  write_plot("it's \"odd\" $here `too`", samples, png);
  std::ifstream in(png, std::ios::binary);
  std::string magic(8, '\0');
  in.read(magic.data(), 8);
  EXPECT_EQ(magic, "\x89PNG\r\n\x1a\n");
  std::filesystem::remove(png);
}

TEST(Plot, AFolderThatIsNotThereIsNamed) {
  try {
    write_plot("t", {}, "/nonexistent/plot.png");
    FAIL();
  } catch (const SetupError& e) {
    EXPECT_NE(std::string(e.what()).find("/nonexistent/plot.png"), std::string::npos);
  }
}

}  // namespace
}  // namespace tact::report
