#pragma once

#include <string>
#include <vector>

#include "benchmarks/experiments/experiment_row.h"

namespace prospect {

/// Markdown: how many missions of each condition were run, how they ended and how many failed; the
/// ratios of the chief numbers of all conditions, if there are several; then each condition against
/// its reference (conditions.h), paired by sensors, world and seed, over all worlds and over each
/// group of them (built in; floor plans; from files) if there are several, and what the ratios of
/// the chief numbers are in each world. A pair lacks a number if either mission does: pairs are
/// counted by number, and those that only one side has are told. Medians are over the pairs; the
/// difference is the mean of condition - reference and the ratio that of the means, with bootstrap
/// intervals (paired_bootstrap.h); p is that of the signed-rank test (signed_rank_test.h), not
/// corrected for the number of numbers.
std::string experiment_report(const std::vector<ExperimentRow>& rows);

}  // namespace prospect
