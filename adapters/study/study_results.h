#pragma once

#include <string>
#include <vector>

#include "adapters/study/cell_store.h"
#include "adapters/study/mission_numbers.h"
#include "adapters/study/study_plan.h"

namespace prospect {

/// A cell and what came of it.
struct StudyRow {
  const StudyCell* cell = nullptr;
  CellRecord record;
  std::string reason;      ///< why the mission ended; why the cell failed
  MissionNumbers numbers;  ///< none of a cell that is not done
};

/// A row for each cell of the plan, in its order, which it must outlive.
std::vector<StudyRow> read_rows(const StudyPlan& plan, const CellStore& store);

/// The tidy table: a row a run; its columns id, condition, world, seed, the keys of the grid,
/// status, reason, the numbers of MissionNumbers; and, as they differ between two runs of one
/// mission, host, version, times of planning and wall clock last. An empty field: no such number.
std::string results_csv(const StudyPlan& plan, const std::vector<StudyRow>& rows);

}  // namespace prospect
