// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "adapters/missions/bench/bench_files.h"
#include "adapters/missions/bench/bench_rows.h"
#include "adapters/missions/bench/bench_run.h"
#include "adapters/missions/bench/bench_summary.h"
#include "adapters/missions/study/study_comparison.h"
#include "adapters/missions/study/study_figures.h"

namespace prospect::study_results_test {
namespace {

namespace fs = std::filesystem;

/// A study of the zoo by two back ends and two seeds, solved as `prospect bench` does; the last
/// cell was never begun.
class SolveRows : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "study_results";
    fs::remove_all(folder_);
    plan_ = plan_study(study_from_text("problems: zoo\nseeds: 1..2\n"
                                       "conditions: {slsqp: {solver: \"nlopt:LD_SLSQP\"},\n"
                                       "  search: {solver: \"sampling:search\"}}\n"
                                       "bench: {max_evaluations: 60}\n",
                                       "s.yaml"),
                       {}, "1");
    const CellStore store(folder_, Study::Kind::kBenches);
    const Registries registries;
    for (const StudyCell& cell : plan_.cells) {
      if (&cell == &plan_.cells.back()) continue;
      BenchOptions options;
      options.seeds = {static_cast<int>(cell.seed)};
      options.max_evaluations = 60;
      const BenchTable table =
          run_bench({make_problem_set("zoo", {}, registries, false)},
                    choose_solvers({plan_.solver(plan_.setup(cell))}, registries.solvers), options);
      OutputFolder folder = open_bench_folder(store.run_folder(cell.id), EarlierRows::kKept);
      begin_bench_folder(folder);
      const BenchRowFile rows(store.run_folder(cell.id), table);
      write_bench_folder(folder, table, summarize(table));
    }
    rows_ = read_rows(plan_, store);
  }
  void TearDown() override { fs::remove_all(folder_); }

  double number(const StudyRow& row, const std::string& name) const {
    const std::vector<StudyNumber>& all = study_numbers(plan_.study.kind);
    for (std::size_t n = 0; n < all.size(); ++n) {
      if (all[n].name == name) return value_of(row, n);
    }
    throw std::invalid_argument(name);
  }

  std::string folder_;
  StudyPlan plan_;
  std::vector<StudyRow> rows_;
};

TEST_F(SolveRows, AreARowAProblemJudgedByTheBestKnown) {
  ASSERT_EQ(plan_.cells.size(), 4U);
  ASSERT_EQ(plan_.problems.at(0).size(), 13U);
  ASSERT_EQ(rows_.size(), 4U * 13U);
  int solved = 0;
  for (const StudyRow& row : rows_) {
    const bool missing = row.cell == &plan_.cells.back();
    EXPECT_EQ(row.record.status,
              missing ? CellRecord::Status::kMissing : CellRecord::Status::kDone);
    EXPECT_EQ(row.numbers.empty(), missing) << row.problem;
    if (missing) continue;
    const bool is_solved = number(row, "solved") == 1.0;
    solved += is_solved;
    EXPECT_EQ(std::isfinite(number(row, "evaluations_to_target")), is_solved) << row.problem;
    EXPECT_EQ(number(row, "gap") <= 0.01, is_solved) << row.problem;
    EXPECT_TRUE(std::isnan(number(row, "overrun_ms"))) << "there is no deadline";
  }
  EXPECT_GT(solved, 0);
  EXPECT_LT(solved, 39);
}

TEST_F(SolveRows, ArePairedByProblemAndSeed) {
  const std::vector<StudyComparison> all = compare_setups(plan_, rows_);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].label, "search / slsqp");
  ASSERT_EQ(all[0].pairs.size(), 13U) << "the cell of the other seed is missing";
  for (const auto& [reference, other] : all[0].pairs) {
    EXPECT_EQ(reference->problem, other->problem);
    EXPECT_EQ(reference->cell->seed, other->cell->seed);
  }
  double difference = 0.0;
  for (const auto& [reference, other] : all[0].pairs) {
    difference += (number(*other, "solved") - number(*reference, "solved")) * 100.0 / 13.0;
  }
  const NumberComparison& solved = all[0].numbers.at(0);
  EXPECT_STREQ(solved.number->name, "solved");
  EXPECT_NEAR(solved.difference.mean, difference, 1e-9);
  EXPECT_LT(difference, 0.0) << "a search of 60 evaluations solves less";
}

// Of a wide range, marks near 1 would be written over it.
TEST_F(SolveRows, RatiosAreMarkedWhereThereIsRoom) {
  const auto figure = [&](double low, double high) {
    std::vector<StudyComparison> comparisons = compare_setups(plan_, rows_);
    for (NumberComparison& n : comparisons.at(0).numbers) n.ratio = {1.0, low, high};
    const CellStore store = CellStore::existing(folder_, Study::Kind::kBenches);
    return study_figures(plan_, store, rows_, comparisons, {}).at(0).drawing.svg();
  };
  EXPECT_THAT(figure(0.9, 1.1), testing::HasSubstr(">1.25<"));
  const std::string wide = figure(0.05, 20.0);
  EXPECT_THAT(wide, testing::Not(testing::HasSubstr(">1.25<")));
  EXPECT_THAT(wide, testing::HasSubstr(">20<"));
}

TEST_F(SolveRows, TheTableNamesSetAndProblem) {
  const std::string table = results_csv(plan_, rows_);
  EXPECT_EQ(table.rfind("id,condition,set,problem,seed,status,reason,solved,gap,cost,", 0), 0U);
  EXPECT_NE(table.find(",host,version,started,process_s,ms_to_target,wall_ms,overrun_ms\n"),
            std::string::npos);
  EXPECT_NE(table.find(plan_.cells[0].id + ",slsqp,zoo,Rosenbrock,1,done,"), std::string::npos);
  EXPECT_NE(table.find(plan_.cells[3].id + ",search,zoo,Rosenbrock,2,missing,,,,"),
            std::string::npos);
}

}  // namespace
}  // namespace prospect::study_results_test
