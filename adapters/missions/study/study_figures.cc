#include "adapters/missions/study/study_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "adapters/views/report/figure_source.h"
#include "adapters/views/report/run_figure.h"
#include "adapters/views/report/step_table.h"
#include "engine/support/quantile.h"

namespace prospect {
namespace {

constexpr Color kText = {0x1a, 0x20, 0x2c}, kFaint = {0xe1, 0xe5, 0xea}, kAxis = {0x7d, 0x87, 0x94},
                kWhite = {0xff, 0xff, 0xff};
constexpr double kFont = 7.5;  // [pt]

Color setup_color(std::size_t index) {
  static const std::vector<Color> colors = {
      {0x25, 0x63, 0xeb}, {0xea, 0x58, 0x0c}, {0x0d, 0x94, 0x88}, {0xc0, 0x26, 0xd3},
      {0xca, 0x8a, 0x04}, {0xdc, 0x26, 0x26}, {0x65, 0xa3, 0x0d}, {0x57, 0x53, 0x4e},
      {0x38, 0xbd, 0xf8}, {0x78, 0x35, 0x0f}, {0xf4, 0x72, 0xb6}, {0x1e, 0x3a, 0x8a}};
  return colors[index % colors.size()];
}

Color pale(Color color) {
  const auto mix = [](int c) { return static_cast<std::uint8_t>(c + (255 - c) * 6 / 10); };
  return {mix(color.red), mix(color.green), mix(color.blue)};
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

/// At most so wide, with ".." where it was cut.
std::string fitted(std::string words, double width) {
  if (Drawing::text_width(words, kFont) <= width) return words;
  while (words.size() > 3 && Drawing::text_width(words + "..", kFont) > width) words.pop_back();
  return words + "..";
}

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

/// A rectangle of the paper with linear axes.
struct Panel {
  double left, top, width, height;  // [pt]
  double x0, x1, y0, y1;            // what lies at the edges
  Drawing::Point at(double x, double y) const {
    return {left + width * (x - x0) / (x1 - x0), top + height * (y1 - y) / (y1 - y0)};
  }
};

void draw_y_axis(Drawing& drawing, const Panel& panel, const std::string& title) {
  for (const double y : ticks(panel.y0, panel.y1, 4)) {
    const Drawing::Point p = panel.at(panel.x0, y);
    drawing.line({p, {panel.left + panel.width, p.y()}}, kFaint, 0.5);
    drawing.text(number_text(y), {panel.left - 3.0, p.y() + 2.5}, kFont, kText,
                 Drawing::Anchor::kRight);
  }
  drawing.text(title, {panel.left - 22.0, panel.top - 6.0}, kFont, kText);
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

/// A colour and a name for each setup, in a column.
void draw_setups(Drawing& drawing, const StudyPlan& plan, double left, double top, double width) {
  for (std::size_t s = 0; s < plan.setups.size(); ++s) {
    const double y = top + 10.0 * static_cast<double>(s);
    drawing.line({{left, y - 2.5}, {left + 10.0, y - 2.5}}, setup_color(s), 1.8);
    drawing.text(fitted(plan.label(plan.setups[s]), width - 14.0), {left + 14.0, y}, kFont, kText);
  }
}

/// Ratio of means by number, a line for each comparison, on a logarithmic axis.
Drawing ratio_figure(const std::vector<StudyComparison>& comparisons) {
  constexpr double kLeft = 186.0, kWidth = 270.0, kTop = 14.0, kRow = 7.0;
  std::vector<std::size_t> numbers;
  double least = 0.5, most = 2.0;
  for (std::size_t k = 0; k < comparisons.front().numbers.size(); ++k) {
    bool any = false;
    for (const StudyComparison& c : comparisons) {
      const NumberComparison& n = c.numbers[k];
      if (!(n.ratio.mean > 0.0) || !std::isfinite(n.ratio.mean)) continue;
      any = true;
      least = std::min(least, std::max(0.05, n.ratio.low));
      most = std::max(most, std::min(20.0, n.ratio.high));
    }
    if (any) numbers.push_back(k);
  }
  const double block = kRow * static_cast<double>(comparisons.size()) + 4.0;
  const double bottom = kTop + block * static_cast<double>(numbers.size());
  Drawing drawing(kLeft + kWidth + 12.0,
                  bottom + 24.0 + 10.0 * static_cast<double>(comparisons.size()));
  const auto x_of = [&](double ratio) {
    const double shown = std::clamp(ratio, least, most);
    return kLeft + kWidth * std::log(shown / least) / std::log(most / least);
  };
  std::vector<double> ticks = {0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
  constexpr double kLabel = 18.0;
  if (x_of(1.25) - x_of(1.0) > kLabel) ticks.insert(ticks.end(), {0.8, 1.25});
  for (const double tick : ticks) {
    if (tick < least || tick > most) continue;
    const double x = x_of(tick);
    drawing.line({{x, kTop - 4.0}, {x, bottom}}, tick == 1.0 ? kAxis : kFaint,
                 tick == 1.0 ? 0.9 : 0.5);
    drawing.text(number_text(tick), {x, bottom + 9.0}, kFont, kText, Drawing::Anchor::kCenter);
  }
  for (std::size_t row = 0; row < numbers.size(); ++row) {
    const double top = kTop + block * static_cast<double>(row);
    drawing.text(fitted(comparisons.front().numbers[numbers[row]].number->label, kLeft - 8.0),
                 {kLeft - 6.0, top + 0.5 * block}, kFont, kText, Drawing::Anchor::kRight);
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
      const NumberComparison& n = comparisons[i].numbers[numbers[row]];
      if (!(n.ratio.mean > 0.0) || !std::isfinite(n.ratio.mean)) continue;
      const double y = top + kRow * (static_cast<double>(i) + 0.5);
      drawing.line({{x_of(n.ratio.low), y}, {x_of(n.ratio.high), y}}, setup_color(i), 1.1);
      drawing.circle({x_of(n.ratio.mean), y}, 1.9, setup_color(i), kWhite, 0.4);
    }
  }
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const double y = bottom + 22.0 + 10.0 * static_cast<double>(i);
    drawing.circle({kLeft, y - 2.5}, 1.9, setup_color(i), kWhite, 0.4);
    const StudyComparison& c = comparisons[i];
    drawing.text(fitted(c.label + (c.among.empty() ? "" : " (" + c.among + ")") + ", " +
                            std::to_string(c.pairs.size()) + " pairs",
                        kWidth),
                 {kLeft + 8.0, y}, kFont, kText);
  }
  return drawing;
}

/// A panel for each of the chief numbers, in it a box for each setup.
Drawing box_figure(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  constexpr double kWidth = 126.0, kHeight = 90.0, kGapX = 34.0, kGapY = 30.0;
  constexpr int kColumns = 3;
  const std::vector<StudyNumber>& all = study_numbers(plan.study.kind);
  std::vector<std::size_t> chief;
  for (std::size_t n = 0; n < all.size(); ++n) {
    if (all[n].chief) chief.push_back(n);
  }
  const int lines = (static_cast<int>(chief.size()) + kColumns - 1) / kColumns;
  const double keys = 24.0 + lines * (kHeight + kGapY);
  Drawing drawing(8.0 + kColumns * (kWidth + kGapX),
                  keys + 10.0 * static_cast<double>(plan.setups.size()));
  for (std::size_t k = 0; k < chief.size(); ++k) {
    const std::size_t n = chief[k];
    const StudyNumber& number = all[n];
    std::vector<std::vector<double>> values(plan.setups.size());
    double most = 0.0;
    for (const StudyRow& row : rows) {
      const double v = number.scale * value_of(row, n);
      if (!std::isfinite(v)) continue;
      values[row.cell->setup].push_back(v);
      most = std::max(most, v);
    }
    const int column = static_cast<int>(k) % kColumns, line = static_cast<int>(k) / kColumns;
    const Panel panel = {kGapX + column * (kWidth + kGapX),
                         18.0 + line * (kHeight + kGapY),
                         kWidth,
                         kHeight,
                         0.0,
                         static_cast<double>(plan.setups.size()),
                         0.0,
                         most > 0.0 ? 1.05 * most : 1.0};
    draw_y_axis(drawing, panel, fitted(number.label, kWidth + 20.0));
    for (std::size_t s = 0; s < values.size(); ++s) {
      if (values[s].empty()) {
        drawing.text("none", panel.at(static_cast<double>(s) + 0.5, 0.0) - Drawing::Point(0, 3),
                     kFont, kAxis, Drawing::Anchor::kCenter);
        continue;
      }
      const double x = static_cast<double>(s) + 0.5;
      const double low = quantile(values[s], 0.25), high = quantile(values[s], 0.75);
      const double reach = 1.5 * (high - low);
      double from = high, to = low;  // the farthest values within reach
      for (const double v : values[s]) {
        if (v >= low - reach) from = std::min(from, v);
        if (v <= high + reach) to = std::max(to, v);
      }
      const Color color = setup_color(s);
      drawing.line({panel.at(x, from), panel.at(x, to)}, color, 0.8);
      const double half = 0.28;
      const Drawing::Point a = panel.at(x - half, high), b = panel.at(x + half, low);
      drawing.rectangles({{a.x(), a.y(), b.x() - a.x(), std::max(0.5, b.y() - a.y())}},
                         pale(color));
      const double middle = quantile(values[s], 0.5);
      drawing.line({panel.at(x - half, middle), panel.at(x + half, middle)}, color, 1.6);
      for (const double v : values[s]) {
        if (v < from || v > to) drawing.circle(panel.at(x, v), 1.2, kWhite, color, 0.7);
      }
    }
  }
  draw_setups(drawing, plan, kGapX, keys, kColumns * (kWidth + kGapX) - kGapX);
  return drawing;
}

struct CurveKind {
  const char* name;
  const char* x_title;
  const char* y_title;
  std::vector<double> MissionCurve::*x;
  std::vector<double> MissionCurve::*y;
  double scale;
};

/// Medians as thick, quartiles as thin lines.
Drawing curve_figure(const StudyPlan& plan, const CurveKind& kind,
                     const std::vector<std::vector<const MissionCurve*>>& by_setup) {
  constexpr int kPoints = 80;
  double end = 0.0;
  for (const auto& curves : by_setup) {
    for (const MissionCurve* curve : curves) {
      if (!(curve->*kind.x).empty()) end = std::max(end, (curve->*kind.x).back());
    }
  }
  if (!(end > 0.0)) end = 1.0;
  std::vector<std::vector<Quartiles>> values(by_setup.size());
  double most = 0.0;
  for (std::size_t s = 0; s < by_setup.size(); ++s) {
    if (by_setup[s].empty()) continue;
    for (int n = 0; n <= kPoints; ++n) {
      const Quartiles q = quartiles_at(by_setup[s], kind.x, kind.y, end * n / kPoints);
      values[s].push_back({kind.scale * q.low, kind.scale * q.median, kind.scale * q.high});
      if (std::isfinite(q.high)) most = std::max(most, kind.scale * q.high);
    }
  }
  const double rows = 10.0 * static_cast<double>(plan.setups.size());
  Drawing drawing(252.0, 190.0 + rows);
  const Panel panel = {30.0, 18.0, 214.0, 138.0, 0.0, end, 0.0, most > 0.0 ? 1.05 * most : 1.0};
  draw_y_axis(drawing, panel, kind.y_title);
  draw_x_axis(drawing, panel, kind.x_title);
  const auto draw = [&](double Quartiles::*which, double width) {
    for (std::size_t s = 0; s < values.size(); ++s) {
      std::vector<Drawing::Point> points;
      for (std::size_t n = 0; n < values[s].size(); ++n) {
        const double y = values[s][n].*which;
        if (std::isfinite(y)) points.push_back(panel.at(end * static_cast<double>(n) / kPoints, y));
      }
      const Color color = setup_color(s);
      if (points.size() > 1) {
        drawing.line(points, which == &Quartiles::median ? color : pale(color), width);
      }
    }
  };
  draw(&Quartiles::low, 0.8);
  draw(&Quartiles::high, 0.8);
  draw(&Quartiles::median, 1.6);
  draw_setups(drawing, plan, 30.0, 188.0, 214.0);
  return drawing;
}

/// Fit for a file's name.
std::string file_word(const std::string& text) {
  std::string word;
  for (const char c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (plain || c == '.' || c == '-') {
      word += c;
    } else if (!word.empty() && word.back() != '_') {
      word += '_';
    }
  }
  return word;
}

}  // namespace

MissionCurve read_curve(const std::string& run_folder) {
  const StepTable table = StepTable::read(run_folder + "/steps.csv");
  return {table.numbers("time"), table.numbers("path_length"), table.numbers("coverage"),
          table.numbers("localization_error")};
}

Quartiles quartiles_at(const std::vector<const MissionCurve*>& curves,
                       std::vector<double> MissionCurve::*x, std::vector<double> MissionCurve::*y,
                       double at) {
  std::vector<double> values;
  for (const MissionCurve* curve : curves) {
    const std::vector<double>& xs = curve->*x;
    const auto past = std::upper_bound(xs.begin(), xs.end(), at);
    if (past == xs.begin()) continue;
    const double value = (curve->*y)[static_cast<std::size_t>(past - xs.begin()) - 1];
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty()) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    return {kNone, kNone, kNone};
  }
  return {quantile(values, 0.25), quantile(values, 0.5), quantile(values, 0.75)};
}

std::vector<StudyFigure> study_figures(const StudyPlan& plan, const CellStore& store,
                                       const std::vector<StudyRow>& rows,
                                       const std::vector<StudyComparison>& comparisons,
                                       const Registries& registries, std::size_t most_paths) {
  std::vector<StudyFigure> figures;
  const auto is_done = [](const StudyRow& row) {
    return row.record.status == CellRecord::Status::kDone;
  };
  if (std::none_of(rows.begin(), rows.end(), is_done)) return figures;
  if (!comparisons.empty()) {
    figures.push_back(
        {"ratios",
         "Ratio of means over all pairs, with its 95 % bootstrap interval. Left of 1: "
         "less than the reference.",
         ratio_figure(comparisons)});
  }
  figures.push_back({"boxes",
                     "All of a setup: quartiles and median; whiskers to the farthest within 1.5 "
                     "interquartile ranges, others as circles.",
                     box_figure(plan, rows)});
  if (plan.study.kind == Study::Kind::kBenches) return figures;
  std::vector<MissionCurve> curves;
  curves.reserve(rows.size());
  std::vector<std::vector<const MissionCurve*>> by_setup(plan.setups.size());
  for (const StudyRow& row : rows) {
    if (!is_done(row)) continue;
    curves.push_back(read_curve(store.run_folder(row.id)));
    by_setup[row.cell->setup].push_back(&curves.back());
  }
  using C = MissionCurve;
  for (const CurveKind& kind :
       {CurveKind{"coverage_time", "time [s]", "coverage [%]", &C::time, &C::coverage, 100.0},
        CurveKind{"coverage_path", "path [m]", "coverage [%]", &C::path, &C::coverage, 100.0},
        CurveKind{"error_time", "time [s]", "position error [m]", &C::time, &C::error, 1.0},
        CurveKind{"error_path", "path [m]", "position error [m]", &C::path, &C::error, 1.0}}) {
    figures.push_back({kind.name,
                       "Median over the missions of a setup; thin: first and third quartile. A "
                       "mission that has ended keeps its last value.",
                       curve_figure(plan, kind, by_setup)});
  }
  std::set<std::pair<std::size_t, std::size_t>> drawn;
  std::size_t paths = 0;
  for (const StudyRow& row : rows) {
    if (!is_done(row) || paths == most_paths) continue;
    if (!drawn.emplace(row.cell->input, row.cell->setup).second) continue;
    const FigureSource source =
        read_figure_source(store.run_folder(row.id), PathColor::kFeatures, false, registries);
    const std::string world = plan.study.inputs[row.cell->input].name;
    const std::string label = plan.label(plan.setup(*row.cell));
    ++paths;
    figures.push_back(
        {"path_" + std::to_string(paths) + "_" + file_word(world) + "_" + file_word(label),
         world + ", seed " + std::to_string(row.cell->seed) + ", " + label +
             ": the path, coloured by the features in view.",
         path_figure(source.map ? &*source.map : nullptr, *source.path)});
  }
  return figures;
}

}  // namespace prospect
