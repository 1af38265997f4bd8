// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/known_extent.h"

#include <gtest/gtest.h>

namespace prospect::known_extent_test {
namespace {

constexpr double kSide = 0.1;  // [m]

GridFrame frame(int i0, int j0, int i1, int j1) {
  return {kSide, i0, j0, i1 - i0 + 1, j1 - j0 + 1};
}

TEST(KnownExtent, IsAllThatIsKnownAsLongAsThatIsNotMuch) {
  KnownExtent extent;
  EXPECT_EQ(extent.frame(kSide).width, 0);
  extent.add(-3, 5, 4, 6);
  EXPECT_EQ(extent.frame(kSide), frame(-3, 5, 4, 6));
  extent.add(1990, 1990, 1990, 1990);  // 4 million cells
  EXPECT_EQ(extent.frame(kSide), frame(-3, 5, 1990, 1990));
  // A hall as large as a map may be, half of it known.
  for (int i = 0; i < 6000; i += 128) extent.add(i, 0, i, 6000);
  EXPECT_EQ(extent.frame(kSide), frame(-3, 0, 5888, 6000));
}

TEST(KnownExtent, LeavesOutWhatLiesFarApart) {
  for (const int far : {5000, -5000, 1'000'000}) {
    for (const bool first : {true, false}) {
      KnownExtent extent;
      if (first) extent.add(far, far, far, far);
      extent.add(-10, -20, 30, 20);
      extent.add(31 + 2 * KnownExtent::kBlock, 0, 31 + 2 * KnownExtent::kBlock, 0);  // near it
      if (!first) extent.add(far, far, far, far);
      EXPECT_EQ(extent.frame(kSide), frame(-10, -20, 31 + 2 * KnownExtent::kBlock, 20))
          << far << first;
    }
  }
}

}  // namespace
}  // namespace prospect::known_extent_test
