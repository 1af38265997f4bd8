// SPDX-License-Identifier: Apache-2.0
#include "engine/support/quantile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace prospect::quantile_test {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

TEST(Quantile, TakesTheNearestRank) {
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(quantile({4.0, 1.0, 2.0, 3.0}, 0.5), 2.0);
  EXPECT_EQ(quantile({4.0, 1.0, 2.0, 3.0}, 0.75), 3.0);
  EXPECT_EQ(quantile({4.0, 1.0, 2.0, 3.0}, 0.76), 4.0);
  EXPECT_EQ(quantile({1.0, kNever}, 0.5), 1.0);
  EXPECT_EQ(quantile({1.0, kNever}, 0.51), kNever);
  EXPECT_EQ(quantile({7.0}, 0.99), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(Quantile, IsWhatCountingGives) {
  // The smallest value that at least p percent of the values do not exceed.
  for (int n = 1; n <= 250; ++n) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back((i * 7919) % n);  // 0 ... n-1 in some order
    for (int p = 1; p <= 100; ++p) {
      int least = 0;
      while (100 * (least + 1) < p * n) ++least;
      ASSERT_EQ(quantile(values, p / 100.0), least) << p << " % of " << n;
    }
  }
  EXPECT_EQ(quantile({4.0, 2.0}, 0.0), 2.0);
}

}  // namespace
}  // namespace prospect::quantile_test
