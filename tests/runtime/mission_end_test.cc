// SPDX-License-Identifier: Apache-2.0
#include "runtime/mission_end.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

namespace prospect::mission_end_test {
namespace {

TEST(MissionEnd, EachHasARowWithANameOfItsOwn) {
  std::set<std::string_view> names;
  for (const MissionEndRow& row : mission_ends()) {
    EXPECT_EQ(&row_of(row.end), &row);
    EXPECT_EQ(mission_end_named(row.name), row.end);
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.meaning.ends_with('.')) << row.name;
  }
  EXPECT_EQ(names.size(), mission_ends().size());
  EXPECT_EQ(mission_end_named("done"), std::nullopt);
}

// Success is what is listed here, and nothing by default.
TEST(MissionEnd, OnlyTheseAreDone) {
  const std::set<MissionEnd> done{MissionEnd::kExplored, MissionEnd::kYieldTooLow,
                                  MissionEnd::kEnough, MissionEnd::kGoalReached,
                                  MissionEnd::kReturned};
  for (const MissionEndRow& row : mission_ends()) {
    EXPECT_EQ(row.outcome == Outcome::kDone, done.contains(row.end)) << row.name;
    EXPECT_EQ(row.outcome == Outcome::kCancelled, row.end == MissionEnd::kCancelled) << row.name;
  }
}

// A planner that says "done" without a cause that ends a task has not done it.
TEST(MissionEnd, ACauseThatEndsNoTaskIsNoSuccess) {
  const std::set<Cause> done{Cause::kExplored, Cause::kYieldTooLow, Cause::kGoalReached,
                             Cause::kReturned};
  int causes = 0;
  for (int n = 0; to_string(static_cast<Cause>(n)) != "?"; ++n, ++causes) {
    const auto cause = static_cast<Cause>(n);
    const MissionEnd end = end_for(cause);
    EXPECT_EQ(row_of(end).outcome == Outcome::kDone, done.contains(cause)) << to_string(cause);
    const bool ends =
        done.contains(cause) || cause == Cause::kUnreachable || cause == Cause::kGoalUnreachable;
    EXPECT_EQ(end == MissionEnd::kUnexplained, !ends) << to_string(cause);
    if (ends) {
      EXPECT_EQ(to_string(end), to_string(cause));
    }
  }
  EXPECT_GT(causes, 15);
}

TEST(MissionEnd, TheReferencePageIsTheTable) {
  std::ifstream file(std::string(PROSPECT_SOURCE_DIR) + "/docs/reference/report.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_NE(page.str().find("<!-- mission ends -->\n" + mission_end_table() + "<!-- end -->"),
            std::string::npos)
      << mission_end_table();
}

}  // namespace
}  // namespace prospect::mission_end_test
