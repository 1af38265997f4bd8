// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_drawing.h"

#include <cmath>
#include <cstdio>
#include <iterator>

#include "adapters/missions/study/study_results.h"

namespace prospect::study_drawing {
namespace {

constexpr Color kSetups[] = {{0x25, 0x63, 0xeb}, {0x99, 0x99, 0x17}, {0xff, 0x00, 0x80},
                             {0x4c, 0x99, 0x99}, {0x80, 0x6a, 0x40}, {0x36, 0x74, 0xb2},
                             {0x26, 0x93, 0xff}, {0x99, 0x58, 0x17}};

constexpr double kMark = 14.0;  // room left of a name [pt]

/// Round numbers in [from, to], about `count` of them.
std::vector<double> ticks(double from, double to, int count) {
  const double raw = (to - from) / count;
  if (!(raw > 0.0)) return {from};
  const double unit = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = (raw <= unit         ? 1.0
                       : raw <= 2.0 * unit ? 2.0
                       : raw <= 5.0 * unit ? 5.0
                                           : 10.0) *
                      unit;
  std::vector<double> all;
  for (double n = std::ceil(from / step - 1e-9); n * step <= to + 1e-9 * step; n += 1.0) {
    all.push_back(n * step + 0.0);
  }
  return all;
}

}  // namespace

Color setup_color(std::size_t index) { return kSetups[index % std::size(kSetups)]; }

Color pale(Color color) {
  const auto mix = [](int c) { return static_cast<std::uint8_t>(c + (255 - c) * 6 / 10); };
  return {mix(color.red), mix(color.green), mix(color.blue)};
}

Drawing::PageColors page_colors() {
  Drawing::PageColors colors = {{hex(kText), "var(--ink)"},
                                {hex(kFaint), "var(--line)"},
                                {hex(kAxis), "var(--ink-3)"},
                                {hex(kWhite), "var(--surface)"}};
  for (const Color color : kSetups) {
    colors[hex(pale(color))] = "color-mix(in srgb, " + hex(color) + " 40%, var(--surface))";
  }
  return colors;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::vector<std::string> wrapped(const std::string& words, double width) {
  const auto fits = [&](const std::string& text) {
    return Drawing::text_width(text, kFont) <= width;
  };
  std::vector<std::string> lines;
  std::string rest = words;
  while (!fits(rest)) {
    std::size_t end = rest.size();
    while (end > 1 && !fits(rest.substr(0, end))) --end;
    while (end < rest.size() && (static_cast<unsigned char>(rest[end]) & 0xc0) == 0x80) --end;
    end = std::max<std::size_t>(end, 1);
    const std::size_t blank = rest.rfind(' ', end);
    if (blank != std::string::npos && blank > 0) end = blank;
    lines.push_back(rest.substr(0, end));
    rest.erase(0, end + (rest[end] == ' '));
  }
  lines.push_back(rest);
  return lines;
}

double draw_lines(Drawing& drawing, const std::vector<std::string>& lines, double left,
                  double top) {
  for (const std::string& line : lines) {
    drawing.text(line, {left, top}, kFont, kText);
    top += kLine;
  }
  return top;
}

void draw_y_axis(Drawing& drawing, const Panel& panel, const std::string& title) {
  for (const double y : ticks(panel.y0, panel.y1, 4)) {
    const Drawing::Point p = panel.at(panel.x0, y);
    drawing.line({p, {panel.left + panel.width, p.y()}}, kFaint, 0.5);
    drawing.text(number_text(y), {panel.left - 3.0, p.y() + 2.5}, kFont, kText,
                 Drawing::Anchor::kRight);
  }
  const std::vector<std::string> lines = wrapped(title, panel.width + 22.0);
  draw_lines(drawing, lines, panel.left - 22.0,
             panel.top - 6.0 - kLine * static_cast<double>(lines.size() - 1));
}

void draw_x_axis(Drawing& drawing, const Panel& panel, const std::string& title) {
  const double bottom = panel.top + panel.height;
  for (const double x : ticks(panel.x0, panel.x1, 5)) {
    const Drawing::Point p = panel.at(x, panel.y0);
    drawing.line({{p.x(), bottom}, {p.x(), bottom + 2.5}}, kAxis, 0.6);
    drawing.text(number_text(x), {p.x(), bottom + 10.0}, kFont, kText, Drawing::Anchor::kCenter);
  }
  drawing.line({{panel.left, bottom}, {panel.left + panel.width, bottom}}, kAxis, 0.6);
  drawing.text(title, {panel.left + panel.width, bottom + 19.0}, kFont, kText,
               Drawing::Anchor::kRight);
}

double names_height(const std::vector<Name>& names, double width) {
  std::size_t lines = 0;
  for (const Name& name : names) lines += wrapped(name.words, width - kMark).size();
  return kLine * static_cast<double>(lines);
}

void draw_names(Drawing& drawing, const std::vector<Name>& names, double left, double top,
                double width) {
  for (const Name& name : names) {
    drawing.line({{left, top - 2.5}, {left + 10.0, top - 2.5}}, name.color, 1.8);
    top = draw_lines(drawing, wrapped(name.words, width - kMark), left + kMark, top);
  }
}

std::vector<Name> setup_names(const StudyPlan& plan) {
  std::vector<Name> names;
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    names.push_back({setup_color(s), plan.label(plan.setups[s])});
  }
  return names;
}

std::vector<std::size_t> chief_numbers(Study::Kind kind) {
  const std::vector<StudyNumber>& all = study_numbers(kind);
  std::vector<std::size_t> chief;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].chief) chief.push_back(n);
  }
  return chief;
}

PanelGrid::PanelGrid(std::size_t panels)
    : below(14.0 + std::ceil(static_cast<double>(panels) / kColumns) * (kHeight + kGapY)) {}

Panel PanelGrid::at(std::size_t panel) const {
  const std::size_t column = panel % kColumns, line = panel / kColumns;
  return {kGapX + static_cast<double>(column) * (kWidth + kGapX),
          28.0 + static_cast<double>(line) * (kHeight + kGapY),
          kWidth,
          kHeight,
          0.0,
          1.0,
          0.0,
          1.0};
}

}  // namespace prospect::study_drawing
