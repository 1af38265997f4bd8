// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstdio>
#include <utility>

#include "adapters/views/report/drawing.h"

namespace prospect {
namespace {

constexpr double kRound = 0.5523;  // of a quarter of a circle as a cubic Bezier curve

/// Helvetica's advances of the characters from ' ' to '~' [1/1000 of the size]: Adobe's AFM.
constexpr std::array<int, 95> kAdvances = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

/// The bytes of Latin-1 for UTF-8; '?' for what has none.
std::string latin(const std::string& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto c = static_cast<unsigned char>(words[i]);
    if (c < 0x80) {
      text += words[i];
    } else if ((c & 0xc0) != 0x80) {
      const bool known = (c == 0xc2 || c == 0xc3) && i + 1 < words.size();
      text += known ? static_cast<char>(((c & 3) << 6) | (words[i + 1] & 0x3f)) : '?';
    }
  }
  return text;
}

/// [pt], of Latin-1.
double advance(const std::string& words, double size) {
  int sum = 0;
  for (const char c : words)
    sum += c >= ' ' && c <= '~' ? kAdvances[static_cast<std::size_t>(c - ' ')] : 556;
  return size * sum / 1000.0;
}

std::string in_parentheses(const std::string& words) {
  std::string text = "(";
  for (const char c : words) {
    if (c == '(' || c == ')' || c == '\\') text += '\\';
    text += c;
  }
  return text + ')';
}

std::string color_text(Color c, const char* operation) {
  std::array<char, 48> text{};
  std::snprintf(text.data(), text.size(), "%.3g %.3g %.3g %s\n", c.red / 255.0, c.green / 255.0,
                c.blue / 255.0, operation);
  return text.data();
}

std::string numbers(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) text += coordinate_text(value) + ' ';
  return text;
}

std::string circle_path(const Drawing::Point& c, double r) {
  const double k = kRound * r, x = c.x(), y = c.y();
  return numbers({x + r, y}) + "m " + numbers({x + r, y + k, x + k, y + r, x, y + r}) + "c " +
         numbers({x - k, y + r, x - r, y + k, x - r, y}) + "c " +
         numbers({x - r, y - k, x - k, y - r, x, y - r}) + "c " +
         numbers({x + k, y - r, x + r, y - k, x + r, y}) + "c h ";
}

}  // namespace

std::string Drawing::pdf() const {
  // From the upper edge down, as the shapes are told.
  std::string page = "1 J 1 j\n1 0 0 -1 0 " + coordinate_text(height_) + " cm\n";
  for (const Shape& s : shapes_) {
    switch (s.kind) {
      case Shape::Kind::kRectangles:
        page += color_text(s.color, "rg");
        for (const Rectangle& r : s.areas) page += numbers({r.x, r.y, r.width, r.height}) + "re\n";
        page += "f\n";
        break;
      case Shape::Kind::kLine:
        page += color_text(s.color, "RG") + coordinate_text(s.width) + " w\n";
        for (std::size_t i = 0; i < s.points.size(); ++i) {
          page += numbers({s.points[i].x(), s.points[i].y()}) + (i == 0 ? "m\n" : "l\n");
        }
        page += "S\n";
        break;
      case Shape::Kind::kCircle:
        page += color_text(s.color, "rg") + color_text(s.edge, "RG") + coordinate_text(s.width) +
                " w\n" + circle_path(s.points[0], s.radius) + (s.width > 0.0 ? "B\n" : "f\n");
        break;
      case Shape::Kind::kText: {
        const std::string words = latin(s.words);
        const double width = advance(words, s.width);
        const double left = s.anchor == Anchor::kLeft     ? 0.0
                            : s.anchor == Anchor::kCenter ? 0.5 * width
                                                          : width;
        const std::string shown = "BT /F " + coordinate_text(s.width) + " Tf 1 0 0 -1 " +
                                  numbers({s.points[0].x() - left, s.points[0].y()}) + "Tm ";
        page += color_text({255, 255, 255}, "RG") + coordinate_text(kHalo * s.width) + " w\n" +
                shown + "1 Tr " + in_parentheses(words) + " Tj ET\n" + color_text(s.color, "rg") +
                shown + "0 Tr " + in_parentheses(words) + " Tj ET\n";
        break;
      }
    }
  }
  const std::array<std::string, 5> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 " + numbers({width_, height_}) +
          "] /Contents 4 0 R /Resources << /Font << /F 5 0 R >> >> >>",
      "<< /Length " + std::to_string(page.size()) + " >>\nstream\n" + page + "\nendstream",
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>"};
  std::string file = "%PDF-1.4\n";
  std::string places = "0000000000 65535 f \n";
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::array<char, 32> place{};
    std::snprintf(place.data(), place.size(), "%010zu 00000 n \n", file.size());
    places += place.data();
    file += std::to_string(i + 1) + " 0 obj\n" + objects[i] + "\nendobj\n";
  }
  const std::string count = std::to_string(objects.size() + 1);
  return file + "xref\n0 " + count + '\n' + places + "trailer\n<< /Size " + count +
         " /Root 1 0 R >>\nstartxref\n" + std::to_string(file.size()) + "\n%%EOF\n";
}

}  // namespace prospect
