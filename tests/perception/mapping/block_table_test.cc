// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/block_table.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace prospect::block_table_test {
namespace {

TEST(BlockTable, FindsWhatWasMadeAndNothingElse) {
  const std::vector<Cell> made = {{0, 0}, {-3, 7}, {200, -40}, {0, 1}};
  BlockTable<int> table;
  EXPECT_TRUE(table.empty());
  EXPECT_EQ(table.find({0, 0}), nullptr);
  std::vector<int*> at;
  for (std::size_t n = 0; n < made.size(); ++n) {
    at.push_back(&table.add(made[n]));
    *at.back() = static_cast<int>(n);
  }
  ASSERT_EQ(table.size(), made.size());
  for (std::size_t n = 0; n < made.size(); ++n) {
    EXPECT_EQ(table.find(made[n]), at[n]);  // where it was
    EXPECT_EQ(table[n], static_cast<int>(n));
  }
  for (const Cell c : {Cell{1, 0}, Cell{-3, 6}, Cell{1000, 1000}, Cell{-1000, 0}}) {
    EXPECT_EQ(table.find(c), nullptr);
  }
  // What is found is its owner's also after a move.
  const BlockTable<int> moved = std::move(table);
  EXPECT_EQ(moved.find({200, -40}), at[2]);
}

}  // namespace
}  // namespace prospect::block_table_test
