// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/study/study_results.h"

namespace prospect {

/// The steps of all runs that are done as one HDF5 file: a group /ID a run, once, with attributes
/// condition, world, label (texts) and seed (uint64), and a dataset for each column of its
/// steps.csv: float64 (NaN for an empty field), or texts (UTF-8, variable length) of words and of
/// columns that no field of this program has (step_fields.h). Written beside it, then renamed.
/// Throws InputError where a run cannot be read or the file not be written.
void write_steps(const StudyPlan& plan, const CellStore& store, const std::vector<StudyRow>& rows,
                 const std::string& path);

}  // namespace prospect
