// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "adapters/missions/bench/bench_table.h"

namespace prospect {

/// The rows of a set under one deadline as a log of OMPL's benchmarks (its version 1.5), which
/// `ompl_benchmark_statistics LOG... -d FILE.db` makes a database of, and Planner Arena shows.
///
/// The set is the experiment, a back end a planner, and a problem with a seed a run, in the order
/// of the table, so that run i of all planners is the same problem. Runs have: problem (its index),
/// solver seed, solved, status, time [s], time to target [s], cost, gap, optimality, evaluations,
/// evaluations to target, gradients. What there is not is an empty field. The progress of a run has
/// time [s], best cost and gap at every improvement that is feasible.
std::string planner_arena_log(const BenchTable& table, int set, double deadline);

}  // namespace prospect
