// SPDX-License-Identifier: Apache-2.0
#include <utility>

#include "adapters/views/report/drawing.h"

namespace prospect {
namespace {

/// Words as LaTeX reads them.
std::string escape_latex(const std::string& words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '#':
      case '$':
      case '%':
      case '&':
      case '_':
      case '{':
      case '}':
        text += '\\';
        text += c;
        break;
      case '~':
        text += "\\textasciitilde{}";
        break;
      case '^':
        text += "\\textasciicircum{}";
        break;
      case '\\':
        text += "\\textbackslash{}";
        break;
      case '<':
        text += "\\ensuremath{<}";
        break;
      case '>':
        text += "\\ensuremath{>}";
        break;
      case '|':
        text += "\\ensuremath{|}";
        break;
      default:
        text += c;
    }
  }
  return text;
}

std::string color_of(Color c, const std::string& use) {
  return "\\definecolor{prospect}{RGB}{" + std::to_string(c.red) + ',' + std::to_string(c.green) +
         ',' + std::to_string(c.blue) + "}\\pgfset" + use + "color{prospect}%\n";
}

}  // namespace

std::string Drawing::pgf() const {
  // Points of print are "bp" in LaTeX; y is up.
  const auto length = [](double value) { return coordinate_text(value) + "bp"; };
  const auto point = [&](const Point& p) {
    return "{\\pgfpoint{" + length(p.x()) + "}{" + length(height_ - p.y()) + "}}";
  };
  const auto stroke = [&](double width) { return "\\pgfsetlinewidth{" + length(width) + "}%\n"; };
  std::string out =
      "% \\usepackage{pgf} \\usepackage[T1]{fontenc} ... \\input{THIS FILE}\n\\begingroup%\n"
      "\\begin{pgfpicture}%\n\\pgfpathrectangle{\\pgfpointorigin}{\\pgfpoint{" +
      length(width_) + "}{" + length(height_) +
      "}}\\pgfusepath{use as bounding box}%\n\\pgfsetroundcap\\pgfsetroundjoin%\n";
  for (const Shape& s : shapes_) {
    switch (s.kind) {
      case Shape::Kind::kRectangles:
        out += color_of(s.color, "fill");
        for (const Rectangle& r : s.areas) {
          out += "\\pgfpathrectangle" + point({r.x, r.y + r.height}) + "{\\pgfpoint{" +
                 length(r.width) + "}{" + length(r.height) + "}}%\n";
        }
        out += "\\pgfusepath{fill}%\n";
        break;
      case Shape::Kind::kLine:
        out += color_of(s.color, "stroke") + stroke(s.width);
        for (std::size_t i = 0; i < s.points.size(); ++i) {
          out += (i == 0 ? "\\pgfpathmoveto" : "\\pgfpathlineto") + point(s.points[i]) + "%\n";
        }
        out += "\\pgfusepath{stroke}%\n";
        break;
      case Shape::Kind::kCircle:
        out += color_of(s.color, "fill") + color_of(s.edge, "stroke") + stroke(s.width) +
               "\\pgfpathcircle" + point(s.points[0]) + "{" + length(s.radius) + "}" +
               "\\pgfusepath{" + (s.width > 0.0 ? "fill,stroke" : "fill") + "}%\n";
        break;
      case Shape::Kind::kText:
        out += color_of(s.color, "fill") + "\\pgftext[base," +
               (s.anchor == Anchor::kLeft     ? "left,"
                : s.anchor == Anchor::kCenter ? ""
                                              : "right,") +
               "x=" + length(s.points[0].x()) + ",y=" + length(height_ - s.points[0].y()) +
               "]{\\color{prospect}\\sffamily\\fontsize{" + coordinate_text(s.width) + "bp}{" +
               coordinate_text(1.2 * s.width) + "bp}\\selectfont " + escape_latex(s.words) + "}%\n";
        break;
    }
  }
  return out + "\\end{pgfpicture}%\n\\endgroup%\n";
}

}  // namespace prospect
