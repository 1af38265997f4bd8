// SPDX-License-Identifier: Apache-2.0
#include "engine/planner/candidate.h"

#include <gtest/gtest.h>

namespace prospect::candidate_test {
namespace {

Candidate candidate(double cost, double violation) { return {"x", {}, cost, violation}; }

TEST(Candidate, FeasibleOnesComeFirstAndByTheirCost) {
  EXPECT_TRUE(candidate(2.0, 0.0) < candidate(3.0, 0.5 * kFeasible));
  EXPECT_TRUE(candidate(9.0, 0.5 * kFeasible) < candidate(1.0, 2.0 * kFeasible));
  EXPECT_FALSE(candidate(1.0, 2.0 * kFeasible) < candidate(9.0, 0.0));
}

TEST(Candidate, InfeasibleOnesComeByTheirViolationThenTheirCost) {
  EXPECT_TRUE(candidate(9.0, 0.1) < candidate(1.0, 0.2));
  EXPECT_TRUE(candidate(1.0, 0.2) < candidate(2.0, 0.2));
  EXPECT_FALSE(candidate(2.0, 0.2) < candidate(2.0, 0.2));
}

}  // namespace
}  // namespace prospect::candidate_test
