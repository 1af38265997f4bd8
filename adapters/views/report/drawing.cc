// SPDX-License-Identifier: Apache-2.0
#include "adapters/views/report/drawing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "adapters/formats/files/printable_text.h"
#include "adapters/formats/images/image_codec.h"

namespace prospect {
namespace {

constexpr double kCapHeight = 0.72;      // of a font's size
constexpr double kLetterWidth = 0.65;    // of a font's size, about; sans-serif fonts are narrower
constexpr double kStroke = 0.085;        // of a font's size
constexpr double kHersheyHeight = 21.0;  // of a capital at scale 1 [px]
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

std::string escape_xml(const std::string& words) {
  std::string text;
  for (const char c : words) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string(1, c);
  }
  return text;
}

/// A '?' for each character that is no ASCII.
std::string ascii(const std::string& words) {
  std::string text;
  for (const char c : words) {
    if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;
    text += c >= ' ' && c <= '~' ? c : '?';
  }
  return text;
}

/// Characters of UTF-8, of which the words hold nothing else.
std::size_t letters(const std::string& words) {
  return static_cast<std::size_t>(std::count_if(words.begin(), words.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xc0) != 0x80;
  }));
}

cv::Scalar bgr(Color c) { return {double(c.blue), double(c.green), double(c.red)}; }

/// On one line, whatever the words hold.
std::string printable_line(const std::string& words) {
  std::string text = printable(words);
  for (char& c : text) {
    if (c == '\n' || c == '\t') c = '?';
  }
  return text;
}

}  // namespace

std::string coordinate_text(double points) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", points);
  std::string short_text = text;
  while (short_text.back() == '0') short_text.pop_back();
  if (short_text.back() == '.') short_text.pop_back();
  return short_text == "-0" ? "0" : short_text;
}

const std::vector<std::string>& drawing_formats() {
  static const std::vector<std::string> formats = {"svg", "png", "pdf", "pgf"};
  return formats;
}

std::string written(const Drawing& drawing, const std::string& format) {
  return format == "png"   ? drawing.png()
         : format == "pdf" ? drawing.pdf()
         : format == "pgf" ? drawing.pgf()
                           : drawing.svg();
}

void Drawing::rectangles(std::vector<Rectangle> areas, Color color) {
  Shape shape{Shape::Kind::kRectangles, std::move(areas), {}, "", color, {}};
  if (!shape.areas.empty()) shapes_.push_back(std::move(shape));
}

void Drawing::line(std::vector<Point> points, Color color, double width) {
  Shape shape{Shape::Kind::kLine, {}, std::move(points), "", color, {}};
  shape.width = width;
  if (shape.points.size() >= 2) shapes_.push_back(std::move(shape));
}

void Drawing::circle(Point center, double radius, Color fill, Color edge, double edge_width) {
  Shape shape{Shape::Kind::kCircle, {}, {center}, "", fill, edge};
  shape.radius = radius;
  shape.width = edge_width;
  shapes_.push_back(std::move(shape));
}

void Drawing::text(const std::string& words, Point at, double size, Color color, Anchor anchor) {
  Shape shape{Shape::Kind::kText, {}, {at}, printable_line(words), color, {}};
  shape.width = size;
  shape.anchor = anchor;
  shapes_.push_back(std::move(shape));
}

double Drawing::text_width(const std::string& words, double size) {
  return kLetterWidth * size * static_cast<double>(letters(words));
}

std::string Drawing::svg(const PageColors& in_page) const {
  const auto tint = [&](Color color) {
    const std::string text = hex(color);
    const auto other = in_page.find(text);
    return other == in_page.end() ? text : other->second;
  };
  const std::string paper = tint({255, 255, 255});
  const std::string w = coordinate_text(width_), h = coordinate_text(height_);
  std::string out =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
      w + "pt\" height=\"" + h + "pt\" viewBox=\"0 0 " + w + ' ' + h +
      "\" font-family=\"Helvetica, Arial, 'DejaVu Sans', sans-serif\" "
      "stroke-linecap=\"round\" stroke-linejoin=\"round\">\n"
      "<rect width=\"" +
      w + "\" height=\"" + h + "\" fill=\"" + paper + "\"/>\n";
  for (const Shape& s : shapes_) {
    switch (s.kind) {
      case Shape::Kind::kRectangles:
        out += "<path shape-rendering=\"crispEdges\" fill=\"" + tint(s.color) + "\" d=\"";
        for (const Rectangle& r : s.areas) {
          out += 'M' + coordinate_text(r.x) + ' ' + coordinate_text(r.y) + 'h' +
                 coordinate_text(r.width) + 'v' + coordinate_text(r.height) + 'h' +
                 coordinate_text(-r.width) + 'z';
        }
        out += "\"/>\n";
        break;
      case Shape::Kind::kLine:
        out += "<polyline fill=\"none\" stroke=\"" + tint(s.color) + "\" stroke-width=\"" +
               coordinate_text(s.width) + "\" points=\"";
        for (const Point& p : s.points)
          out += coordinate_text(p.x()) + ',' + coordinate_text(p.y()) + ' ';
        out.back() = '"';
        out += "/>\n";
        break;
      case Shape::Kind::kCircle:
        out += "<circle cx=\"" + coordinate_text(s.points[0].x()) + "\" cy=\"" +
               coordinate_text(s.points[0].y()) + "\" r=\"" + coordinate_text(s.radius) +
               "\" fill=\"" + tint(s.color) + "\" stroke=\"" + tint(s.edge) + "\" stroke-width=\"" +
               coordinate_text(s.width) + "\"/>\n";
        break;
      case Shape::Kind::kText:
        out += "<text x=\"" + coordinate_text(s.points[0].x()) + "\" y=\"" +
               coordinate_text(s.points[0].y()) + "\" font-size=\"" + coordinate_text(s.width) +
               "\" fill=\"" + tint(s.color) + "\" stroke=\"" + paper +
               "\" paint-order=\"stroke\" stroke-width=\"" + coordinate_text(kHalo * s.width) +
               "\" text-anchor=\"" +
               (s.anchor == Anchor::kLeft     ? "start"
                : s.anchor == Anchor::kCenter ? "middle"
                                              : "end") +
               "\">" + escape_xml(s.words) + "</text>\n";
        break;
    }
  }
  return out + "</svg>\n";
}

std::string Drawing::png(double dots_per_inch) const {
  constexpr int kShift = 4;  // binary digits below the pixel
  const double scale = dots_per_inch / 72.0;
  cv::Mat image(std::max(1, static_cast<int>(std::lround(scale * height_))),
                std::max(1, static_cast<int>(std::lround(scale * width_))), CV_8UC3,
                cv::Scalar(255, 255, 255));
  // Pixel (0, 0) has its centre at half a pixel.
  const auto fine = [&](double v) {
    return static_cast<int>(std::lround((scale * v - 0.5) * (1 << kShift)));
  };
  const auto at = [&](const Point& p) { return cv::Point(fine(p.x()), fine(p.y())); };
  const auto pixels = [&](double v) {
    return std::max(1, static_cast<int>(std::lround(scale * v)));
  };
  for (const Shape& s : shapes_) {
    switch (s.kind) {
      case Shape::Kind::kRectangles:
        for (const Rectangle& r : s.areas) {  // edges rounded alike, so that neighbours meet
          const auto edge = [&](double v) { return static_cast<int>(std::lround(scale * v)); };
          const cv::Rect area(cv::Point(edge(r.x), edge(r.y)),
                              cv::Point(edge(r.x + r.width), edge(r.y + r.height)));
          if (area.area() > 0) cv::rectangle(image, area, bgr(s.color), cv::FILLED);
        }
        break;
      case Shape::Kind::kLine:
        for (std::size_t i = 1; i < s.points.size(); ++i) {
          cv::line(image, at(s.points[i - 1]), at(s.points[i]), bgr(s.color), pixels(s.width),
                   cv::LINE_AA, kShift);
        }
        break;
      case Shape::Kind::kCircle: {
        const auto radius = [&](double v) {
          return static_cast<int>(std::lround(scale * std::max(0.0, v) * (1 << kShift)));
        };
        cv::circle(image, at(s.points[0]), radius(s.radius + 0.5 * s.width), bgr(s.edge),
                   cv::FILLED, cv::LINE_AA, kShift);
        cv::circle(image, at(s.points[0]), radius(s.radius - 0.5 * s.width), bgr(s.color),
                   cv::FILLED, cv::LINE_AA, kShift);
        break;
      }
      case Shape::Kind::kText: {
        const std::string words = ascii(s.words);
        const double size = scale * s.width * kCapHeight / kHersheyHeight;
        const int stroke = pixels(kStroke * s.width);
        int below = 0;
        const cv::Size box = cv::getTextSize(words, kFont, size, stroke, &below);
        const double left = s.anchor == Anchor::kLeft     ? 0.0
                            : s.anchor == Anchor::kCenter ? 0.5 * box.width
                                                          : box.width;
        const cv::Point base(static_cast<int>(std::lround(scale * s.points[0].x() - left)),
                             static_cast<int>(std::lround(scale * s.points[0].y())));
        cv::putText(image, words, base, kFont, size, cv::Scalar(255, 255, 255),
                    stroke + pixels(kHalo * s.width), cv::LINE_AA);
        cv::putText(image, words, base, kFont, size, bgr(s.color), stroke, cv::LINE_AA);
        break;
      }
    }
  }
  // Level 9 makes figures 3 % smaller and takes twice as long.
  const std::vector<std::uint8_t> bytes =
      encode_pixels(".png", image, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return {bytes.begin(), bytes.end()};
}

}  // namespace prospect
