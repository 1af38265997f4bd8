#pragma once

#include <map>
#include <string>
#include <vector>

#include "adapters/study/cell_store.h"
#include "adapters/study/mission_numbers.h"
#include "adapters/study/study_plan.h"

namespace prospect {

/// A cell and what came of it.
struct StudyRow {
  const StudyCell* cell = nullptr;
  std::string id;  ///< of what is told: the cell's, or that of the same mission by another version
  CellRecord record;
  std::string reason;      ///< why the mission ended; why the cell failed
  MissionNumbers numbers;  ///< none of a cell that is not done
};

/// A row for each cell of the plan, in its order, which it must outlive. `other_versions`: what
/// stands for a cell that is not done (other_versions.h).
std::vector<StudyRow> read_rows(const StudyPlan& plan, const CellStore& store,
                                const std::map<std::string, std::string>& other_versions = {});

/// The tidy table: a row a run; its columns id, condition, world, seed, the keys of the grid,
/// status, reason, the numbers of MissionNumbers; and, as they differ between two runs of one
/// mission, host, version, times of planning and wall clock last. An empty field: no such number.
std::string results_csv(const StudyPlan& plan, const std::vector<StudyRow>& rows);

}  // namespace prospect
