// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/study/study_figures.h"

namespace prospect {

/// The page of a study: what was run, each comparison as a table (medians, mean difference and
/// ratio with bootstrap intervals, p of Wilcoxon's test), the figures, cells that failed. One file
/// that works offline.
std::string study_page(const StudyPlan& plan, const std::vector<StudyRow>& rows,
                       const std::vector<StudyComparison>& comparisons,
                       const std::vector<StudyFigure>& figures);

}  // namespace prospect
