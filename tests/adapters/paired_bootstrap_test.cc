#include "adapters/study/paired_bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

namespace prospect::paired_bootstrap_test {
namespace {

// For many pairs the interval of the mean is that of the normal distribution.
TEST(PairedBootstrap, IntervalOfAMeanIsThatOfItsStandardError) {
  std::mt19937_64 draw(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> first, second;
  double sum = 0.0, squares = 0.0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i) {
    const double common = 100.0 * noise(draw);  // cancels: the pairs stay together
    const double d = 0.7 + noise(draw);
    first.push_back(common);
    second.push_back(common + d);
    sum += d;
    squares += d * d;
  }
  const double mean = sum / n;
  const double half = 1.96 * std::sqrt((squares / n - mean * mean) / n);
  const Interval i = paired_bootstrap(first, second, mean_difference);
  EXPECT_NEAR(i.low, mean - half, 0.1 * half);
  EXPECT_NEAR(i.high, mean + half, 0.1 * half);
}

// Two pairs: the mean difference of a sample is 0, 1 or 2 with 1/4, 1/2, 1/4.
TEST(PairedBootstrap, DrawsPairsAlike) {
  const std::vector<double> first = {5.0, 9.0}, second = {5.0, 11.0};
  const Interval wide = paired_bootstrap(first, second, mean_difference, 4000, 0.95);
  EXPECT_EQ(wide.low, 0.0);
  EXPECT_EQ(wide.high, 2.0);
  const Interval narrow = paired_bootstrap(first, second, mean_difference, 4000, 0.4);
  EXPECT_EQ(narrow.low, 1.0);
  EXPECT_EQ(narrow.high, 1.0);
}

TEST(PairedBootstrap, RatioOfProportionalPairsIsCertain) {
  const Interval i = paired_bootstrap({1.0, 2.0, 8.0}, {2.0, 4.0, 16.0}, ratio_of_means);
  EXPECT_EQ(i.low, 2.0);
  EXPECT_EQ(i.high, 2.0);
}

TEST(PairedBootstrap, ZerosOfTheFirstMakeARatioOfMeansOnlyIfAllAreZero) {
  EXPECT_EQ(ratio_of_means({0.0, 2.0}, {1.0, 2.0}), 1.5);
  const Interval none = paired_bootstrap({0.0, 0.0}, {1.0, 2.0}, ratio_of_means);
  EXPECT_TRUE(std::isnan(none.low) && std::isnan(none.high));
  EXPECT_TRUE(std::isnan(paired_bootstrap({}, {}, mean_difference).low));
}

TEST(PairedBootstrap, TheSeedDecides) {
  const std::vector<double> first = {1.0, 5.0, 2.0, 7.0, 3.0}, second = {2.5, 5.1, 0.0, 9.0, 3.3};
  const Interval a = paired_bootstrap(first, second, ratio_of_means, 50, 0.9, 4);
  const Interval b = paired_bootstrap(first, second, ratio_of_means, 50, 0.9, 4);
  const Interval c = paired_bootstrap(first, second, ratio_of_means, 50, 0.9, 5);
  EXPECT_EQ(a.low, b.low);
  EXPECT_EQ(a.high, b.high);
  EXPECT_TRUE(a.low != c.low || a.high != c.high);
}

TEST(PairedBootstrap, RefusesWhatIsNoSampleOfPairs) {
  EXPECT_THROW(paired_bootstrap({1.0}, {}, mean_difference), std::invalid_argument);
  EXPECT_THROW(paired_bootstrap({1.0}, {1.0}, mean_difference, 0), std::invalid_argument);
  EXPECT_THROW(paired_bootstrap({1.0}, {1.0}, mean_difference, 10, 1.0), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::paired_bootstrap_test
