// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/median.h"

#include <gtest/gtest.h>

#include <vector>

namespace prospect::median_test {
namespace {

TEST(Median, OfOddAndEvenNumbers) {
  std::vector<double> one = {7.0}, two = {9.0, 4.0}, five = {5.0, -1.0, 100.0, 2.0, 3.0};
  EXPECT_EQ(median(one), 7.0);
  EXPECT_EQ(median(two), 9.0);  // the upper of the two
  EXPECT_EQ(median(five), 3.0);
}

}  // namespace
}  // namespace prospect::median_test
