// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "adapters/missions/study/study_results.h"
#include "adapters/views/report/drawing.h"

namespace prospect {

/// The chief numbers against the values of the axis (StudyPlan::study.grid): means of what was
/// measured, with 95 % bootstrap intervals where there are two runs or more; a line for each choice
/// of all else. No line leads over a value without a number. Numbers stand to scale, logarithmic
/// over more than a decade; words side by side. A value at which none was measured is marked so.
Drawing axis_figure(const StudyPlan& plan, const std::vector<StudyRow>& rows, std::size_t axis);

}  // namespace prospect
