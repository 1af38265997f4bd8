// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/config/registries.h"
#include "adapters/missions/study/cell_store.h"
#include "adapters/missions/study/study_plan.h"

namespace prospect {

/// What gathering wrote, and how many rows of results.csv there are of each kind.
struct StudyFiles {
  std::vector<std::string> files;
  std::size_t done = 0, failed = 0, missing = 0;
  std::size_t of_other_versions = 0;  ///< of `done`
};

struct StudyGathering {
  bool steps = false;        ///< steps.h5, too: every column of every run's steps.csv
  bool any_version = false;  ///< other versions' missions stand for those that are not done
  std::vector<std::string> formats = {"svg", "png"};  ///< of figures, of drawing_formats()
};

/// Writes what the cells of a study show into its folder: results.csv, study.html,
/// figures/NAME in each format. Each file appears whole or not at all. Throws InputError, also for
/// steps and other versions of benches, which have none.
StudyFiles write_study(const StudyPlan& plan, const CellStore& store, const Registries& registries,
                       const StudyGathering& gathering);

}  // namespace prospect
