// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontier_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace prospect::frontier_order_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::MatrixXd on_a_line(const std::vector<double>& x) {
  const auto n = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd d(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      d(a, b) = std::abs(x[static_cast<std::size_t>(a)] - x[static_cast<std::size_t>(b)]);
    }
  }
  return d;
}

TEST(FrontierOrder, ARoomComesBeforeASliverUnlessTheSliverLiesOnTheWay) {
  const FrontierOrderOptions options;
  // At -2 s a sliver, at 5 s a room; then the sliver at +2 s.
  FrontierSequence s =
      best_sequence({{0, 0.3, 2.0}, {1, 8.0, 5.0}}, on_a_line({-2.0, 5.0}), options);
  EXPECT_EQ(s.order, (std::vector<int>{1, 0}));
  s = best_sequence({{0, 0.3, 2.0}, {1, 8.0, 5.0}}, on_a_line({2.0, 5.0}), options);
  EXPECT_EQ(s.order, (std::vector<int>{0, 1}));
}

TEST(FrontierOrder, WhatCannotBeReachedIsLeftOut) {
  const FrontierOrderOptions options;
  Eigen::MatrixXd d = on_a_line({0.0, 1.0, 2.0});
  d.row(0).setConstant(kInfinity);
  d.col(1).setConstant(kInfinity);
  const FrontierSequence s =
      best_sequence({{0, 2.0, 1.0}, {1, 1.0, kInfinity}, {2, 1.0, 3.0}}, d, options);
  EXPECT_EQ(s.order, (std::vector<int>{2, 0})) << "from 2 to 0, but from 0 nowhere";
  EXPECT_TRUE(best_sequence({{0, 1.0, kInfinity}}, on_a_line({0.0}), options).order.empty());
  EXPECT_TRUE(best_sequence({}, Eigen::MatrixXd(0, 0), options).order.empty());
}

TEST(FrontierOrder, IsTheBestOfAllSequences) {
  FrontierOrderOptions options;
  options.sequence_length = 4;
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> at(-20.0, 20.0), area(0.2, 8.0);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<FrontierCandidate> c;
    std::vector<double> x;
    for (int k = 0; k < 6; ++k) {
      x.push_back(at(random));
      c.push_back({k, area(random), std::abs(x.back())});
    }
    const Eigen::MatrixXd d = on_a_line(x);
    for (const int first : {-1, 2}) {
      double best = 0.0;
      std::vector<int> order(6);
      std::iota(order.begin(), order.end(), 0);
      do {
        if (first >= 0 && order[0] != first) continue;
        double time = 0.0, value = 0.0;
        for (int n = 0; n < 4; ++n) {
          const auto k = static_cast<std::size_t>(order[static_cast<std::size_t>(n)]);
          time += n == 0 ? c[k].cost
                         : d(order[static_cast<std::size_t>(n - 1)],
                             order[static_cast<std::size_t>(n)]);
          value += c[k].area * std::exp(-time / 20.0);
        }
        best = std::max(best, value);
      } while (std::next_permutation(order.begin(), order.end()));
      const FrontierSequence s = best_sequence(c, d, options, first);
      EXPECT_NEAR(s.value, best, 1e-12);
      if (first >= 0) {
        EXPECT_EQ(s.order.front(), first);
      }
    }
  }
}

TEST(FrontierOrder, TheRateIsThatOfItsBestBeginning) {
  const std::vector<FrontierCandidate> c{
      {0, 1.0, 6.0, 12.0}, {1, 1.0, 9.0, 17.0}, {2, 0.1, 99.0, 167.0}};
  const Eigen::MatrixXd d = on_a_line({0.0, 3.0, 100.0});
  EXPECT_EQ(rate({}, c, d), 0.0);
  EXPECT_NEAR(rate({{0}, 0.0}, c, d), 1.0 / 12.0, 1e-12);
  EXPECT_NEAR(rate({{0, 1}, 0.0}, c, d), 2.0 / 15.0, 1e-12) << "together they are worth it";
  EXPECT_NEAR(rate({{0, 1, 2}, 0.0}, c, d), 2.0 / 15.0, 1e-12) << "and need not go on";
}

// Each observation takes its time: many poor ones together do not come before a rich one behind
// them, though none of them is off the path.
TEST(FrontierOrder, SliversOnTheWayToARoomAreLeftOnceTheyCostMoreThanTheyShow) {
  const FrontierOrderOptions options;
  for (const double observation : {0.2, 2.0}) {
    std::vector<FrontierCandidate> c;
    std::vector<double> x;
    for (int k = 0; k < 5; ++k) {
      x.push_back(1.0 + k);
      c.push_back({k, k < 4 ? 0.3 : 8.0, x.back() + observation});
    }
    const Eigen::MatrixXd d = on_a_line(x).array() + observation;
    EXPECT_EQ(best_sequence(c, d, options).order.front(), observation < 1.0 ? 0 : 4);
  }
}

TEST(FrontierOrder, SliversDoNotCrowdOutARoomFartherOff) {
  FrontierOrderOptions options;
  std::vector<FrontierCandidate> c;
  for (int k = 0; k < 30; ++k) c.push_back({k, 0.25, 2.0 + 0.1 * k});
  c.push_back({30, 8.0, 30.0});
  const auto leading = leading_candidates(c, options);
  ASSERT_EQ(leading.size(), 7U);
  EXPECT_EQ(leading.front().frontier, 30);
  EXPECT_EQ(leading[1].frontier, 0);
}

}  // namespace
}  // namespace prospect::frontier_order_test
