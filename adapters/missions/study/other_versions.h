// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "adapters/missions/config/registries.h"
#include "adapters/missions/study/cell_store.h"
#include "adapters/missions/study/study_plan.h"

namespace prospect {

/// For cells of the plan the same mission as another version of the program, or of its plug-ins,
/// has run it: name of the cell -> name of the newest stored cell that is done. The same are world
/// (by what it holds), seed, and the configuration that the stored one comes to when it is read
/// today: a key that is new has its default. A stored cell whose configuration this program does
/// not take stands for none.
std::map<std::string, std::string> other_versions(const StudyPlan& plan, const CellStore& store,
                                                  const Registries& registries);

}  // namespace prospect
