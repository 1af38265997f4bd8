// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "tests/adapters/bench_example.h"
#include "tests/adapters/bench_folders.h"

namespace prospect::bench_compare_test {
namespace {

using ::testing::HasSubstr;

class BenchCompare : public test::BenchFolders {
 protected:
  static const PairedNumber& number(const SolverComparison& c, const std::string& name) {
    for (const PairedNumber& n : c.numbers) {
      if (n.name == name) return n;
    }
    throw std::out_of_range(name);
  }
};

TEST_F(BenchCompare, ABenchAgainstItselfIsWithinNoise) {
  const std::string a = write("a", test::bench_example(20));
  const BenchComparison c = compare_benches(a, a, 0.01);
  ASSERT_EQ(c.solvers.size(), 2U);
  for (const SolverComparison& solver : c.solvers) {
    EXPECT_EQ(solver.pairs, 20);
    EXPECT_EQ(solver.changed, 0);
    for (const PairedNumber& n : solver.numbers) {
      EXPECT_FALSE(n.beyond_noise) << n.name;
      EXPECT_EQ(n.change.mean, n.ratio ? 1.0 : 0.0) << n.name;
    }
  }
  EXPECT_THAT(comparison_text(c), HasSubstr("the same costs and counts"));
}

TEST_F(BenchCompare, WhatIsTwiceAsSlowEverywhereIsBeyondNoise) {
  const std::string a = write("a", test::bench_example(20)),
                    b = write("b", test::bench_example(20, 2.0));
  const BenchComparison c = compare_benches(a, b, 0.01);
  const SolverComparison& fast = c.solvers[0];
  EXPECT_EQ(fast.changed, 20);
  EXPECT_NEAR(number(fast, "time to target").change.mean, 2.0, 1e-9);
  EXPECT_NEAR(number(fast, "evaluations to target").change.low, 2.0, 1e-9);
  EXPECT_TRUE(number(fast, "time to target").beyond_noise);
  EXPECT_FALSE(number(fast, "solved").beyond_noise);
  EXPECT_EQ(number(c.solvers[1], "time to target").pairs, 19);  // one is never solved
  EXPECT_THAT(comparison_text(c), HasSubstr("beyond noise"));
}

TEST_F(BenchCompare, ChangesOfEitherSignAreNoise) {
  BenchTable b = test::bench_example(20);
  for (BenchRow& row : b.rows) {
    const double times = row.problem % 2 == 0 ? 1.3 : 1.0 / 1.3;
    row.seconds *= times;
    for (Improvement& i : row.trace) i.seconds *= times;
  }
  const BenchComparison c =
      compare_benches(write("a", test::bench_example(20)), write("b", b), 0.01);
  EXPECT_FALSE(number(c.solvers[0], "time to target").beyond_noise);
  EXPECT_EQ(c.solvers[0].changed, 0);
}

TEST_F(BenchCompare, BothAreJudgedByTheBestThatEitherKnows) {
  // The second finds a better basin of every problem: the first then solves none.
  BenchTable b = test::bench_example(12);
  for (BenchRow& row : b.rows) row.cost = row.trace.back().cost = 0.5;
  const BenchComparison c =
      compare_benches(write("a", test::bench_example(12)), write("b", b), 0.01);
  EXPECT_EQ(c.solvers[0].only_second_solved, 12);
  EXPECT_EQ(c.solvers[0].only_first_solved, 0);
  EXPECT_TRUE(number(c.solvers[0], "solved").beyond_noise);
}

TEST_F(BenchCompare, RefusesOtherProblemsAndSaysWhatOnlyOneHas) {
  const std::string a = write("a", test::bench_example(6));
  BenchTable other = test::bench_example(6);
  other.sets[0].problems[1].fingerprint = "feed";
  try {
    compare_benches(a, write("b", other), 0.01);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("problem 'p1' of 'set' is not the same in both; expected"));
  }
  EXPECT_EQ(compare_benches(a, write("c", test::bench_example(4)), 0.01).only_first, 4);
  other = test::bench_example(6);
  other.solvers = {"neither", "nor"};
  EXPECT_THROW(compare_benches(a, write("d", other), 0.01), InputError);
}

}  // namespace
}  // namespace prospect::bench_compare_test
