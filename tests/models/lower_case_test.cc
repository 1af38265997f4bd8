// SPDX-License-Identifier: Apache-2.0
#include "models/lower_case.h"

#include <gtest/gtest.h>

namespace prospect::lower_case_test {
namespace {

TEST(LowerCase, ChangesLettersOnly) {
  EXPECT_EQ(lower_case("Left_0.PNG"), "left_0.png");
  EXPECT_EQ(lower_case("\xc3\x84 z"), "\xc3\x84 z");  // UTF-8
  EXPECT_EQ(lower_case(""), "");
}

}  // namespace
}  // namespace prospect::lower_case_test
