// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/run_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <string>

namespace prospect::run_figure_test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A room of 6 m x 4 m with walls, one of which has a door.
GroundMap room() {
  GroundMap map({0.1, 0, 0, 60, 40});
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 60; ++i) {
      const bool wall = i == 0 || j == 0 || i == 59 || (j == 39 && std::abs(i - 30) > 5);
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

ColoredPath walk() {
  ColoredPath path;
  for (int k = 0; k < 60; ++k) {
    path.points.emplace_back(1.0 + 0.06 * k, 2.0 + std::sin(0.1 * k));
    path.values.push_back(k);
    path.modes.push_back(k < 20 ? "look around" : k < 50 ? "explore" : "retreat");
  }
  return path;
}

int occurrences(const std::string& text, const std::string& what) {
  int n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(RunFigure, TheMapIsAFewRectangles) {
  const std::string svg = map_figure(room()).svg();
  const std::string wall = "fill=\"#2b3440\" d=\"";
  const std::size_t at = svg.find(wall);
  ASSERT_NE(at, std::string::npos);
  const std::string path = svg.substr(at, svg.find('"', at + wall.size()) - at);
  EXPECT_EQ(occurrences(path, "z"), 5) << "four walls, one in two parts: " << path;
  EXPECT_THAT(svg, HasSubstr(">1 m</text>"));
  EXPECT_THAT(svg, HasSubstr(">free</text>"));
  EXPECT_THAT(svg, HasSubstr(">occupied</text>"));
}

TEST(RunFigure, TheScaleBarIsTrue) {
  const Drawing figure = map_figure(room());
  EXPECT_EQ(figure.width(), 252.0);
  // 6 m and 0.3 m on either side on 244 pt: a metre is 36.97 pt. The bar is 1 m, from 5 pt on.
  EXPECT_THAT(figure.svg(), HasSubstr(" 41.97,"));
  // 4.6 m high: 170.1 pt, and room for the bar and the margins.
  EXPECT_GT(figure.height(), 170.1);
  EXPECT_LT(figure.height(), 200.0);
}

TEST(RunFigure, EachColourSaysWhatItMeans) {
  const GroundMap map = room();
  ColoredPath path = walk();
  struct Case {
    PathColor by;
    std::vector<std::string> words;
  };
  for (const Case& c : {Case{PathColor::kPlain, {"path"}},
                        Case{PathColor::kFeatures, {"features in view", "0", "&gt;= 58"}},
                        Case{PathColor::kError, {"localization error", "&gt;= 58.00 m"}},
                        Case{PathColor::kSpeed, {"speed", "&gt;= 58.00 m/s"}},
                        Case{PathColor::kMode, {"look around", "explore", "retreat"}}}) {
    path.by = c.by;
    const std::string svg = path_figure(&map, path).svg();
    for (const std::string& word : c.words) EXPECT_THAT(svg, HasSubstr('>' + word + "</text>"));
    EXPECT_EQ(svg.find(">look around</text>") != std::string::npos, c.by == PathColor::kMode);
    for (const char* word : {"start", "end", "1 m"}) {
      EXPECT_THAT(svg, HasSubstr('>' + std::string(word) + "</text>"));
    }
    std::set<std::string> colors;
    for (std::size_t at = svg.find("<polyline"); at != std::string::npos;
         at = svg.find("<polyline", at + 1)) {
      if (svg.find("stroke-width=\"1.3\"", at) < svg.find("/>", at)) {
        colors.insert(svg.substr(svg.find("stroke=", at), 16));
      }
    }
    const std::size_t expected = c.by == PathColor::kPlain ? 1 : c.by == PathColor::kMode ? 3 : 30;
    EXPECT_GE(colors.size(), expected);
    if (expected < 30) {
      EXPECT_EQ(colors.size(), expected);
    }
  }
}

TEST(RunFigure, ThePathAloneOrTheMapAloneOrNothingIsAFigure) {
  EXPECT_THAT(path_figure(nullptr, walk()).svg(), HasSubstr(">start</text>"));
  const GroundMap map = room();
  EXPECT_THAT(path_figure(&map, {}).svg(), Not(HasSubstr(">start</text>")));
  const GroundMap unknown({0.1, 0, 0, 16, 16});
  for (const Drawing& figure : {map_figure(unknown), path_figure(nullptr, {})}) {
    EXPECT_GT(figure.png().size(), 100U);
    EXPECT_THAT(figure.svg(), Not(HasSubstr("nan")));
    EXPECT_THAT(figure.svg(), Not(HasSubstr("inf")));
  }
}

TEST(RunFigure, NumbersThatAreNoneLeaveAGap) {
  ColoredPath path = walk();
  path.by = PathColor::kFeatures;
  path.points[30].x() = kNone;
  path.points[0].y() = HUGE_VAL;
  path.values[10] = kNone;
  path.values[11] = HUGE_VAL;
  const std::string svg = path_figure(nullptr, path).svg();
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, HasSubstr(">start</text>"));
}

TEST(RunFigure, ManyModesTakeFurtherLines) {
  ColoredPath path = walk();
  path.by = PathColor::kMode;
  const double before = path_figure(nullptr, path).height();
  for (std::size_t k = 0; k < path.modes.size(); ++k) path.modes[k] = "mode " + std::to_string(k);
  EXPECT_GT(path_figure(nullptr, path).height(), before + 50.0);
}

TEST(RunFigure, AWorldShowsHowItWasRead) {
  Grid<std::uint8_t> reachable(GridFrame{0.1, 0, 0, 60, 40}, 0);
  for (int i = 1; i < 30; ++i) reachable[{i, 5}] = 1;
  Grid<CellState> read(reachable.frame, CellState::kFree);
  for (int i = 0; i < 60; ++i) read[{i, 0}] = CellState::kOccupied;
  read[{50, 20}] = CellState::kUnknown;
  const Pose start{{1.0, 2.0, 0.0}, 0.5 * M_PI};
  const Drawing figure = world_figure(read, reachable, start, {"6 x 4 m"});
  const std::string svg = figure.svg();
  for (const char* word : {"start", "can be seen", "free", "occupied", "unknown, taken for solid",
                           "rim: solid beyond", "6 x 4 m"}) {
    EXPECT_THAT(svg, HasSubstr(">" + std::string(word) + "</text>"));
  }
  // One run of cells that can be seen, one unknown cell.
  for (const char* color : {"#b9d3fa", "#f3d99b"}) {
    const std::size_t at = svg.find("fill=\"" + std::string(color) + "\" d=\"");
    ASSERT_NE(at, std::string::npos) << color;
    EXPECT_EQ(occurrences(svg.substr(at, svg.find("/>", at) - at), "M"), 1) << color;
  }
  // A long sentence takes further lines.
  const std::string sentence =
      "read without: 3 keys, 2 textures and a heightmap, which this reader does not know at all";
  EXPECT_GT(world_figure(read, reachable, start, {sentence}).height(), figure.height() + 5.0);
}

}  // namespace
}  // namespace prospect::run_figure_test
