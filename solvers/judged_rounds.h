// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/problem/problem.h"
#include "engine/problem/solver.h"
#include "solvers/judge.h"
#include "solvers/problem_scale.h"

namespace prospect {

/// The rounds of one solve: each ends with a result that is judged, and may be followed by another
/// one from a better point or in better units. Thread-safety: none; an object a solve.
class JudgedRounds {
 public:
  static constexpr int kRounds = 5;

  /// `evaluate` of the problem as it is stated. Both must outlive this.
  JudgedRounds(const Problem& problem, const CommonOptions& options, const EvaluatePoint& evaluate)
      : problem_(problem), options_(options), evaluate_(evaluate) {}

  /// Evaluations made beside the rounds.
  void count(const Counters& counters);

  /// Judges the result of a round in units of `scale`: corrects what it claims, and adds what the
  /// rounds before it took. True: another round is to follow, with what the methods below say.
  bool judge(const ProblemScale& scale, Result& result);

  const Eigen::VectorXd& next_start() const { return start_; }
  const ProblemScale& next_scale() const { return scale_; }
  /// Those of the solve with the evaluations that are left.
  CommonOptions options() const;

 private:
  Judgement judgement_of(const ProblemScale& scale, const Result& result) const;
  /// Corrects the result by the verdict on it. True: start_ is where to go on.
  bool correct(const Judgement& judgement, Result& result);
  /// Makes start_ the result.
  void take(const ProblemScale& scale, Result& result);
  /// Adds what went before.
  void add(Result& result);

  const Problem& problem_;
  CommonOptions options_;
  const EvaluatePoint& evaluate_;
  int rounds_ = 0;
  Counters counters_;
  double seconds_ = 0.0;
  std::vector<Improvement> trace_;
  Eigen::VectorXd start_;
  ProblemScale scale_;
};

}  // namespace prospect
