// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/missions/study/mission_numbers.h"
#include "adapters/missions/study/study_results.h"

namespace prospect::study_comparison_test {
namespace {

const NumberComparison& number(const StudyComparison& c, const std::string& name) {
  for (const NumberComparison& n : c.numbers) {
    if (n.number->name == name) return n;
  }
  throw std::invalid_argument(name);
}

/// Conditions with and without, N 12 and 20, two worlds, three seeds; losses as `losses` says.
class StudyComparisonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    plan_ = plan_study(study_from_text("worlds: [office, corridor]\nseeds: 1..3\n"
                                       "conditions: {with: {}, without: {planner.weights.w_l: 0}}\n"
                                       "grid: {planner.N: [12, 20]}\n",
                                       "s.yaml"),
                       {}, "1");
    for (const StudyCell& cell : plan_.cells) {
      StudyRow row;
      row.cell = &cell;
      row.id = cell.id;
      row.record.status = CellRecord::Status::kDone;
      const StudySetup& setup = plan_.setup(cell);
      // Without: twice as many; N = 20: one more.
      MissionNumbers numbers;
      numbers.losses = static_cast<double>(cell.seed) * (setup.condition == 1 ? 2.0 : 1.0) +
                       (setup.values[0] == 1 ? 1.0 : 0.0);
      row.numbers = values_of(numbers);
      row.reason = "time limit";
      rows_.push_back(row);
    }
  }
  StudyPlan plan_;
  std::vector<StudyRow> rows_;
};

TEST_F(StudyComparisonTest, EachSetupAgainstTheOneThatDiffersInOneThing) {
  const std::vector<StudyComparison> all = compare_setups(plan_, rows_);
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].label, "without / with");
  EXPECT_EQ(all[0].among, "planner.N=12");
  EXPECT_EQ(all[1].among, "planner.N=20");
  EXPECT_EQ(all[2].label, "planner.N 20 / 12");
  EXPECT_EQ(all[2].among, "with");
  const NumberComparison& losses = number(all[0], "losses");
  EXPECT_EQ(losses.pairs, 6);
  EXPECT_EQ(losses.median_reference, 2.0);
  EXPECT_EQ(losses.median_other, 4.0);
  EXPECT_EQ(losses.difference.mean, 2.0);
  EXPECT_EQ(losses.ratio.mean, 2.0);
  EXPECT_EQ(losses.ratio.low, 2.0);
  EXPECT_EQ(losses.ratio.high, 2.0);
  EXPECT_EQ(losses.p, 2.0 / 64.0) << "all six to one side";
  EXPECT_EQ(number(all[2], "losses").difference.mean, 1.0);
}

TEST_F(StudyComparisonTest, APairLacksANumberIfEitherMissionDoes) {
  for (StudyRow& row : rows_) {
    const StudySetup& setup = plan_.setup(*row.cell);
    MissionNumbers numbers;
    numbers.time_to_90_s = setup.condition == 0 || row.cell->seed == 1 ? 50.0 : NAN;
    row.numbers = values_of(numbers);
    if (setup.condition == 1 && row.cell->seed == 3)
      row.record.status = CellRecord::Status::kFailed;
  }
  const std::vector<StudyComparison> all = compare_setups(plan_, rows_);
  EXPECT_EQ(all[0].pairs.size(), 4U) << "a failed cell has no pair";
  const NumberComparison& time = number(all[0], "time_to_90_s");
  EXPECT_EQ(time.pairs, 2);
  EXPECT_EQ(time.only_reference, 2);
  EXPECT_EQ(time.only_other, 0);
  const std::vector<StudyComparison> worlds = by_input(plan_, all[0]);
  ASSERT_EQ(worlds.size(), 2U);
  EXPECT_EQ(worlds[0].input, "office");
  EXPECT_EQ(worlds[0].pairs.size(), 2U);
}

TEST_F(StudyComparisonTest, TheTableHasARowARunAndItsTimesLast) {
  rows_[1].record.status = CellRecord::Status::kFailed;
  rows_[1].reason = "signal 11, \"so\"";
  rows_[1].numbers = {};
  const std::string table = results_csv(plan_, rows_);
  EXPECT_EQ(table.rfind("id,condition,world,seed,planner.N,status,reason,done,losses,", 0), 0U);
  EXPECT_NE(table.find(",host,version,started,process_s,plan_ms_p50,wall_s\n"), std::string::npos);
  EXPECT_NE(table.find(rows_[0].id + ",with,office,1,12,done,time limit,,1,"), std::string::npos);
  EXPECT_NE(table.find(rows_[1].id + ",with,office,1,20,failed,\"signal 11, \"\"so\"\"\",,"),
            std::string::npos);
}

}  // namespace
}  // namespace prospect::study_comparison_test
