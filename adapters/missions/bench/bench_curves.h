// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/bench/bench_summary.h"

namespace prospect {

/// A curve of every back end in one group, as data and for print.
struct CurveSheet {
  struct Point {
    double x = 0.0, y = 0.0, low = 0.0, high = 0.0;  ///< low = high = y of what has no interval
  };
  std::string set;
  double deadline = 0.0;  ///< [s]; 0: none
  std::string name;       ///< "profile_by_time", ...
  std::string title, x_title, y_title;
  bool steps = false;    ///< y stays between two points
  bool log_y = false;    ///< else y is a share
  double x_scale = 1.0;  ///< x is shown times this: 1000 for ms
  std::vector<std::string> solvers;
  std::vector<std::vector<Point>> points;  ///< by solver
};

/// Performance profiles, gaps and reached targets, each by time and by evaluations, of every group.
/// Gaps without a number (infinite) have no point.
std::vector<CurveSheet> curve_sheets(const std::vector<GroupSummary>& groups);

/// All points, a row each: set, deadline_s, curve, solver, x, y, low, high.
std::string curves_csv(const std::vector<CurveSheet>& sheets);

/// A figure of a sheet as SVG, with a key; x is logarithmic.
std::string curve_svg(const CurveSheet& sheet);

/// "zoo", "zoo_100ms": a set under a deadline as part of a file name, letters, digits and "_-"
/// only.
std::string group_file_name(const std::string& set, double deadline);

}  // namespace prospect
