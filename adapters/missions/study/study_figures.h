// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/config/registries.h"
#include "adapters/missions/study/study_comparison.h"
#include "adapters/views/report/drawing.h"

namespace prospect {

/// A figure of a study, for print and for the page.
struct StudyFigure {
  std::string name;     ///< of its files: "ratios"
  std::string caption;  ///< one or two sentences
  Drawing drawing;
};

/// What a mission had at each planning step.
struct MissionCurve {
  std::vector<double> time, path, coverage, error;  ///< [s], [m], share, [m]
};
/// Of a run folder. Throws InputError.
MissionCurve read_curve(const std::string& run_folder);

/// Median, first and third quartile of the values of `curves` at x: of each curve that of its last
/// step up to x. A mission that has ended keeps it where it `stays`; else it counts no more, and
/// with fewer than half of the missions left there are none (NaN).
struct Quartiles {
  double low = 0.0, median = 0.0, high = 0.0;
};
Quartiles quartiles_at(const std::vector<const MissionCurve*>& curves,
                       std::vector<double> MissionCurve::*x, std::vector<double> MissionCurve::*y,
                       double at, bool stays);

/// All that the rows give: the chief numbers against each key of the grid (axis_figure.h), ratios
/// of means with intervals (if there are pairs), box plots of the chief numbers; of missions also
/// coverage and error against time and distance, and the path coloured by visible features of the
/// first seed in each world, at most `most_paths` of them. Throws InputError for run folders that
/// cannot be read.
std::vector<StudyFigure> study_figures(const StudyPlan& plan, const CellStore& store,
                                       const std::vector<StudyRow>& rows,
                                       const std::vector<StudyComparison>& comparisons,
                                       const Registries& registries, std::size_t most_paths = 12);

}  // namespace prospect
