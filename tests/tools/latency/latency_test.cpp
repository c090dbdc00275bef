#include "latency/latency.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "fault/fault.hpp"

namespace tact::latency {
namespace {

TEST(Spread, IsExactWhateverTheOrder) {
  std::vector<std::int64_t> ns(1000);
  std::iota(ns.rbegin(), ns.rend(), 1);  // 1000 .. 1
  for (auto& v : ns) v *= 1000;
  const Spread s = spread_of(ns);
  EXPECT_EQ(s.n, 1000u);
  EXPECT_EQ(s.p50_us, 500);
  EXPECT_EQ(s.p99_us, 990);
  EXPECT_EQ(s.p999_us, 999);
  EXPECT_EQ(s.max_us, 1000);
  EXPECT_EQ(spread_of({}).n, 0u);
  EXPECT_EQ(spread_of({7000}).p50_us, 7);
}

TEST(Wakeup, MeasuresEveryTickOfItsTimeAndSaysUnderWhat) {
  const Figure figure = measure_apart([] { return wakeup({.rate_hz = 2000, .seconds = 0.25, .cpu = -1}); });
  EXPECT_EQ(figure.error, "");
  EXPECT_EQ(figure.spread.n, 500u);
  EXPECT_GT(figure.spread.p50_us, 0);
  EXPECT_GE(figure.spread.max_us, figure.spread.p999_us);
  EXPECT_NE(figure.conditions.text().find("priority") == std::string::npos, !figure.conditions.fifo)
      << figure.conditions.text();
}

TEST(ProcessPair, AnswersEveryTime) {
  const Figure figure = measure_apart([] { return process_pair({.rate_hz = 2000, .seconds = 0.25, .cpu = -1}); });
  EXPECT_EQ(figure.error, "");
  EXPECT_EQ(figure.spread.n, 500u);
  EXPECT_GT(figure.spread.p50_us, 0);
}

TEST(MeasureApart, CarriesAnErrorAndADeathBack) {
  EXPECT_EQ(measure_apart([]() -> Figure { throw SetupError("no RouDi"); }).error, "no RouDi");
  EXPECT_EQ(measure_apart([]() -> Figure { std::_Exit(3); }).error, "the measuring process died");
}

Figure figure(double p999_us, double max_us) {
  Figure f;
  f.spread = {1000, p999_us / 2, p999_us, p999_us, max_us};
  return f;
}

TEST(Advice, IsTheFastestRateWhosePeriodHoldsItAllWithAFifthToSpare) {
  EXPECT_EQ(advise(figure(20, 40), figure(60, 90), 100).rate_hz, 4000);  // 180 <= 200
  EXPECT_EQ(advise(figure(41, 41), figure(60, 90), 100).rate_hz, 2000);  // 201
  EXPECT_EQ(advise(figure(300, 300), figure(200, 90), 300).rate_hz, 1000);
  EXPECT_EQ(advise(figure(900, 900), figure(300, 300), 300).rate_hz, 500);
  const Advice none = advise(figure(900, 900), figure(500, 500), 300);
  EXPECT_EQ(none.rate_hz, 0);
  EXPECT_NE(none.reason.find("= 1700 us"), std::string::npos) << none.reason;
}

TEST(Advice, NamesAWorstCaseThatMissesTicksEvenSo) {
  EXPECT_EQ(advise(figure(20, 240), figure(60, 90), 100).reason.find("misses ticks"), std::string::npos);
  EXPECT_NE(advise(figure(20, 5000), figure(60, 90), 100).reason.find("misses ticks"), std::string::npos);
}

TEST(Advice, SaysWhatCouldNotBeMeasured) {
  Figure broken;
  broken.error = "no iox-roudi in PATH";
  EXPECT_EQ(advise(figure(20, 20), broken, 100).rate_hz, 0);
  EXPECT_NE(advise(figure(20, 20), broken, 100).reason.find("iox-roudi"), std::string::npos);
}

}  // namespace
}  // namespace tact::latency
