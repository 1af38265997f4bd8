// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "adapters/views/report/palette.h"

namespace prospect {

/// A picture of lines, areas and words, for print: white, in points of 1/72 inch, y down. The same
/// drawing gives the same bytes.
class Drawing {
 public:
  using Point = Eigen::Vector2d;
  enum class Anchor { kLeft, kCenter, kRight };

  Drawing(double width, double height) : width_(width), height_(height) {}

  double width() const { return width_; }
  double height() const { return height_; }

  /// Several rectangles of one colour, which meet without a seam.
  struct Rectangle {
    double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
  };
  void rectangles(std::vector<Rectangle> areas, Color color);
  /// With round ends and corners; at least two points.
  void line(std::vector<Point> points, Color color, double width);
  void circle(Point center, double radius, Color fill, Color edge, double edge_width);
  /// With a white rim, so that it is readable on a map (but in LaTeX). UTF-8; what cannot be
  /// printed becomes '?', in the image also what is no ASCII, in PDF what is not of Latin-1. `at`:
  /// on the base line. `size`: of the font.
  void text(const std::string& words, Point at, double size, Color color,
            Anchor anchor = Anchor::kLeft);
  /// About how wide such a text is.
  static double text_width(const std::string& words, double size);

  /// What stands for a colour in a page, which may be dark: {"#ffffff", "var(--surface)"}.
  using PageColors = std::map<std::string, std::string>;
  std::string svg(const PageColors& in_page = {}) const;
  /// One page as large as the drawing, PDF 1.4. Its font is Helvetica, which every reader has and
  /// which is not embedded.
  std::string pdf() const;
  /// A pgfpicture for \input in LaTeX with \usepackage{pgf}: words in the document's own font.
  std::string pgf() const;
  /// Letters are strokes (Hershey), so that no font has to be there.
  std::string png(double dots_per_inch = 600.0) const;

 private:
  /// Around the letters, of a font's size.
  static constexpr double kHalo = 0.3;
  struct Shape {
    enum class Kind { kRectangles, kLine, kCircle, kText } kind;
    std::vector<Rectangle> areas;
    std::vector<Point> points;
    std::string words;
    Color color, edge;
    double width = 0.0, radius = 0.0;
    Anchor anchor = Anchor::kLeft;
  };

  double width_, height_;
  std::vector<Shape> shapes_;
};

/// The forms that a drawing can be written in, by the ends of their files' names.
const std::vector<std::string>& drawing_formats();
/// A drawing in one of them.
std::string written(const Drawing& drawing, const std::string& format);

/// A length or place in a file: to a hundredth of a point, short.
std::string coordinate_text(double points);

}  // namespace prospect
