#pragma once

#include <string>
#include <vector>

#include "benchmarks/experiments/experiment_row.h"

namespace prospect {

/// Plots of a table, drawn by gnuplot into `folder`, which is made:
///   ratios.svg                          the ratio of means of each number, condition over
///                                       reference, with its 95 % interval; all worlds
///   pairs_SENSORS_CONDITION.svg         each pair of missions as a point: reference across,
///                                       condition up, worlds by colour; RMS error, losses of
///                                       localization and time with few features
/// and beside each its script with the data, NAME.gp. What is compared and how: see
/// condition_comparison.h. Returns the paths of the pictures; none if there is no pair.
/// Throws InputError if the folder cannot be written or gnuplot does not run.
std::vector<std::string> write_experiment_plots(const std::vector<ExperimentRow>& rows,
                                                const std::string& folder);

}  // namespace prospect
