// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/lattice_cell.h"

#include <gtest/gtest.h>

#include <set>

namespace prospect::lattice_cell_test {
namespace {

TEST(LatticeCell, IsOneACubeAndAnotherOneElsewhere) {
  std::set<std::uint64_t> cells;
  for (int x = -3; x < 3; ++x) {
    for (int y = -3; y < 3; ++y) {
      for (int z = -3; z < 3; ++z) {
        const Eigen::Vector3d corner = 0.25 * Eigen::Vector3d(x, y, z);
        const Eigen::Vector3d almost = corner + Eigen::Vector3d::Constant(0.24);
        EXPECT_EQ(lattice_cell(corner, 0.25), lattice_cell(almost, 0.25));
        cells.insert(lattice_cell(corner, 0.25));
      }
    }
  }
  EXPECT_EQ(cells.size(), 216u);
}

}  // namespace
}  // namespace prospect::lattice_cell_test
