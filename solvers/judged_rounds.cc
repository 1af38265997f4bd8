// SPDX-License-Identifier: Apache-2.0
#include "solvers/judged_rounds.h"

#include <algorithm>
#include <utility>

namespace prospect {
namespace {

using Verdict = Judgement::Verdict;

// With fewer evaluations a round comes to nothing.
constexpr int kLeastRound = 10;

}  // namespace

void JudgedRounds::count(const Counters& counters) {
  counters_.cost_evaluations += counters.cost_evaluations;
  counters_.gradient_evaluations += counters.gradient_evaluations;
  counters_.iterations += counters.iterations;
}

CommonOptions JudgedRounds::options() const {
  CommonOptions options = options_;
  options.max_evaluations -= counters_.cost_evaluations;
  return options;
}

void JudgedRounds::add(Result& result) {
  for (Improvement& i : result.trace) {
    i.seconds += seconds_;
    i.evaluations += counters_.cost_evaluations;
  }
  count(result.counters);
  seconds_ += result.seconds;
  result.counters = counters_;
  if (!result.trace.empty()) {
    // What was better in other units was not.
    const bool feasible = result.quality != Quality::kInfeasible;
    const Improvement& first = result.trace.front();
    const double tolerance = options_.feasibility_tolerance;
    std::erase_if(trace_, [&](const Improvement& i) {
      const bool was = i.violation <= tolerance;
      return feasible ? was && (i.cost <= first.cost || first.violation > tolerance)
                      : was || i.violation <= first.violation;
    });
    trace_.insert(trace_.end(), result.trace.begin(), result.trace.end());
    result.trace = trace_;
  }
}

bool JudgedRounds::correct(const Judgement& judgement, Result& result) {
  const bool claimed = result.quality == Quality::kFeasibleOptimum;
  switch (judgement.verdict) {
    case Verdict::kOptimum:
      return false;
    case Verdict::kUnproven:
    case Verdict::kUnknown:
      if (claimed) {
        result.quality = Quality::kFeasible;
        result.detail += ", not proven to be an optimum: " + judgement.why;
      }
      return false;
    case Verdict::kInfeasible:
      // Of a claim: in the units of the round it was feasible.
      result.quality = Quality::kInfeasible;
      result.stop = StopReason::kInfeasible;
      result.detail += ", " + judgement.why;
      return false;
    case Verdict::kLessens:
    case Verdict::kDescent:
      break;
  }
  if (claimed) result.quality = Quality::kFeasible;
  result.stop = StopReason::kNumericalTrouble;
  result.detail += ", but " + judgement.why;
  start_ = judgement.better;
  return true;
}

Judgement JudgedRounds::judgement_of(const ProblemScale& scale, const Result& result) const {
  JudgeTolerances tolerances{options_.tolerance, options_.feasibility_tolerance};
  if (!scale.plain()) {
    tolerances.size = std::max(scale.cost, std::abs(result.cost - scale.offset));
  }
  return prospect::judge(problem_, result.x, tolerances, evaluate_);
}

bool JudgedRounds::judge(const ProblemScale& scale, Result& result) {
  ++rounds_;
  const bool ended =
      result.stop == StopReason::kConverged || result.stop == StopReason::kNumericalTrouble;
  const bool free = (problem_.lower().array() < problem_.upper().array()).any();
  bool more = false;
  // What has used up its evaluations may have come to where no step helps.
  const bool stuck =
      result.stop == StopReason::kIterationLimit && free && result.quality == Quality::kInfeasible;
  if (stuck) {
    const Judgement judgement = judgement_of(scale, result);
    if (judgement.verdict == Verdict::kInfeasible) correct(judgement, result);
  }
  if (ended && result.quality == Quality::kInfeasible && !free) {
    result.stop = StopReason::kInfeasible;
  } else if (ended && free && result.quality != Quality::kNone) {
    start_ = result.x;
    if (result.quality != Quality::kFeasible) {
      more = correct(judgement_of(scale, result), result);
      if (more) take(scale, result);
    }
    if (more || !scale.plain()) {
      scale_ = scale_near(problem_, start_, evaluate_);
      more = more || !scale_.like(scale);
    }
  }
  add(result);
  return more && rounds_ < kRounds && options().max_evaluations >= kLeastRound;
}

void JudgedRounds::take(const ProblemScale& scale, Result& result) {
  Evaluation e;
  if (evaluate_(start_, Evaluate::kValue, e) != EvaluationOutcome::kEvaluated) return;
  Eigen::VectorXd constraints = e.constraints.col(0);
  if (scale.constraints.size() > 0) constraints.array() /= scale.constraints.array();
  result.x = result.next.x = start_;
  result.violation = violation(constraints);
  if (result.quality == Quality::kInfeasible &&
      result.violation <= options_.feasibility_tolerance) {
    result.quality = Quality::kFeasible;
  }
  result.explanation = problem_.explain(start_);
  result.cost = result.explanation.cost;
  if (!result.trace.empty()) {
    result.trace.push_back(
        {result.seconds, result.counters.cost_evaluations, result.cost, result.violation});
  }
}

}  // namespace prospect
