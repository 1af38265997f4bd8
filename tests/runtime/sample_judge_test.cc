// SPDX-License-Identifier: Apache-2.0
#include "runtime/sample_judge.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace prospect::sample_judge_test {
namespace {

TEST(SampleJudge, OneBadSampleDecidesNothingSeveralDo) {
  struct Row {
    std::string_view samples;  // b: bad
    bool is_bad;
  };
  for (const Row& row : {Row{"", false}, Row{"b", false}, Row{"bb", false}, Row{"bbb", true},
                         Row{"gggggggggb", false}, Row{"bggbggbggbggbggbgg", false},
                         Row{"bgbgbgb", true}, Row{"bbbbbbbbbbbbgg", false}, Row{"bbbbbg", true}}) {
    SampleJudge judge;
    for (const char sample : row.samples) sample == 'b' ? judge.bad("no number") : judge.good();
    EXPECT_EQ(judge.is_bad(), row.is_bad) << row.samples;
    EXPECT_EQ(judge.fault(), row.is_bad ? "no number" : "") << row.samples;
  }
}

}  // namespace
}  // namespace prospect::sample_judge_test
