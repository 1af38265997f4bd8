#pragma once

#include <string>
#include <vector>

#include "adapters/run/run_record.h"

namespace prospect {

/// The columns of terms of a run's table: those of its first step that has any.
std::vector<std::string> term_columns(const std::vector<StepRecord>& steps);

/// The header of steps.csv, a line: a column for each of `terms` among the others
/// (docs/reference/report.md).
std::string step_header(const std::vector<std::string>& terms);

/// A row of steps.csv, a line. Holds no wall-clock time: the same mission gives the same bytes.
std::string step_row(const StepRecord& step, const std::vector<std::string>& terms);

/// Header and rows of timing.csv, a line each: wall-clock times [ms].
std::string timing_header();
std::string timing_row(const StepRecord& step);

}  // namespace prospect
