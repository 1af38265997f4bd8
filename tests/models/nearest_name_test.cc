// SPDX-License-Identifier: Apache-2.0
#include "models/nearest_name.h"

#include <gtest/gtest.h>

namespace prospect::nearest_name_test {
namespace {

TEST(NearestName, FindsTyposAndNothingElse) {
  const std::vector<std::string> names = {"office", "corridor", "loop"};
  EXPECT_EQ(nearest_name("ofice", names), "office");
  EXPECT_EQ(nearest_name("Corrdior", names), "corridor");
  EXPECT_EQ(nearest_name("lop", names), "loop");
  EXPECT_EQ(nearest_name("warehouse", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("x", {"y"}), "");
  EXPECT_EQ(nearest_name(std::string(100000, 'a'), names), "");
  EXPECT_EQ(nearest_name("ab", {"abc", "abd"}), "abc") << "a tie goes to the first";
  EXPECT_EQ(nearest_name("x", {}), "");
}

TEST(NearestName, IsToldAlone) {
  const std::vector<std::string> names = {"office", "loop"};
  EXPECT_EQ(did_you_mean("ofice", names), " (did you mean 'office'?)");
  EXPECT_EQ(did_you_mean("warehouse", names), "");
  EXPECT_EQ(expected_one_of(names), "; expected one of: office, loop");
}

}  // namespace
}  // namespace prospect::nearest_name_test
