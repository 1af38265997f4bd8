// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/solver_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "adapters/formats/files/input_error.h"

namespace prospect::solver_choice_test {
namespace {

using ::testing::HasSubstr;

std::string refusal(const std::vector<std::string>& words) {
  try {
    choose_solvers(words, {});
  } catch (const InputError& e) {
    return e.what();
  }
  return "accepted";
}

TEST(SolverChoice, GivesEachBackEndTheOptionsThatFollowIt) {
  const auto choices = choose_solvers(
      {"hybrid", "candidates=200", "tolerance=1e-4", "sampling", "nlopt", "seed=7"}, {});
  ASSERT_EQ(choices.size(), 3U);
  EXPECT_EQ(choices[0].label, "hybrid,candidates=200,tolerance=1e-4");
  EXPECT_EQ(choices[0].solver->name(), "hybrid");
  EXPECT_EQ(std::get<int>(choices[0].options.at("candidates")), 200);
  EXPECT_EQ(std::get<double>(choices[0].options.at("tolerance")), 1e-4);
  EXPECT_TRUE(choices[1].options.empty());
  EXPECT_EQ(std::get<int>(choices[2].options.at("seed")), 7);
}

TEST(SolverChoice, TakesOneBackEndTwiceWithOtherOptions) {
  EXPECT_EQ(choose_solvers({"hybrid", "hybrid", "basins=3"}, {}).size(), 2U);
  EXPECT_THAT(refusal({"hybrid", "hybrid"}), HasSubstr("'hybrid' is named twice; expected"));
}

TEST(SolverChoice, RefusesWhatNoBackEndTakesInOneLine) {
  EXPECT_THAT(refusal({"hybird"}), HasSubstr("did you mean 'hybrid'?"));
  EXPECT_THAT(refusal({"candidates=3"}), HasSubstr("stands first; expected a back end"));
  EXPECT_THAT(refusal({"hybrid", "candidate=3"}), HasSubstr("did you mean 'candidates'?"));
  EXPECT_THAT(refusal({"hybrid", "candidates=3.5"}), HasSubstr("expected a whole number"));
  EXPECT_THAT(refusal({"hybrid", "candidates="}), HasSubstr("expected a whole number"));
  EXPECT_THAT(refusal({"hybrid", "tolerance=nan"}), HasSubstr("expected a number"));
  // What only the back end knows.
  EXPECT_THAT(refusal({"sampling", "max_evaluations=0"}),
              HasSubstr("--solver: sampling: option 'max_evaluations' is 0; expected 1 or more"));
  EXPECT_THAT(refusal({"sampling", "hybrid", "threads=1000"}), HasSubstr("expected 1 to 256"));
}

}  // namespace
}  // namespace prospect::solver_choice_test
