#pragma once

#include <string>
#include <vector>

#include "adapters/run/run_record.h"

namespace prospect {

/// The header of steps.csv, a line: a column for each of `terms` among the others
/// (docs/reference/report.md).
std::string step_header(const std::vector<std::string>& terms);

/// A row of steps.csv, a line. Holds no wall-clock time: the same mission gives the same bytes.
std::string step_row(const StepRecord& step, const std::vector<std::string>& terms);

}  // namespace prospect
