// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "adapters/missions/bench/bench_table.h"
#include "adapters/missions/study/study_number.h"

namespace prospect {

/// What a solve came to, against the best cost known: solved, gap, cost, evaluations and times, as
/// in docs/reference/bench.md. In the order of tables.
const std::vector<StudyNumber>& solve_number_list();

/// In that order, of a row that is judged. Infinite or NaN: no such number.
std::vector<double> values_of(const BenchRow& row);

}  // namespace prospect
