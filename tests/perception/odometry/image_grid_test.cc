// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/image_grid.h"

#include <gtest/gtest.h>

namespace prospect::image_grid_test {
namespace {

TEST(ImageGrid, EachPixelHasACell) {
  const ImageGrid grid(100.0, 60.0, 25.0);
  EXPECT_EQ(grid.cells(), 15u);  // a column and a row for what is left over
  EXPECT_EQ(grid.cell({0.0f, 0.0f}), 0u);
  EXPECT_EQ(grid.cell({24.9f, 0.0f}), 0u);
  EXPECT_EQ(grid.cell({25.0f, 0.0f}), 1u);
  EXPECT_EQ(grid.cell({99.0f, 59.0f}), 13u);
  EXPECT_EQ(grid.cell({-3.0f, 1000.0f}), 10u);  // outside: the nearest
}

}  // namespace
}  // namespace prospect::image_grid_test
