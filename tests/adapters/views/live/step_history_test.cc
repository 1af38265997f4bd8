// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/live/step_history.h"

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <utility>

namespace prospect::step_history_test {
namespace {

/// Each step sets one cell of its own, and all set the same one.
std::shared_ptr<const StepRecord> step(int number) {
  auto record = std::make_shared<StepRecord>();
  record->step = number;
  record->map_changes = {{{number, 0}, CellState::kFree},
                         {{-1, 0}, number % 2 == 0 ? CellState::kFree : CellState::kOccupied}};
  return record;
}

TEST(StepHistory, GivesWhatIsLaterInPortions) {
  StepHistory history;
  EXPECT_EQ(history.newest(), -1);
  EXPECT_TRUE(history.since(-1, 10).empty());
  for (int k = 0; k < 25; ++k) history.add(step(k));
  EXPECT_EQ(history.newest(), 24);
  ASSERT_EQ(history.since(-1, 10).size(), 10U);
  EXPECT_EQ(history.since(-1, 10).back()->step, 9);
  ASSERT_EQ(history.since(20, 10).size(), 4U);
  EXPECT_EQ(history.since(20, 10).front()->step, 21);
  EXPECT_TRUE(history.since(24, 10).empty());
}

TEST(StepHistory, AnyNumberOfStepsIsBoundedAndTheMapIsWhole) {
  constexpr int kSteps = 1000;
  StepHistory history(64);
  for (int k = 0; k < kSteps; ++k) {
    history.add(step(k));
    EXPECT_LE(history.size(), 64U);
    EXPECT_EQ(history.newest(), k);
  }
  const auto kept = history.since(-1, kSteps);
  std::map<int, CellState> map;
  int before = -1;
  for (const auto& record : kept) {
    EXPECT_GT(record->step, before);
    before = record->step;
    for (const auto& [cell, state] : record->map_changes) map[cell.i] = state;
  }
  EXPECT_EQ(map.size(), kSteps + 1U);
  EXPECT_EQ(map[-1], CellState::kOccupied) << "the newest change of a cell counts";
}

}  // namespace
}  // namespace prospect::step_history_test
