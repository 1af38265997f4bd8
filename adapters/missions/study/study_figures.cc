// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/study/study_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "adapters/missions/study/axis_figure.h"
#include "adapters/missions/study/study_drawing.h"
#include "adapters/views/report/figure_source.h"
#include "adapters/views/report/run_figure.h"
#include "adapters/views/report/step_table.h"
#include "engine/support/quantile.h"

namespace prospect {

using namespace study_drawing;

namespace {

/// Ratio of means by number, a line for each comparison, on a logarithmic axis.
Drawing ratio_figure(const std::vector<StudyComparison>& comparisons) {
  constexpr double kWidth = 270.0, kTop = 14.0, kRow = 7.0;
  std::vector<std::size_t> numbers;
  double least = 0.5, most = 2.0, left = 0.0;
  for (std::size_t k = 0; k < comparisons.front().numbers.size(); ++k) {
    bool any = false;
    for (const StudyComparison& c : comparisons) {
      const NumberComparison& n = c.numbers[k];
      if (!(n.ratio.mean > 0.0) || !std::isfinite(n.ratio.mean)) continue;
      any = true;
      least = std::min(least, std::max(0.05, n.ratio.low));
      most = std::max(most, std::min(20.0, n.ratio.high));
    }
    if (!any) continue;
    numbers.push_back(k);
    const std::string label = comparisons.front().numbers[k].number->label;
    left = std::max(left, Drawing::text_width(label, kFont) + 10.0);
  }
  std::vector<Name> names;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const StudyComparison& c = comparisons[i];
    names.push_back({setup_color(i), c.label + (c.among.empty() ? "" : " (" + c.among + ")") +
                                         ", " + std::to_string(c.pairs.size()) + " pairs"});
  }
  const double block = kRow * static_cast<double>(comparisons.size()) + 4.0;
  const double bottom = kTop + block * static_cast<double>(numbers.size());
  Drawing drawing(left + kWidth + 12.0, bottom + 24.0 + names_height(names, left + kWidth - 8.0));
  const auto x_of = [&](double ratio) {
    const double shown = std::clamp(ratio, least, most);
    return left + kWidth * std::log(shown / least) / std::log(most / least);
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
    drawing.text(comparisons.front().numbers[numbers[row]].number->label,
                 {left - 6.0, top + 0.5 * block}, kFont, kText, Drawing::Anchor::kRight);
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
      const NumberComparison& n = comparisons[i].numbers[numbers[row]];
      if (!(n.ratio.mean > 0.0) || !std::isfinite(n.ratio.mean)) continue;
      const double y = top + kRow * (static_cast<double>(i) + 0.5);
      drawing.line({{x_of(n.ratio.low), y}, {x_of(n.ratio.high), y}}, setup_color(i), 1.1);
      drawing.circle({x_of(n.ratio.mean), y}, 1.9, setup_color(i), kWhite, 0.4);
    }
  }
  draw_names(drawing, names, 8.0, bottom + 22.0, left + kWidth - 8.0);
  return drawing;
}

/// A panel for each of the chief numbers, in it a box for each setup.
Drawing box_figure(const StudyPlan& plan, const std::vector<StudyRow>& rows) {
  const std::vector<StudyNumber>& all = study_numbers(plan.study.kind);
  const std::vector<std::size_t> chief = chief_numbers(plan.study.kind);
  const PanelGrid grid(chief.size());
  const std::vector<Name> names = setup_names(plan);
  Drawing drawing(PanelGrid::kPaper, grid.below + names_height(names, PanelGrid::kInner));
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
    Panel panel = grid.at(k);
    panel.x1 = static_cast<double>(plan.setups.size());
    panel.y1 = most > 0.0 ? 1.05 * most : 1.0;
    draw_y_axis(drawing, panel, number.label);
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
  draw_names(drawing, names, PanelGrid::kGapX, grid.below, PanelGrid::kInner);
  return drawing;
}

struct CurveKind {
  const char* name;
  const char* x_title;
  const char* y_title;
  std::vector<double> MissionCurve::*x;
  std::vector<double> MissionCurve::*y;
  double scale;
  bool stays;  ///< when a mission has ended
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
      const Quartiles q = quartiles_at(by_setup[s], kind.x, kind.y, end * n / kPoints, kind.stays);
      values[s].push_back({kind.scale * q.low, kind.scale * q.median, kind.scale * q.high});
      if (std::isfinite(q.high)) most = std::max(most, kind.scale * q.high);
    }
  }
  const std::vector<Name> names = setup_names(plan);
  Drawing drawing(252.0, 190.0 + names_height(names, 214.0));
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
  draw_names(drawing, names, 30.0, 188.0, 214.0);
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
                       double at, bool stays) {
  std::vector<double> values;
  for (const MissionCurve* curve : curves) {
    const std::vector<double>& xs = curve->*x;
    const auto past = std::upper_bound(xs.begin(), xs.end(), at);
    if (past == xs.begin() || (!stays && past == xs.end() && xs.back() < at)) continue;
    const double value = (curve->*y)[static_cast<std::size_t>(past - xs.begin()) - 1];
    if (std::isfinite(value)) values.push_back(value);
  }
  if (values.empty() || (!stays && 2 * values.size() < curves.size())) {
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
  for (std::size_t a = 0; a < plan.study.grid.size(); ++a) {
    if (plan.study.grid[a].values.size() < 2) continue;
    figures.push_back({"against_" + file_word(plan.study.grid[a].key),
                       "Means of what was measured at each value of " + plan.study.grid[a].key +
                           ", with 95 % bootstrap intervals; a point alone: one run.",
                       axis_figure(plan, rows, a)});
  }
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
       {CurveKind{"coverage_time", "time [s]", "coverage [%]", &C::time, &C::coverage, 100.0, true},
        CurveKind{"coverage_path", "path [m]", "coverage [%]", &C::path, &C::coverage, 100.0, true},
        CurveKind{"error_time", "time [s]", "position error [m]", &C::time, &C::error, 1.0, false},
        CurveKind{"error_path", "path [m]", "position error [m]", &C::path, &C::error, 1.0,
                  false}}) {
    figures.push_back(
        {kind.name,
         std::string("Median over the missions of a setup; thin: first and third quartile. ") +
             (kind.stays ? "What a mission has seen by its end stays seen."
                         : "Of the missions that still drive, while half of them do."),
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
