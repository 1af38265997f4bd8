// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/input_log.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace prospect::input_log_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(InputLog, JudgesStampsByTheirSourceAndByTheNewestOfAll) {
  InputLog log(0.5);
  struct Row {
    InputSource source;
    double stamp;
    bool in_order;
    InputState state;  // if not
    const char* reason;
  };
  using enum InputSource;
  using enum InputState;
  const Row rows[] = {
      {kStereo, 100.0, true, kTaken, ""},
      {kDepth, 99.8, true, kTaken, ""},  // a bit older than another source: in order
      {kStereo, 100.0, false, kLate, "100.000 s is not after the one before, 100.000 s"},
      {kStereo, 99.9, false, kLate, "99.900 s is not after the one before, 100.000 s"},
      {kWheels, 99.4, false, kLate, "0.600 s older than the newest input; expected at most 0.5 s"},
      {kWheels, 99.5, true, kTaken, ""},
      {kScan, kNaN, false, kRefused, "the time is not a number"},
      {kScan, kInfinity, false, kRefused, "the time is not a number"},
      {kScan, 3701.0, false, kRefused, "3601 s ahead of the newest input"},
      {kScan, 100.1, true, kTaken, ""},
      {kDepth, 99.7, false, kLate, "is not after the one before"},
      {kDepth, 100.2, true, kTaken, ""},
  };
  int left_out[4] = {};
  for (const Row& row : rows) {
    const auto objection = log.objection(row.source, row.stamp);
    ASSERT_EQ(objection.has_value(), !row.in_order) << to_string(row.source) << " " << row.stamp;
    const InputCount& count = log.count(row.source);
    if (row.in_order) {
      EXPECT_EQ(count.newest, row.stamp);
      continue;
    }
    ++left_out[static_cast<int>(row.source)];
    EXPECT_EQ(objection->state, row.state);
    EXPECT_NE(objection->reason.find(row.reason), std::string::npos) << objection->reason;
    EXPECT_EQ(count.reason, objection->reason);
    EXPECT_EQ(count.late + count.refused,
              static_cast<std::uint64_t>(left_out[static_cast<int>(row.source)]));
  }
}

TEST(InputLog, CountsWhatBecomesOfInputs) {
  InputLog log(1.0);
  const InputCount& count = log.count(InputSource::kDepth);
  log.note(InputSource::kDepth, {InputState::kTaken, "frames are missing"});
  log.note(InputSource::kDepth, {InputState::kWaiting, "waits"});
  log.note(InputSource::kDepth, {InputState::kWaiting, "waits"});
  EXPECT_EQ(count.waiting, 2U);
  EXPECT_EQ(count.reason, "");
  log.note(InputSource::kDepth, {InputState::kTaken, ""}, true);
  log.note(InputSource::kDepth, {InputState::kRefused, "noise"}, true);
  EXPECT_EQ(count.waiting, 0U);
  EXPECT_EQ(count.taken, 2U);
  EXPECT_EQ(count.refused, 1U);
  EXPECT_EQ(count.late, 0U);
  EXPECT_EQ(count.reason, "noise");
  EXPECT_EQ(log.count(InputSource::kStereo).taken, 0U);
}

}  // namespace
}  // namespace prospect::input_log_test
