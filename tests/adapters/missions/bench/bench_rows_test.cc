// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::bench_rows_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BenchRows : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  std::string file() const { return folder_ + "/" + kBenchRows; }
  std::string refusal() const {
    try {
      read_bench_rows(folder_);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  const std::string folder_ = ::testing::TempDir() + "bench_rows_" +
                              ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

BenchTable table() {
  BenchTable t;
  t.sets = {{"pair", "known", 0.01, {{"a", 2, 1, "00ff", 0.1}, {"b", 3, 0, "11ee", std::nullopt}}}};
  t.solvers = {"one", "two,samples=3"};
  t.deadlines = {0.0, 0.1};
  t.seeds = {4};
  t.clock = SolveClock::kProcessor;
  t.environments = {{{"processor", "abacus"}, {"build", {{"commit", "c0ffee"}}}}};
  BenchRow row;
  row.problem = 1;
  row.solver = 1;
  row.deadline = 0.1;
  row.seed = 4;
  row.stop = StopReason::kDeadline;
  row.claimed = Quality::kFeasibleOptimum;
  row.quality = Quality::kFeasible;
  row.optimality = std::numeric_limits<double>::quiet_NaN();
  row.cost = 1.0 / 3.0;
  row.violation = 0.0;
  row.x = Eigen::Vector3d(0.1, -2.0, 1e-300);
  row.counters = {7, 3, 2};
  row.seconds = row.processor_seconds = 0.125;
  row.wall_seconds = 0.25;
  row.repeat_seconds = {0.125, 0.25};
  row.trace = {{0.01, 1, 5.0, std::numeric_limits<double>::infinity()}, {0.02, 7, 1.0 / 3.0, 0.0}};
  row.detail = "line\nbreak";
  t.rows = {row};
  return t;
}

TEST_F(BenchRows, ReadBackBitForBit) {
  const BenchTable t = table();
  const BenchRowFile written(folder_, t);
  const BenchTable read = read_bench_rows(folder_);
  EXPECT_EQ(read.solvers, t.solvers);
  EXPECT_EQ(read.deadlines, t.deadlines);
  EXPECT_EQ(read.seeds, t.seeds);
  EXPECT_EQ(read.environments, t.environments);
  EXPECT_EQ(read.sets[0].problems[0].best_known, 0.1);
  EXPECT_FALSE(read.sets[0].problems[1].best_known);
  ASSERT_EQ(read.rows.size(), 1U);
  const BenchRow &a = t.rows[0], &b = read.rows[0];
  EXPECT_EQ(words_of(read, b), words_of(t, a));
  EXPECT_EQ(b.stop, a.stop);
  EXPECT_EQ(b.claimed, a.claimed);
  EXPECT_EQ(b.quality, a.quality);
  EXPECT_TRUE(std::isnan(b.optimality));
  EXPECT_EQ(b.cost, a.cost);
  EXPECT_EQ(b.x, a.x);
  EXPECT_EQ(b.counters.gradient_evaluations, 3);
  EXPECT_EQ(b.repeat_seconds, a.repeat_seconds);
  EXPECT_EQ(b.seconds, a.seconds);
  EXPECT_EQ(b.wall_seconds, a.wall_seconds);
  EXPECT_EQ(b.processor_seconds, a.processor_seconds);
  ASSERT_EQ(b.trace.size(), 2U);
  EXPECT_TRUE(std::isinf(b.trace[0].violation));
  EXPECT_EQ(b.trace[1].cost, a.trace[1].cost);
  EXPECT_EQ(b.detail, a.detail);
}

TEST_F(BenchRows, GrowRowByRowAndLeaveOutALastOneThatIsCutOff) {
  BenchTable t = table();
  const BenchRow row = t.rows[0];
  t.rows.clear();
  BenchRowFile written(folder_, t);
  EXPECT_TRUE(read_bench_rows(folder_).rows.empty());
  written.append(t, row);
  EXPECT_EQ(read_bench_rows(folder_).rows.size(), 1U);
  BenchRow other = row;
  other.solver = 0;
  written.append(t, other);
  EXPECT_EQ(read_bench_rows(folder_).rows.size(), 2U);
  fs::resize_file(file(), fs::file_size(file()) - 9);
  EXPECT_EQ(read_bench_rows(folder_).rows.size(), 1U);
}

TEST_F(BenchRows, AreRefusedByFileAndLine) {
  EXPECT_THAT(refusal(), HasSubstr("rows.jsonl: no such file; expected"));
  const BenchTable t = table();
  { const BenchRowFile written(folder_, t); }
  std::ofstream(file(), std::ios::app) << "{\"row\": {}}\n";
  EXPECT_THAT(refusal(), HasSubstr("rows.jsonl:4: "));
  BenchTable twice = t;
  twice.rows.push_back(twice.rows[0]);
  { const BenchRowFile written(folder_, twice); }
  EXPECT_THAT(refusal(), HasSubstr("rows.jsonl:4: 'two,samples=3' on 'b' of pair, deadline 0.1 s, "
                                   "seed 4 is there twice"));
}

TEST(BenchRowsDiffer, ByWhatTheyAreOf) {
  const BenchTable t = table();
  EXPECT_EQ(differs_from(t, t), "");
  BenchTable more = t;
  more.solvers.push_back("three");
  more.seeds.push_back(9);
  EXPECT_EQ(differs_from(t, more), "");
  EXPECT_THAT(differs_from(more, t), HasSubstr("back end 'three' is there, not asked for"));
  BenchTable other = t;
  other.sets[0].problems[1].fingerprint = "22dd";
  EXPECT_THAT(differs_from(t, other), HasSubstr("problem 'b' of 'pair' is another one"));
  other = t;
  other.repeats = 2;
  EXPECT_THAT(differs_from(t, other), HasSubstr("repeats: 1 there, 2 asked for"));
  other = t;
  other.environments[0]["build"]["commit"] = "decaf";
  EXPECT_THAT(differs_from(t, other), HasSubstr("the program's commit is \"c0ffee\" there"));
}

TEST(BenchRowsTaken, KeepTheirCellAndEnvironment) {
  const BenchTable from = table();
  BenchTable to = from;
  to.rows.clear();
  to.solvers = {"two,samples=3", "one"};
  to.environments = {{{"processor", "slide rule"}}};
  EXPECT_EQ(take_rows(to, from), "");
  ASSERT_EQ(to.rows.size(), 1U);
  EXPECT_EQ(words_of(to, to.rows[0]), words_of(from, from.rows[0]));
  EXPECT_EQ(to.environments[static_cast<std::size_t>(to.rows[0].environment)]["processor"],
            "abacus");
  EXPECT_EQ(take_rows(to, from), words_of(from, from.rows[0]));
  EXPECT_EQ(to.rows.size(), 1U);
}

}  // namespace
}  // namespace prospect::bench_rows_test
