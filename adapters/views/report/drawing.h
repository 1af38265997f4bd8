#pragma once

#include <Eigen/Core>
#include <cstdint>
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
  /// With a white rim, so that it is readable on a map. ASCII; what else there is becomes '?'.
  /// `at`: on the base line. `size`: of the font.
  void text(const std::string& words, Point at, double size, Color color,
            Anchor anchor = Anchor::kLeft);
  /// About how wide such a text is.
  static double text_width(const std::string& words, double size);

  std::string svg() const;
  /// Letters are strokes (Hershey), so that no font has to be there.
  std::string png(double dots_per_inch = 600.0) const;

 private:
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

}  // namespace prospect
