// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/axis_figure.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "adapters/missions/study/mission_numbers.h"
#include "adapters/missions/study/study_results.h"

namespace prospect::axis_figure_test {
namespace {

int count(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(AxisFigure, AValueAtWhichNothingWasMeasuredIsMarked) {
  const StudyPlan plan = plan_study(
      study_from_text("worlds: office\nseeds: 1..2\ngrid: {planner.N: [12, 20]}\n", "s.yaml"), {},
      "1");
  // Of the six chief numbers losses are known everywhere, the time to 90 % at the first value.
  std::vector<StudyRow> rows;
  for (const StudyCell& cell : plan.cells) {
    StudyRow row;
    row.cell = &cell;
    row.record.status = CellRecord::Status::kDone;
    MissionNumbers numbers;
    numbers.losses = 1.0;
    if (plan.setup(cell).values[0] == 0) numbers.time_to_90_s = 30.0;
    row.numbers = values_of(numbers);
    rows.push_back(row);
  }
  EXPECT_EQ(count(axis_figure(plan, rows, 0).svg(), ">none<"), 6 * 2 - 3);
  for (StudyRow& row : rows) row.numbers.assign(row.numbers.size(), 1.0);
  EXPECT_EQ(count(axis_figure(plan, rows, 0).svg(), ">none<"), 0);
}

}  // namespace
}  // namespace prospect::axis_figure_test
