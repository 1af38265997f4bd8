// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/bench/bench_curves.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "adapters/formats/files/csv.h"
#include "adapters/views/report/drawing.h"
#include "models/range_text.h"

namespace prospect {
namespace {

constexpr Color kInk = {0x1a, 0x20, 0x2c}, kFaint = {0xe1, 0xe5, 0xea}, kEdge = {0x7d, 0x87, 0x94};
constexpr double kWidth = 360.0, kHeight = 200.0, kLeft = 46.0, kTop = 22.0;  // of the area [pt]
constexpr double kFont = 7.5, kKeyRow = 10.0;
constexpr double kLeastGap = 1e-6;

Color solver_color(std::size_t index) {
  static const std::vector<Color> colors = {
      {0x25, 0x63, 0xeb}, {0xea, 0x58, 0x0c}, {0x0d, 0x94, 0x88}, {0xc0, 0x26, 0xd3},
      {0xca, 0x8a, 0x04}, {0xdc, 0x26, 0x26}, {0x65, 0xa3, 0x0d}, {0x08, 0x91, 0xb2},
      {0x7c, 0x3a, 0xed}, {0x57, 0x53, 0x4e}, {0xdb, 0x27, 0x77}, {0x1e, 0x3a, 0x8a},
      {0x9a, 0x34, 0x12}, {0x11, 0x5e, 0x59}, {0x86, 0x19, 0x8f}, {0x71, 0x3f, 0x12}};
  return colors[index % colors.size()];
}

std::string short_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

template <typename Of>
CurveSheet sheet_of(const GroupSummary& group, const char* name, const char* title,
                    const char* x_title, const char* y_title, Of points_of) {
  CurveSheet sheet;
  sheet.set = group.set;
  sheet.deadline = group.deadline;
  sheet.name = name;
  sheet.title = title;
  sheet.x_title = x_title;
  sheet.y_title = y_title;
  for (const SolverSummary& s : group.solvers) {
    sheet.solvers.push_back(s.solver);
    sheet.points.push_back(points_of(s));
  }
  return sheet;
}

std::vector<CurveSheet::Point> points_of(const PerformanceProfile& profile) {
  std::vector<CurveSheet::Point> points;
  for (const auto& step : profile.steps) {
    points.push_back({step.ratio, step.share, step.share, step.share});
  }
  return points;
}

std::vector<CurveSheet::Point> points_of(const GapCurve& curve) {
  std::vector<CurveSheet::Point> points;
  for (const auto& p : curve.points) {
    if (std::isfinite(p.median)) points.push_back({p.at, p.median, p.lower, p.upper});
  }
  return points;
}

std::vector<CurveSheet::Point> points_of(const TargetCurve& curve) {
  std::vector<CurveSheet::Point> points;
  for (const auto& p : curve.points)
    points.push_back({p.at, p.share.mean, p.share.low, p.share.high});
  return points;
}

/// Where logarithms and shares lie on the paper.
struct Area {
  double x0 = 0.0, x1 = 1.0, y0 = 0.0, y1 = 1.0;  // logarithms of x; of y with log_y
  bool log_y = false;
  Drawing::Point at(double log_x, double y) const {
    const double v = log_y ? std::log10(std::max(y, kLeastGap)) : y;
    return {kLeft + kWidth * std::clamp((log_x - x0) / (x1 - x0), 0.0, 1.0),
            kTop + kHeight * (1.0 - std::clamp((v - y0) / (y1 - y0), 0.0, 1.0))};
  }
};

Area area_of(const CurveSheet& sheet) {
  Area area;
  area.log_y = sheet.log_y;
  double least = 1e300, most = 0.0, highest = 0.1;
  for (const auto& points : sheet.points) {
    for (const CurveSheet::Point& p : points) {
      least = std::min(least, p.x * sheet.x_scale);
      most = std::max(most, p.x * sheet.x_scale);
      if (std::isfinite(p.y)) highest = std::max(highest, std::min(p.y, 1e4));
    }
  }
  if (most <= 0.0) least = most = 1.0;
  area.x0 = std::log10(least);
  area.x1 = std::max(std::log10(most), area.x0 + 0.3);
  if (sheet.log_y) {
    area.y0 = std::log10(kLeastGap);
    area.y1 = std::log10(highest) + 0.2;
  }
  return area;
}

void draw_axes(Drawing& drawing, const Area& area, const CurveSheet& sheet) {
  const double bottom = kTop + kHeight;
  const auto x_line = [&](double log_x, bool label) {
    const double x = area.at(log_x, 1.0).x();
    drawing.line({{x, kTop}, {x, bottom}}, kFaint, 0.5);
    if (label) {
      drawing.text(short_text(std::pow(10.0, log_x)), {x, bottom + 10.0}, kFont, kInk,
                   Drawing::Anchor::kCenter);
    }
  };
  const bool narrow = area.x1 - area.x0 < 1.5;
  for (int e = static_cast<int>(std::floor(area.x0)); e <= std::ceil(area.x1); ++e) {
    for (const double m : {1.0, 2.0, 5.0}) {
      const double v = e + std::log10(m);
      if (v < area.x0 - 1e-9 || v > area.x1 + 1e-9 || (m > 1.0 && !narrow)) continue;
      x_line(v, true);
    }
  }
  const auto y_line = [&](double y, const std::string& label) {
    const double height = area.at(area.x0, y).y();
    drawing.line({{kLeft, height}, {kLeft + kWidth, height}}, kFaint, 0.5);
    drawing.text(label, {kLeft - 4.0, height + 2.5}, kFont, kInk, Drawing::Anchor::kRight);
  };
  if (sheet.log_y) {
    for (int e = static_cast<int>(area.y0); e <= area.y1; ++e) {
      y_line(std::pow(10.0, e), short_text(std::pow(10.0, e)));
    }
  } else {
    for (int i = 0; i <= 4; ++i) y_line(0.25 * i, std::to_string(25 * i) + " %");
  }
  drawing.line({{kLeft, kTop}, {kLeft, bottom}, {kLeft + kWidth, bottom}}, kEdge, 0.7);
  drawing.text(sheet.x_title, {kLeft + kWidth, bottom + 21.0}, kFont, kInk,
               Drawing::Anchor::kRight);
  drawing.text(sheet.title + ": " + sheet.y_title, {kLeft, kTop - 8.0}, kFont, kInk);
}

/// The curve of one back end.
std::vector<Drawing::Point> path_of(const CurveSheet& sheet, const Area& area,
                                    const std::vector<CurveSheet::Point>& points,
                                    double CurveSheet::Point::*y) {
  std::vector<Drawing::Point> path;
  for (const CurveSheet::Point& p : points) {
    if (!std::isfinite(p.*y)) continue;
    const Drawing::Point at = area.at(std::log10(p.x * sheet.x_scale), p.*y);
    if (sheet.steps && !path.empty()) path.emplace_back(at.x(), path.back().y());
    path.push_back(at);
  }
  if (sheet.steps && !path.empty()) path.emplace_back(kLeft + kWidth, path.back().y());
  return path;
}

}  // namespace

std::vector<CurveSheet> curve_sheets(const std::vector<GroupSummary>& groups) {
  // But for what of the data it shows.
  struct Kind {
    const char *name, *title, *x_title, *y_title;
    bool steps, log_y;
    double x_scale;
  };
  const char *kTime = "ms", *kCount = "evaluations";
  const char* const kProfile = "share of problems solved";
  const char* const kGap = "median gap";
  const char* const kTargets = "share of (problem, target) pairs reached";
  std::vector<CurveSheet> sheets;
  for (const GroupSummary& group : groups) {
    const auto add = [&](const Kind& kind, auto member) {
      sheets.push_back(sheet_of(group, kind.name, kind.title, kind.x_title, kind.y_title,
                                [&](const SolverSummary& s) { return points_of(s.*member); }));
      sheets.back().steps = kind.steps;
      sheets.back().log_y = kind.log_y;
      sheets.back().x_scale = kind.x_scale;
    };
    add({"profile_by_time", "Performance profile by time", "times the fastest", kProfile, true,
         false, 1.0},
        &SolverSummary::by_time);
    add({"profile_by_evaluations", "Performance profile by evaluations", "times the fewest",
         kProfile, true, false, 1.0},
        &SolverSummary::by_evaluations);
    add({"gap_over_time", "Gap against time", kTime, kGap, false, true, 1e3},
        &SolverSummary::over_time);
    add({"gap_over_evaluations", "Gap against evaluations", kCount, kGap, false, true, 1.0},
        &SolverSummary::over_evaluations);
    add({"targets_over_time", "Targets against time", kTime, kTargets, false, false, 1e3},
        &SolverSummary::targets_over_time);
    add({"targets_over_evaluations", "Targets against evaluations", kCount, kTargets, false, false,
         1.0},
        &SolverSummary::targets_over_evaluations);
  }
  return sheets;
}

std::string curves_csv(const std::vector<CurveSheet>& sheets) {
  std::string csv = "set,deadline_s,curve,solver,x,y,low,high\n";
  const auto text = [](double value) {
    return std::isfinite(value) ? exact_text(value) : std::string();
  };
  for (const CurveSheet& sheet : sheets) {
    for (std::size_t k = 0; k < sheet.solvers.size(); ++k) {
      const std::string begin =
          csv::field(sheet.set) + ',' +
          (sheet.deadline > 0.0 ? exact_text(sheet.deadline) : std::string()) + ',' + sheet.name +
          ',' + csv::field(sheet.solvers[k]) + ',';
      for (const CurveSheet::Point& p : sheet.points[k]) {
        csv += begin + text(p.x) + ',' + text(p.y) + ',' + text(p.low) + ',' + text(p.high) + '\n';
      }
    }
  }
  return csv;
}

std::string curve_svg(const CurveSheet& sheet) {
  const double key_top = kTop + kHeight + 34.0;
  const std::size_t columns = 2, rows = (sheet.solvers.size() + columns - 1) / columns;
  Drawing drawing(kLeft + kWidth + 14.0, key_top + kKeyRow * static_cast<double>(rows) + 4.0);
  const Area area = area_of(sheet);
  draw_axes(drawing, area, sheet);
  for (std::size_t k = 0; k < sheet.solvers.size(); ++k) {
    const std::vector<CurveSheet::Point>& points = sheet.points[k];
    const bool interval = std::any_of(points.begin(), points.end(),
                                      [](const auto& p) { return p.low != p.y || p.high != p.y; });
    if (interval) {
      for (double CurveSheet::Point::*bound : {&CurveSheet::Point::low, &CurveSheet::Point::high}) {
        const auto path = path_of(sheet, area, points, bound);
        if (path.size() > 1) drawing.line(path, solver_color(k), 0.3);
      }
    }
    const auto path = path_of(sheet, area, points, &CurveSheet::Point::y);
    if (path.size() > 1) drawing.line(path, solver_color(k), 1.3);
    const double left = kLeft + kWidth / columns * static_cast<double>(k % columns);
    const std::size_t row = k / columns;
    const double y = key_top + kKeyRow * static_cast<double>(row);
    drawing.line({{left, y - 2.5}, {left + 12.0, y - 2.5}}, solver_color(k), 1.8);
    drawing.text(sheet.solvers[k], {left + 16.0, y}, kFont, kInk);
  }
  return drawing.svg();
}

std::string group_file_name(const std::string& set, double deadline) {
  std::string name = set;
  if (deadline > 0.0) name += '_' + exact_text(1e3 * deadline) + "ms";
  for (char& c : name) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '_' || c == '-';
    if (!plain) c = '-';
  }
  return name;
}

}  // namespace prospect
