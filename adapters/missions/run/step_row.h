// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/run/run_record.h"

namespace prospect {

/// The columns of a run's table that depend on its problem.
struct StepColumns {
  std::vector<std::string> terms;
  std::vector<std::string> weights;  ///< names of the costs whose weights are known
  bool corrected = false;            ///< with those of corrections of the map
  bool empty() const { return terms.empty(); }
};
/// Those of the first step that has any terms.
StepColumns step_columns(const std::vector<StepRecord>& steps);

/// The header of steps.csv, a line (docs/reference/report.md).
std::string step_header(const StepColumns& columns);

/// A row of steps.csv, a line. Holds no wall-clock time: the same mission gives the same bytes.
std::string step_row(const StepRecord& step, const StepColumns& columns);

/// Header and rows of timing.csv, a line each: wall-clock times [ms].
std::string timing_header();
std::string timing_row(const StepRecord& step);

}  // namespace prospect
