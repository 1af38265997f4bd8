// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/comparison_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "adapters/formats/files/input_error.h"

namespace prospect::comparison_table_test {
namespace {

using ::testing::HasSubstr;

ComparisonRow row(const std::string& map, const std::string& planner, std::uint64_t seed,
                  double time_to_95) {
  ComparisonRow r;
  r.map = map;
  r.planner = planner;
  r.seed = seed;
  r.reason = "explored";
  r.coverage = 0.97;
  r.collisions = 0.0;
  r.time_to_95_s = time_to_95;
  return r;
}

class ComparisonFile : public ::testing::Test {
 protected:
  void SetUp() override { std::remove(path_.c_str()); }
  void TearDown() override { std::remove(path_.c_str()); }
  const std::string path_ = ::testing::TempDir() + "comparison_table_test.csv";
};

TEST_F(ComparisonFile, ReturnsWhatWasAppended) {
  EXPECT_TRUE(read_comparison(path_).empty());
  append_comparison(path_, row("a", "mpc", 1, 123.25));
  ComparisonRow odd = row("b", "nearest", 18446744073709551615ULL, NAN);
  odd.reason = "failed: no way, none\nat all";
  append_comparison(path_, odd);
  const std::vector<ComparisonRow> rows = read_comparison(path_);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].map, "a");
  EXPECT_EQ(rows[0].time_to_95_s, 123.25);
  EXPECT_EQ(rows[0].coverage, 0.97);
  EXPECT_TRUE(std::isnan(rows[0].wall_s));
  EXPECT_EQ(rows[1].seed, 18446744073709551615ULL);
  EXPECT_EQ(rows[1].reason, "failed: no way  none at all");
  EXPECT_TRUE(rows[1].failed());
  EXPECT_TRUE(std::isnan(rows[1].time_to_95_s));
}

TEST_F(ComparisonFile, AnUnfinishedLineIsDroppedAndDoesNotSpoilTheNext) {
  append_comparison(path_, row("a", "mpc", 1, 100.0));
  std::ofstream(path_, std::ios::app) << "b,mpc,2,expl";
  EXPECT_EQ(read_comparison(path_).size(), 1U);
  append_comparison(path_, row("c", "mpc", 3, 100.0));
  const std::vector<ComparisonRow> rows = read_comparison(path_);
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[1].map, "c");
}

TEST_F(ComparisonFile, OtherFilesAreRefused) {
  std::ofstream(path_) << "x,y\n1,2\n";
  EXPECT_THROW(read_comparison(path_), InputError);
  std::ofstream(path_) << comparison_header() << "\na,mpc,1,explored,0.5\n";
  EXPECT_THROW(read_comparison(path_), InputError);
  std::string line = comparison_line(row("a", "mpc", 1, 2.0));
  line.replace(line.find("0.97"), 4, "0,9x");
  std::ofstream(path_) << comparison_header() << '\n' << line << '\n';
  EXPECT_THROW(read_comparison(path_), InputError);
}

TEST(ComparisonReport, PairsByMapAndSeedAndCountsWhatDidNotArrive) {
  std::vector<ComparisonRow> rows;
  // Map a: ratios 0.5 and 0.5. Map b: 1.25, and one that only the reference reached.
  rows.push_back(row("a", "mpc", 1, 100.0));
  rows.push_back(row("a", "mpc", 2, 200.0));
  rows.push_back(row("a", "nearest", 1, 200.0));
  rows.push_back(row("a", "nearest", 2, 400.0));
  rows.push_back(row("b", "mpc", 1, 250.0));
  rows.push_back(row("b", "mpc", 2, 300.0));
  rows.push_back(row("b", "nearest", 1, 200.0));
  rows.push_back(row("b", "nearest", 2, NAN));
  rows.back().reason = "time limit";
  rows.back().coverage = 0.8;
  const std::string report = comparison_report(rows);
  // sqrt(0.5 * 1.25) = 0.79 over maps; three pairs; won a, lost b; 20 % less on a.
  EXPECT_THAT(report, HasSubstr("| time to 95 % | 0.79 | 3 | 1 / 1 | 1 | 1 / 0 / 0 |"));
  EXPECT_THAT(report, HasSubstr("| a | 0.50, 0.50 | 0.50 |"));
  EXPECT_THAT(report, HasSubstr("| b | 1.25, only mpc | 1.25 |"));
  EXPECT_THAT(report, HasSubstr("- (0/2) / 200 (1/2) / - (0/2)"));
  EXPECT_THAT(report, HasSubstr("- b, nearest, seed 2: time limit, coverage 80.0 %"));
}

TEST(ComparisonReport, FailedMissionsAreCounted) {
  std::vector<ComparisonRow> rows = {row("a", "mpc", 1, 100.0), row("a", "mpc", 2, NAN)};
  rows[1].reason = "failed: signal 11";
  rows[1].coverage = NAN;
  const std::string report = comparison_report(rows);
  EXPECT_THAT(report, HasSubstr("| a | mpc | 2, 1 failed | 97.0 |"));
  EXPECT_THAT(report, HasSubstr("- a, mpc, seed 2: failed: signal 11"));
}

}  // namespace
}  // namespace prospect::comparison_table_test
