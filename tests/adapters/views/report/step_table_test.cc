// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/step_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::step_table_test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

std::string complaint(const std::string& text, const std::string& numbers = "") {
  try {
    const StepTable table = StepTable::parse(text, "run/steps.csv");
    if (!numbers.empty()) table.numbers(numbers);
  } catch (const InputError& error) {
    EXPECT_EQ(error.lines().size(), 1U);
    return error.what();
  }
  return "";
}

TEST(StepTable, FindsColumnsByTheirNames) {
  const StepTable table = StepTable::parse(
      "why,step,x\n\"turns back: 8, not 41\",0,1.5\n\"says \"\"no\"\"\",1,nan\n,2,\n", "t");
  EXPECT_EQ(table.rows(), 3U);
  EXPECT_THAT(table.words("why"), ElementsAre("turns back: 8, not 41", "says \"no\"", ""));
  const std::vector<double> x = table.numbers("x");
  EXPECT_EQ(x[0], 1.5);
  EXPECT_TRUE(std::isnan(x[1]) && std::isnan(x[2]));
  EXPECT_TRUE(table.has("x"));
  EXPECT_FALSE(table.has("y"));
}

TEST(StepTable, ARunWithoutAStepIsARun) { EXPECT_EQ(StepTable::parse("step,x\n", "t").rows(), 0U); }

TEST(StepTable, SaysWhereItIsBroken) {
  EXPECT_THAT(complaint(""), HasSubstr("run/steps.csv: empty file; expected"));
  EXPECT_THAT(complaint("a,b\n1,2\n"), HasSubstr("run/steps.csv:1: no column 'step'; expected"));
  EXPECT_THAT(complaint("step,x\n0,1\n1,\n2\n"),
              HasSubstr("run/steps.csv:4: 1 fields; expected 2"));
  EXPECT_THAT(complaint("step,x\n0,1\n1,2"), HasSubstr("run/steps.csv:3: the row is cut"));
  EXPECT_THAT(complaint("step,x\n0,\"1\n"), HasSubstr("run/steps.csv:2: a quote without"));
  EXPECT_THAT(complaint("step,x\n0,\"1\"2\n"), HasSubstr("run/steps.csv:2: a quote without"));
  EXPECT_THAT(complaint("step,x\n0,1\n1,2m\n", "x"),
              AllOf(HasSubstr("run/steps.csv:3: x is '2m'"), HasSubstr("expected a number")));
  EXPECT_THAT(complaint("step,x\n0,1\n", "mode"),
              AllOf(HasSubstr("no column 'mode'"), HasSubstr("expected")));
}

TEST(StepTable, EveryCutOfAFileIsRefusedOrHasWholeRowsOnly) {
  const std::string text = "step,why,x\n0,\"a, b\",1.25\n1,c,-3\n";
  for (std::size_t length = 0; length < text.size(); ++length) {
    const std::string part = text.substr(0, length);
    const bool whole = !part.empty() && part.back() == '\n';
    EXPECT_EQ(complaint(part, "x").empty(), whole) << '\'' << part << '\'';
  }
}

TEST(StepTable, ReadsOnlyFiles) {
  EXPECT_THROW(StepTable::read("/no/such/steps.csv"), InputError);
  EXPECT_THROW(StepTable::read(testing::TempDir()), InputError);
}

}  // namespace
}  // namespace prospect::step_table_test
