#include "rt/histogram.hpp"

#include <gtest/gtest.h>

namespace tact::rt {
namespace {

TEST(Histogram, PercentilesOfAUniformRampAreRightToTheBucketWidth) {
  Histogram h;
  for (int i = 1; i <= 100000; ++i) h.add(i);
  for (double p : {0.5, 0.99, 0.999}) {
    EXPECT_GE(h.percentile_ns(p), p * 100000 * 0.999);
    EXPECT_LE(h.percentile_ns(p), p * 100000 * 1.091);
  }
  EXPECT_EQ(h.percentile_ns(1.0), 100000);
  EXPECT_EQ(h.n, 100000u);
}

TEST(Histogram, MergingEqualsAddingToOne) {
  Histogram a, b, both;
  for (int i = 1; i < 1000; ++i) {
    (i % 3 ? a : b).add(i * i);
    both.add(i * i);
  }
  a.merge(b);
  EXPECT_EQ(a.counts, both.counts);
  EXPECT_EQ(a.n, both.n);
  EXPECT_EQ(a.max_ns, both.max_ns);
}

TEST(Histogram, EmptyAndOutOfRangeValuesAreHarmless) {
  Histogram h;
  EXPECT_EQ(h.percentile_ns(0.5), 0);
  h.add(-5);
  h.add(0);
  h.add(INT64_MAX);
  EXPECT_EQ(h.n, 3u);
}

}  // namespace
}  // namespace tact::rt
