// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "adapters/missions/bench/bench_table.h"

namespace prospect {

/// The benches of several folders as one: parts of a large one that were measured on several
/// machines or on several days, split by sets, problems, back ends, deadlines or seeds. Judged,
/// with the best known cost over all. Each row keeps what measured it.
///
/// Throws InputError in one line if a folder holds no bench; if two benches differ in repeats or in
/// evaluations at most; if a problem of the same name is another one there; if two hold the same
/// row; or if a row is missing: every back end must have been asked for every problem under every
/// deadline with every seed.
BenchTable merge_benches(const std::vector<std::string>& folders);

/// Adds the sets and problems of `from`, the bench of a folder, that `to` lacks; of the others the
/// lower best known cost stands. Throws InputError in one line, which names the folder, if a
/// problem of the same name is another one there, or the tolerance of a set.
void add_problems(BenchTable& to, const BenchTable& from, const std::string& folder);

}  // namespace prospect
