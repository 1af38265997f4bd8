// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "adapters/missions/study/cell_store.h"
#include "adapters/missions/study/study_number.h"
#include "adapters/missions/study/study_plan.h"

namespace prospect {

/// The numbers of missions, or of solves, in the order of tables.
const std::vector<StudyNumber>& study_numbers(Study::Kind kind);

/// A mission, or the solve of one problem of a bench, and what came of it.
struct StudyRow {
  const StudyCell* cell = nullptr;
  std::string problem;  ///< of a bench
  std::string id;  ///< of what is told: the cell's, or that of the same mission by another version
  CellRecord record;
  std::string reason;           ///< why the mission or the solve ended; why the cell failed
  std::vector<double> numbers;  ///< study_numbers(); empty of a cell that is not done
};

/// The number of that place; NaN if the row has none.
double value_of(const StudyRow& row, std::size_t number);

/// A row for each cell of the plan, in its order, which it must outlive; of benches a row for each
/// problem of each cell, judged by the best cost that any of the cells knows. `other_versions`:
/// what stands for a mission that is not done (other_versions.h). Throws InputError for folders
/// that cannot be read.
std::vector<StudyRow> read_rows(const StudyPlan& plan, const CellStore& store,
                                const std::map<std::string, std::string>& other_versions = {});

/// The tidy table: a row a run; its columns id, condition, world (of benches: set, problem), seed,
/// the keys of the grid, status, reason, the study_numbers(); and, as they differ between two runs
/// of one cell, host, version and times by the wall clock last. An empty field: no such number.
std::string results_csv(const StudyPlan& plan, const std::vector<StudyRow>& rows);

}  // namespace prospect
