// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/resampled_means.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace prospect::resampled_means_test {
namespace {

Eigen::VectorXd normal_numbers(int count, double mean, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal(mean, 1.0);
  Eigen::VectorXd numbers(count);
  for (double& number : numbers) number = normal(generator);
  return numbers;
}

TEST(ResampledMeans, IntervalIsThatOfTheMeanOfNormalNumbers) {
  // Its half width is about 1.96 / sqrt(n).
  const Eigen::VectorXd numbers = normal_numbers(400, 3.0, 5);
  const MeanInterval interval = ResampledMeans(400).interval(numbers);
  EXPECT_DOUBLE_EQ(interval.mean, numbers.mean());
  EXPECT_NEAR(interval.high - interval.mean, 0.098, 0.015);
  EXPECT_NEAR(interval.mean - interval.low, 0.098, 0.015);
}

TEST(ResampledMeans, HoldTheMeanAboutAsOftenAsTheySay) {
  int held = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const MeanInterval i = ResampledMeans(40, 400).interval(normal_numbers(40, 1.0, seed));
    held += i.low <= 1.0 && 1.0 <= i.high;
  }
  EXPECT_GE(held, 178);
  EXPECT_LE(held, 199);
}

TEST(ResampledMeans, ColumnsShareTheirResamples) {
  Eigen::MatrixXd values(30, 2);
  values.col(0) = normal_numbers(30, 0.0, 2);
  values.col(1) = 2.0 * values.col(0).array() + 1.0;
  const auto intervals = ResampledMeans(30).intervals(values);
  EXPECT_NEAR(intervals[1].low, 2.0 * intervals[0].low + 1.0, 1e-12);
  EXPECT_NEAR(intervals[1].high, 2.0 * intervals[0].high + 1.0, 1e-12);
}

// Two samples: the mean of a resample is 0, 1 or 2 with 1/4, 1/2, 1/4.
TEST(ResampledMeans, DrawSamplesAlike) {
  const Eigen::Vector2d values(0.0, 2.0);
  const MeanInterval i = ResampledMeans(2, 4000).interval(values);
  EXPECT_EQ(i.low, 0.0);
  EXPECT_EQ(i.high, 2.0);
  int middle = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    middle += ResampledMeans(2, 1, seed).interval(values).low == 1.0;
  }
  EXPECT_NEAR(middle, 200, 40);  // four standard deviations
}

TEST(ResampledMeans, PairsStayTogetherInARatio) {
  const Eigen::Vector3d first(1.0, 2.0, 8.0);
  const MeanInterval i = ResampledMeans(3, 4000).ratio(first, 2.0 * first);
  EXPECT_EQ(i.mean, 2.0);
  EXPECT_EQ(i.low, 2.0);
  EXPECT_EQ(i.high, 2.0);
}

TEST(ResampledMeans, ZerosMakeNoRatioOnlyIfAllAreZero) {
  const Eigen::Vector2d second(1.0, 2.0);
  const MeanInterval some = ResampledMeans(2, 4000).ratio(Eigen::Vector2d(0.0, 2.0), second);
  EXPECT_EQ(some.mean, 1.5);
  EXPECT_EQ(some.low, 1.0);   // twice the second
  EXPECT_EQ(some.high, 1.5);  // one of each; twice the first makes none
  const MeanInterval none = ResampledMeans(2, 4000).ratio(Eigen::Vector2d::Zero(), second);
  EXPECT_TRUE(std::isnan(none.low) && std::isnan(none.high));
  EXPECT_TRUE(std::isnan(ResampledMeans(0).ratio(Eigen::VectorXd(0), Eigen::VectorXd(0)).mean));
}

TEST(ResampledMeans, OfOneProblemAndOfNone) {
  const MeanInterval one = ResampledMeans(1).interval(Eigen::VectorXd::Constant(1, 4.0));
  EXPECT_EQ(one.low, 4.0);
  EXPECT_EQ(one.high, 4.0);
  EXPECT_TRUE(std::isnan(ResampledMeans(0).interval(Eigen::VectorXd(0)).mean));
}

TEST(SignFlip, IsExactForFewDifferencesOfOneSign) {
  // Of 2^5 signs two are as far: all and none.
  EXPECT_NEAR(sign_flip_p(Eigen::VectorXd::Constant(5, 0.3)), 2.0 / 32.0, 0.01);
  EXPECT_LT(sign_flip_p(Eigen::VectorXd::Constant(20, -0.3)), 1e-3);
  EXPECT_EQ(sign_flip_p(Eigen::VectorXd::Zero(20)), 1.0);
  EXPECT_EQ(sign_flip_p(Eigen::VectorXd(0)), 1.0);
}

TEST(SignFlip, CallsNoiseSoInOneOfTwentyCases) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    found += sign_flip_p(normal_numbers(25, 0.0, seed), 999) < 0.05;
  }
  EXPECT_GE(found, 2);
  EXPECT_LE(found, 20);
}

}  // namespace
}  // namespace prospect::resampled_means_test
