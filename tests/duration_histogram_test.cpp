#include "erard/device/duration_histogram.hpp"

#include <gtest/gtest.h>

namespace erard {
namespace {

TEST(DurationHistogram, QuantilesAreThoseOfTheSortedDurations) {
  DurationHistogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.add(1e-6 * i);
  EXPECT_NEAR(histogram.quantile(0.5), 500e-6, 0.01 * 500e-6);  // bins are 1 % wide
  EXPECT_NEAR(histogram.quantile(0.99), 990e-6, 0.01 * 990e-6);
  EXPECT_DOUBLE_EQ(histogram.quantile(1), 1000e-6);
  EXPECT_DOUBLE_EQ(histogram.worst(), 1000e-6);
}

TEST(DurationHistogram, TakesWhatLiesOutsideItsBins) {
  DurationHistogram histogram;
  histogram.add(0);
  histogram.add(1e9);
  EXPECT_LE(histogram.quantile(0.5), 1.02e-8);
  EXPECT_DOUBLE_EQ(histogram.worst(), 1e9);
  EXPECT_EQ(DurationHistogram().quantile(0.5), 0);
}

}  // namespace
}  // namespace erard
