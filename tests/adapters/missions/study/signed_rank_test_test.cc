// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/signed_rank_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <vector>

namespace prospect::signed_rank_test_test {
namespace {

/// n differences 1 ... n, of which those in `negative` are negative: W- is their sum.
std::vector<double> ranks(int n, const std::vector<int>& negative) {
  std::vector<double> d;
  for (int i = 1; i <= n; ++i) d.push_back(i);
  for (const int i : negative) d[static_cast<std::size_t>(i - 1)] *= -1.0;
  return d;
}

// Darwin's cross- and self-fertilised maize, fifteen pairs (R. A. Fisher, The Design of
// Experiments, 1935, section 17), in eighths of an inch. Two ties and two negative differences.
TEST(SignedRankTest, DarwinsMaize) {
  const SignedRankTest test =
      signed_rank_test({49, -67, 8, 16, 6, 23, 28, 41, 14, 29, 56, 24, 75, 60, -48});
  EXPECT_EQ(test.n, 15);
  EXPECT_EQ(test.w_minus, 24.0);
  EXPECT_EQ(test.w_plus, 96.0);
  EXPECT_TRUE(test.exact);
  EXPECT_DOUBLE_EQ(test.p, 0.041259765625);
}

// Nine patients before and after a tranquilliser (M. Hollander, D. A. Wolfe, Nonparametric
// Statistical Methods, 1973, p. 29): V = 40, one-sided p = 0.01953.
TEST(SignedRankTest, HollanderAndWolfesDepressionScores) {
  const std::vector<double> before = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const std::vector<double> after = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> d;
  for (std::size_t i = 0; i < before.size(); ++i) d.push_back(before[i] - after[i]);
  const SignedRankTest test = signed_rank_test(d);
  EXPECT_EQ(test.w_plus, 40.0);
  EXPECT_DOUBLE_EQ(test.p, 0.0390625);
}

// Lower tails as printed in tables of the distribution (four digits, one-sided).
TEST(SignedRankTest, TabulatedTails) {
  EXPECT_EQ(signed_rank_test(ranks(5, {})).p, 0.0625);
  EXPECT_EQ(signed_rank_test(ranks(6, {})).p, 0.03125);
  EXPECT_NEAR(signed_rank_test(ranks(10, {8})).p / 2.0, 0.0244, 5e-5);
  EXPECT_NEAR(signed_rank_test(ranks(15, {12, 13})).p / 2.0, 0.0240, 5e-5);
  EXPECT_NEAR(signed_rank_test(ranks(20, {15, 18, 19})).p / 2.0, 0.0242, 5e-5);
  EXPECT_NEAR(signed_rank_test(ranks(25, {20, 22, 23, 24})).p / 2.0, 0.0241, 5e-5);
}

TEST(SignedRankTest, ZerosAreDroppedAndSignsAreSymmetric) {
  const std::vector<double> d = {0.0, 3.0, -1.0, 0.0, 7.0, 4.0};
  std::vector<double> negated;
  for (const double x : d) negated.push_back(-x);
  const SignedRankTest test = signed_rank_test(d);
  EXPECT_EQ(test.n, 4);
  EXPECT_EQ(test.zeros, 2);
  EXPECT_EQ(test.w_minus, 1.0);
  EXPECT_EQ(test.p, 4.0 / 16.0);  // W <= 1 or >= 9: {}, {1} and their complements
  EXPECT_EQ(signed_rank_test(negated).p, test.p);
  EXPECT_EQ(signed_rank_test({0.0, 0.0}).p, 1.0);
  EXPECT_EQ(signed_rank_test({}).n, 0);
}

// All magnitudes alike: a sign test. Two of ten negative: 2 (1 + 10 + 45) / 1024.
TEST(SignedRankTest, TiesAreExact) {
  const std::vector<double> d = {1, 1, -1, 1, 1, 1, -1, 1, 1, 1};
  const SignedRankTest test = signed_rank_test(d);
  EXPECT_EQ(test.w_minus, 11.0);
  EXPECT_EQ(test.p, 112.0 / 1024.0);
}

// n = 30, T = 137: one-sided 0.0249 in the tables; the approximation is near.
TEST(SignedRankTest, ApproximationBeyondTwentyFive) {
  const SignedRankTest test = signed_rank_test(ranks(30, {30, 29, 28, 27, 23}));
  EXPECT_FALSE(test.exact);
  EXPECT_EQ(test.w_minus, 137.0);
  EXPECT_NEAR(test.p / 2.0, 0.0249, 0.001);
  EXPECT_EQ(signed_rank_test(ranks(27, {27, 26, 25, 24, 23, 22, 21, 20, 1})).p, 1.0);
}

// With all ranks alike, r = (n+1)/2, the variance of W is n r^2 / 4.
TEST(SignedRankTest, ApproximationCorrectsForTies) {
  std::vector<double> d(40, 2.0);
  for (int i = 0; i < 12; ++i) d[static_cast<std::size_t>(i)] = -2.0;
  const double r = 20.5;
  const double z = (20.0 * r - 12.0 * r - 0.5) / std::sqrt(40.0 * r * r / 4.0);
  EXPECT_NEAR(signed_rank_test(d).p, std::erfc(z / std::sqrt(2.0)), 1e-12);
}

TEST(SignedRankTest, RefusesWhatIsNotFinite) {
  EXPECT_THROW(signed_rank_test({1.0, NAN}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::signed_rank_test_test
