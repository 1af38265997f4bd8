// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/rate_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "models/unicycle.h"
#include "tests/engine/term_derivatives.h"
#include "tests/engine/view_worlds.h"

namespace prospect::rate_limit_test {
namespace {

TEST(RateLimit, HasRowsOnlyWhereTheInputMayChangeAndIsLimited) {
  const Unicycle model;
  InputLimits limits = model.limits();
  limits.rate = Eigen::Vector2d(0.8, std::numeric_limits<double>::infinity());
  const Horizon horizon{&model, 10, 0.25};
  EXPECT_EQ(RateLimit(limits).rows(horizon), 2 * 10);
  EXPECT_EQ(RateLimit(limits, 4).rows(horizon), 2 * 4);
  EXPECT_EQ(RateLimit(limits, 10).rows(horizon), 2 * 10);
  limits.rate.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_EQ(RateLimit(limits, 4).rows(horizon), 0);
  EXPECT_TRUE(RateLimit(limits, 4).jacobian_pattern(horizon).empty());
  EXPECT_THROW(RateLimit(limits, -1), std::invalid_argument);
}

TEST(RateLimit, RowsAreThoseOfTheStagesWhereAKnotBegins) {
  std::mt19937_64 random(1);
  const Unicycle model;
  InputLimits limits = model.limits();
  limits.rate = Eigen::Vector2d(0.8, 2.5);
  for (const int M : {1, 3, 4, 7, 10}) {
    constexpr int N = 10;
    TrajectoryBatch t = test::random_trajectories(model, N, 0.25, 3, random);
    for (int k = 0; k < N; ++k) {
      for (int j = 0; j < 2; ++j) {
        int first = k;
        while (first > 0 && (first - 1) * M / N == k * M / N) --first;
        t.inputs.row(2 * k + j) = t.inputs.row(2 * first + j).eval();
      }
    }
    const RateLimit term(limits, M);
    const TermOutput out = test::evaluate(term, t, false);
    ASSERT_EQ(out.value.rows(), 4 * M);
    for (int b = 0; b < 3; ++b) {
      std::vector<double> expected;
      double worst = 1e9;
      for (int k = 0; k < N; ++k) {
        for (int j = 0; j < 2; ++j) {
          const double change = t.u(k, j, b) - (k > 0 ? t.u(k - 1, j, b) : t.u_previous[j]);
          const double allowed = limits.rate[j] * 0.25;
          worst = std::min(worst, allowed - std::abs(change));
          if (k > 0 && k * M / N == (k - 1) * M / N) continue;
          expected.push_back(allowed - change);
          expected.push_back(allowed + change);
        }
      }
      for (std::size_t r = 0; r < expected.size(); ++r) {
        EXPECT_NEAR(out.value(static_cast<Eigen::Index>(r), b), expected[r], 1e-12);
      }
      // The stages without a row never bind.
      EXPECT_NEAR(out.value.col(b).minCoeff(), worst, 1e-12);
    }
    const TrajectoryBatch one = test::random_trajectories(model, N, 0.25, 1, random);
    test::expect_derivative_matches_differences(term, one, 0, 1e-5, 1e-8);
  }
}

}  // namespace
}  // namespace prospect::rate_limit_test
