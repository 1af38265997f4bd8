// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>

#include "tests/adapters/bench_example.h"

namespace prospect::bench_curves_test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(BenchCurves, EveryKindIsThereForEveryGroupAndBackEnd) {
  const auto sheets = curve_sheets(summarize(test::bench_example()));
  std::set<std::string> names;
  for (const CurveSheet& sheet : sheets) {
    names.insert(sheet.name);
    EXPECT_EQ(sheet.points.size(), 2U);
    EXPECT_FALSE(sheet.points[0].empty()) << sheet.name;
  }
  EXPECT_EQ(names.size(), 6U);
}

TEST(BenchCurves, CsvHasAllPoints) {
  const auto sheets = curve_sheets(summarize(test::bench_example()));
  std::size_t points = 0;
  for (const CurveSheet& sheet : sheets) {
    for (const auto& of : sheet.points) points += of.size();
  }
  std::istringstream csv(curves_csv(sheets));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "set,deadline_s,curve,solver,x,y,low,high");
  std::size_t lines = 0;
  for (; std::getline(csv, line); ++lines) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 7) << line;
  }
  EXPECT_EQ(lines, points);
  // The only one of the fast back end: it is best everywhere.
  EXPECT_THAT(curves_csv(sheets), HasSubstr("set,,profile_by_time,fast,1,1,1,1\n"));
}

TEST(BenchCurves, FiguresNameTheBackEndsAndAreTheSameBytesAgain) {
  for (const CurveSheet& sheet : curve_sheets(summarize(test::bench_example()))) {
    const std::string svg = curve_svg(sheet);
    EXPECT_THAT(svg, HasSubstr("<svg"));
    EXPECT_THAT(svg, HasSubstr(">fast<"));
    EXPECT_THAT(svg, HasSubstr(sheet.x_title));
    EXPECT_EQ(svg, curve_svg(sheet));
    EXPECT_EQ(svg.find("nan"), std::string::npos) << sheet.name;
  }
}

TEST(BenchCurves, FilesHavePlainNames) {
  EXPECT_EQ(group_file_name("zoo", 0.0), "zoo");
  EXPECT_EQ(group_file_name("zoo", 0.1), "zoo_100ms");
  EXPECT_EQ(group_file_name("a/b c", 0.0), "a-b-c");
}

}  // namespace
}  // namespace prospect::bench_curves_test
