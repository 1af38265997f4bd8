// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adapters/missions/bench/mission_set.h"
#include "adapters/missions/config/configuration.h"
#include "adapters/missions/config/registries.h"
#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "problems/stated_programme.h"

namespace prospect {

/// One problem to measure back ends on, and from where they start.
struct BenchProblem {
  std::string name;  ///< unique within its set
  std::shared_ptr<const Problem> problem;
  WarmStart start;  ///< x; of missions also the planner's seeds
  /// Cost of the best feasible point known before the run; none if nobody has looked.
  std::optional<double> best_known;
  /// Variables without a stated bound below or above. The problem has bounds there, as every one
  /// has, which are moved outwards where a solve comes to them: see run_bench().
  std::vector<int> no_lower, no_upper;
  /// The problem with these bounds `far` beyond the start.
  std::function<std::shared_ptr<const Problem>(double far)> with_bounds;
  /// Makes the same as expressions; empty where nothing states it so, as a problem with a map.
  std::function<StatedProgramme()> stated;
};

/// A problem that starts at x.
BenchProblem started(std::string name, Problem problem, const Eigen::VectorXd& x,
                     std::optional<double> best_known);

/// 16 hexadecimal digits of the bounds, of where back ends start, and of cost and constraints there
/// and in the middle of the bounds, each by its bits: by this, results of two runs are of the same
/// problem. A problem that throws there has one, too. Not against forgery.
std::string problem_fingerprint(const BenchProblem& problem);

/// Problems that are reported together.
struct ProblemSet {
  std::string name;
  std::string best_known_source;  ///< where best_known is from, in words; empty: from nowhere
  /// What counts as the same cost where the best known is near 0: SolvedRule. 0: nothing is known
  /// of the unit of its costs.
  double absolute_tolerance = 1e-3;
  std::vector<BenchProblem> problems;
  std::string folder;              ///< that the problems are from, to keep best costs in; or ""
  std::vector<std::string> files;  ///< that the problems are from; none of other sets
};

/// Of names and fingerprints of the problems, and of the bytes of the files they are from: a set
/// that moves stays the same. The best known costs do not count. Throws InputError for a file that
/// cannot be read.
std::uint64_t problem_set_hash(const ProblemSet& set);

/// zoo, s30, quadrotors, missions.
std::vector<std::string> builtin_set_names();
/// One line on a built-in set; "" for an unknown name.
std::string builtin_set_summary(const std::string& name);

/// A set by name or path: a built-in one; one of `registries`; a problem file (.h5, .nl); a folder
/// of problem files, with the best costs known in best_known.json beside them, if it is there; a
/// file of problems stated as expressions (.json, expression_file.h). `quick`: of a built-in set a
/// share that is solved in seconds. `configuration` of the missions, `registries`: what it and
/// problem files may name. `watch`: of missions, which are driven first; a set that was cancelled
/// lacks problems. Throws InputError in one line, also for a folder of which one file is damaged.
ProblemSet make_problem_set(const std::string& text, const Configuration& configuration,
                            const Registries& registries, bool quick,
                            const CaptureWatch& watch = {});

/// Keeps the best costs of a set that is from a folder: best_known.json, whole or not at all.
/// Throws std::runtime_error if writing fails.
void keep_best_known(const ProblemSet& set);

}  // namespace prospect
