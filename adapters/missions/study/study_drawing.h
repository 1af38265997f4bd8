// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adapters/missions/study/study_plan.h"
#include "adapters/views/report/drawing.h"

/// What the figures of a study share. Lengths in points.
namespace prospect::study_drawing {

inline constexpr Color kText = {0x1a, 0x20, 0x2c}, kFaint = {0xe1, 0xe5, 0xea},
                       kAxis = {0x7d, 0x87, 0x94}, kWhite = {0xff, 0xff, 0xff};
inline constexpr double kFont = 7.5, kLine = 10.0;

/// Of a setup or comparison, by its place; eight, apart for the colour-blind, too, and readable on
/// white as on the dark of a page.
Color setup_color(std::size_t index);
/// The same, of what stands behind.
Color pale(Color color);
/// What stands for these colours in a page that may be dark (adapters/views/page/page.css).
Drawing::PageColors page_colors();

/// To four digits.
std::string number_text(double value);

/// In lines of at most that width, broken at blanks, and within a word that is wider.
std::vector<std::string> wrapped(const std::string& words, double width);
/// Lines below each other; returns the base line of the next.
double draw_lines(Drawing& drawing, const std::vector<std::string>& lines, double left, double top);

/// A rectangle of the paper with linear axes.
struct Panel {
  double left, top, width, height;
  double x0, x1, y0, y1;  ///< what lies at the edges
  Drawing::Point at(double x, double y) const {
    return {left + width * (x - x0) / (x1 - x0), top + height * (y1 - y) / (y1 - y0)};
  }
};
/// With the title above, in as many lines as it takes.
void draw_y_axis(Drawing& drawing, const Panel& panel, const std::string& title);
void draw_x_axis(Drawing& drawing, const Panel& panel, const std::string& title);

/// A name beside a mark of its colour.
struct Name {
  Color color;
  std::string words;
};
std::vector<Name> setup_names(const StudyPlan& plan);
/// Of names below each other, each whole.
double names_height(const std::vector<Name>& names, double width);
void draw_names(Drawing& drawing, const std::vector<Name>& names, double left, double top,
                double width);

/// Places of the chief numbers among study_numbers().
std::vector<std::size_t> chief_numbers(Study::Kind kind);

/// Panels of the chief numbers, three beside each other.
struct PanelGrid {
  static constexpr double kWidth = 126.0, kHeight = 90.0, kGapX = 34.0, kGapY = 42.0;
  static constexpr int kColumns = 3;
  static constexpr double kInner = kColumns * (kWidth + kGapX) - kGapX;  ///< width of names
  static constexpr double kPaper = 8.0 + kColumns * (kWidth + kGapX);    ///< width of the drawing

  explicit PanelGrid(std::size_t panels);
  Panel at(std::size_t panel) const;
  double below;  ///< where names begin
};

}  // namespace prospect::study_drawing
