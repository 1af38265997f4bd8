// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/files/extension.h"

#include <gtest/gtest.h>

namespace prospect::extension_test {
namespace {

TEST(Extension, IsTheLastEndingInLowerCase) {
  EXPECT_EQ(lower_case_extension("a.folder/Map.PNG"), ".png");
  EXPECT_EQ(lower_case_extension("scan.tar.Gz"), ".gz");
  EXPECT_EQ(lower_case_extension("a.folder/map"), "");
  EXPECT_EQ(lower_case_extension(".hidden"), "");
}

}  // namespace
}  // namespace prospect::extension_test
