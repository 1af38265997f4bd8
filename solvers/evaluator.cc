// SPDX-License-Identifier: Apache-2.0
#include "solvers/evaluator.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <random>

namespace prospect {
namespace {

// After a chunk in which most scores had to be followed by the exact value.
constexpr int kExactChunks = 8;

// Requests for what is remembered, and iterations, that may follow each other without an
// evaluation. Methods ask for a point a few times over; one that goes round in circles never ends.
constexpr int kMostIdle = 1000;

}  // namespace

Evaluator::Evaluator(const Problem& problem, const CommonOptions& options,
                     const StopCondition& stop)
    : Evaluator(problem, options, stop, nullptr, {}) {}

Evaluator::Evaluator(Evaluator& outer, const CommonOptions& options)
    : Evaluator(outer.problem_, options, outer.stop_, &outer, {}) {}

Evaluator::Evaluator(const Problem& problem, const CommonOptions& options,
                     const StopCondition& stop, Evaluator* outer, std::vector<Ahead> ahead)
    : problem_(problem),
      options_(options),
      stop_(stop),
      outer_(outer),
      ahead_(std::move(ahead)),
      workers_(outer ? nullptr : std::make_unique<WorkerThreads>(options.threads)) {
  if (!outer_ && ahead_.empty()) {
    workspace_ = problem.make_workspace();
    for (int t = 0; t < options.threads; ++t) {
      ahead_.push_back(
          {problem.make_workspace(), problem.lower().replicate(1, kChunk), 0, {}, nullptr});
    }
  }
  const Eigen::VectorXd& lower = problem.lower();
  const Eigen::VectorXd& upper = problem.upper();
  for (int i = 0; i < problem.num_variables(); ++i) {
    if (lower[i] < upper[i]) free_.push_back(i);
  }
  lower_ = reduce(lower);
  upper_ = reduce(upper);
  middle_ = lower_ + 0.5 * (upper_ - lower_);
  if (!free_.empty()) radius_ = 0.5 * (upper_ - lower_).norm();
  const int n = num_variables();
  const int m = num_constraints();
  z_ = lower;  // the fixed entries keep this value
  last_x_ = middle_;
  incumbent_ = middle_;
  constraints_.setZero(m);
  incumbent_constraints_.setZero(m);
  gradient_.setZero(n);
  jacobian_.setZero(m, n);
}

void Evaluator::run_beside(int count, const CommonOptions& options,
                           const std::function<void(int, Evaluator&)>& solve) {
  CommonOptions own = options;
  own.threads = 1;
  own.trace = true;  // adopt() reads it
  std::vector<std::unique_ptr<Evaluator>> inner(static_cast<std::size_t>(count));
  std::vector<Ahead>& idle = ahead();
  std::mutex mutex;                // of `idle`
  std::atomic<int> threw = count;  // the first that did
  const StopCondition asked = one_at_a_time(stop_);
  const auto run = [&](int k) {
    const StopCondition stop(
        // What comes after one that threw is thrown away.
        [&, k] { return threw < k ? StopRequest::kCancelled : asked(); }, stop_.latest(),
        stop_.clock());
    std::vector<Ahead> taken;
    std::unique_lock lock(mutex);
    taken.push_back(std::move(idle.back()));
    idle.pop_back();
    lock.unlock();
    auto& evaluator = inner[static_cast<std::size_t>(k)];
    evaluator.reset(new Evaluator(problem_, own, stop, nullptr, std::move(taken)));
    evaluator->begin_ = begin_;
    solve(k, *evaluator);
    lock.lock();
    if (evaluator->threw_) threw = std::min(threw.load(), k);
    idle.push_back(std::move(evaluator->ahead_.front()));
  };
  workers().run(count, std::cref(run));
  for (const auto& evaluator : inner) {
    adopt(*evaluator);
    if (threw_) break;
  }
}

void Evaluator::adopt(const Evaluator& inner) {
  if (outer_) outer_->adopt(inner);
  if (inner.has_incumbent_) {
    worst_cost_ = has_incumbent_ ? std::max(worst_cost_, inner.worst_cost_) : inner.worst_cost_;
  }
  bool improved = false;
  for (const Improvement& i : inner.trace_) {
    if (!improves(i.cost, i.violation)) continue;
    improved = has_incumbent_ = true;
    incumbent_cost_ = i.cost;
    incumbent_violation_ = i.violation;
    if (!options_.trace) continue;
    // Found at the same time as what was taken over before it, it is not known before that.
    const double seconds = trace_.empty() ? i.seconds : std::max(i.seconds, trace_.back().seconds);
    trace_.push_back({seconds, counters_.cost_evaluations + i.evaluations, i.cost, i.violation});
  }
  if (improved) {
    incumbent_ = inner.incumbent_;
    incumbent_constraints_ = inner.incumbent_constraints_;
  }
  counters_.cost_evaluations += inner.counters_.cost_evaluations;
  counters_.gradient_evaluations += inner.counters_.gradient_evaluations;
  counters_.iterations += inner.counters_.iterations;
  if (inner.counters_.cost_evaluations > 0) idle_ = 0;
  last_known_ = false;
  if (inner.threw_) {
    threw_ = true;
    fail(inner.stop_detail_);
  } else if (!stopped_ && inner.stopped_ &&
             (inner.stop_reason_ == StopReason::kDeadline ||
              inner.stop_reason_ == StopReason::kCancelled)) {
    stopped_ = true;
    stop_reason_ = inner.stop_reason_;
    stop_detail_ = inner.stop_detail_;
  }
}

Eigen::VectorXd Evaluator::reduce(const Eigen::Ref<const Eigen::VectorXd>& z) const {
  Eigen::VectorXd x(free_.size());
  for (int i = 0; i < num_variables(); ++i) x[i] = z[free_[static_cast<std::size_t>(i)]];
  return x;
}

Eigen::VectorXd Evaluator::expand(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  Eigen::VectorXd z = problem_.lower();
  for (int i = 0; i < num_variables(); ++i) z[free_[static_cast<std::size_t>(i)]] = x[i];
  return z;
}

void Evaluator::clamp_to_z(const Eigen::Ref<const Eigen::VectorXd>& x) {
  for (int i = 0; i < num_variables(); ++i) {
    // Not std::clamp: a back end that asks for NaN must not get NaN through.
    const double value = x[i] > lower_[i] ? std::min(x[i], upper_[i]) : lower_[i];
    last_x_[i] = std::isfinite(x[i]) ? value : middle_[i];
    z_(free_[static_cast<std::size_t>(i)], 0) = last_x_[i];
  }
}

bool Evaluator::differs_from_last(const Eigen::Ref<const Eigen::VectorXd>& x) const {
  return !last_known_ || (x.array() != last_x_.array()).any();
}

void Evaluator::store_exception() {
  try {
    throw;
  } catch (const std::exception& e) {
    fail(std::string("the problem threw: ") + e.what());
  } catch (...) {
    fail("the problem threw something that is not a std::exception");
  }
  threw_ = true;
  if (outer_) {
    outer_->threw_ = true;
    outer_->fail(stop_detail_);
  }
}

void Evaluator::note_idle() {
  if (++idle_ <= kMostIdle || stopped_) return;
  stopped_ = true;
  stop_reason_ = StopReason::kNumericalTrouble;
  stop_detail_ = "the method goes round in circles";
}

void Evaluator::count_evaluations(int count, bool gradient) {
  idle_ = 0;
  counters_.cost_evaluations += count;
  if (gradient) counters_.gradient_evaluations += count;
  if (outer_) outer_->count_evaluations(count, gradient);
}

void Evaluator::fail(std::string message) {
  if (stopped_ && stop_reason_ == StopReason::kError) return;
  stopped_ = true;
  stop_reason_ = StopReason::kError;
  stop_detail_ = std::move(message);
}

bool Evaluator::should_stop(bool budget) {
  if (stopped_) return true;
  if (outer_ && outer_->should_stop(budget)) {
    stopped_ = true;
    stop_reason_ = outer_->stop_reason_;
    stop_detail_ = outer_->stop_detail_;
    return true;
  }
  StopRequest request = StopRequest::kNone;
  try {
    if (!outer_) request = stop_();
  } catch (...) {
    store_exception();
    return true;
  }
  if (request == StopRequest::kDeadline) {
    stopped_ = true;
    stop_reason_ = StopReason::kDeadline;
    stop_detail_ = "the deadline struck";
  } else if (request == StopRequest::kCancelled) {
    stopped_ = true;
    stop_reason_ = StopReason::kCancelled;
    stop_detail_ = "cancelled by the caller";
  } else if (budget && evaluations_left() <= 0) {
    stopped_ = true;
    stop_reason_ = StopReason::kIterationLimit;
    stop_detail_ = "max_evaluations = " + std::to_string(options_.max_evaluations) + " used up";
  }
  return stopped_;
}

bool Evaluator::improves(double cost, double violation) const {
  if (!has_incumbent_) return true;
  const bool feasible = violation <= options_.feasibility_tolerance;
  if (feasible != incumbent_feasible()) return feasible;
  if (!feasible && violation != incumbent_violation_) return violation < incumbent_violation_;
  return cost < incumbent_cost_;
}

bool Evaluator::improves_any(double cost, double violation) const {
  return improves(cost, violation) || (outer_ && outer_->improves_any(cost, violation));
}

void Evaluator::note_cost(double cost) {
  if (outer_) outer_->note_cost(cost);
  worst_cost_ = has_incumbent_ ? std::max(worst_cost_, cost) : cost;
}

void Evaluator::consider(const Eigen::Ref<const Eigen::VectorXd>& x, double cost, double violation,
                         const Eigen::Ref<const Eigen::VectorXd>& constraints) {
  if (outer_) outer_->consider(x, cost, violation, constraints);
  worst_cost_ = has_incumbent_ ? std::max(worst_cost_, cost) : cost;
  if (!improves(cost, violation)) return;
  has_incumbent_ = true;
  incumbent_ = x;
  incumbent_cost_ = cost;
  incumbent_violation_ = violation;
  incumbent_constraints_ = constraints;
  if (options_.trace) {
    trace_.push_back(
        {seconds_by(stop_.clock()) - begin_, counters_.cost_evaluations, cost, violation});
  }
}

bool Evaluator::take(Evaluate what) {
  const bool gradient = what >= Evaluate::kGradient;
  if (!is_usable(evaluation_, what)) return false;
  cost_ = evaluation_.cost[0];
  constraints_ = evaluation_.constraints.col(0);
  if (gradient) {
    for (int i = 0; i < num_variables(); ++i) {
      const int j = free_[static_cast<std::size_t>(i)];
      gradient_[i] = evaluation_.gradient[j];
      jacobian_.col(i) = evaluation_.jacobian.col(j);
    }
  }
  if (what == Evaluate::kResiduals) {
    residual_jacobian_.resize(evaluation_.residuals.size(), num_variables());
    for (int i = 0; i < num_variables(); ++i) {
      residual_jacobian_.col(i) =
          evaluation_.residual_jacobian.col(free_[static_cast<std::size_t>(i)]);
    }
  }
  return true;
}

EvaluationOutcome Evaluator::evaluate(const Eigen::Ref<const Eigen::VectorXd>& x, Evaluate what) {
  if (stopped_) return EvaluationOutcome::kStopped;
  const bool included = what <= last_what_ && (what != Evaluate::kStages || last_what_ == what ||
                                               last_outcome_ == EvaluationOutcome::kRejected);
  if (!differs_from_last(x) && included) {
    note_idle();
    return stopped_ ? EvaluationOutcome::kStopped : last_outcome_;
  }
  if (should_stop()) return EvaluationOutcome::kStopped;

  clamp_to_z(x);
  last_known_ = false;
  try {
    problem_.evaluate(z_, what, workspace(), evaluation_);
  } catch (...) {
    store_exception();
    return EvaluationOutcome::kStopped;
  }
  count_evaluations(1, what >= Evaluate::kGradient);
  const bool valid = take(what);
  if (valid) {
    consider(last_x_, cost_, violation(constraints_), constraints_);
  } else {
    cost_ = rejected_cost(last_x_, &gradient_);
    constraints_ = incumbent_constraints_;
    jacobian_.setZero();
  }
  last_known_ = true;
  last_what_ = valid ? what : Evaluate::kResiduals;  // a rejected point has all there is
  last_outcome_ = valid ? EvaluationOutcome::kEvaluated : EvaluationOutcome::kRejected;
  return last_outcome_;
}

EvaluationOutcome Evaluator::evaluate_states(const Eigen::Ref<const Eigen::VectorXd>& x,
                                             const Eigen::Ref<const Eigen::MatrixXd>& states) {
  if (should_stop()) return EvaluationOutcome::kStopped;
  clamp_to_z(x);
  last_known_ = false;
  try {
    problem_.evaluate_states(z_.col(0), states, workspace(), evaluation_);
  } catch (...) {
    store_exception();
    return EvaluationOutcome::kStopped;
  }
  count_evaluations(1, true);
  return take(Evaluate::kStages) ? EvaluationOutcome::kEvaluated : EvaluationOutcome::kRejected;
}

double Evaluator::rejected_cost(const Eigen::Ref<const Eigen::VectorXd>& x,
                                Eigen::VectorXd* gradient) const {
  const double worst = has_incumbent_ ? worst_cost_ : 0.0;
  const double scale = 1.0 + (has_incumbent_ ? worst - incumbent_cost_ : 0.0);
  const double per_square = scale / (radius_ * radius_);
  if (gradient) *gradient = 2.0 * per_square * (x - incumbent_);
  return worst + scale + per_square * (x - incumbent_).squaredNorm();
}

int Evaluator::evaluate_ahead(const Eigen::Ref<const Eigen::MatrixXd>& X, int first,
                              Evaluate what) {
  std::vector<Ahead>& chunks = ahead();
  const int columns = std::min(static_cast<int>(X.cols()), first + evaluations_left());
  int count = 0, end = first;
  for (; end < columns && count < static_cast<int>(chunks.size()); ++count) {
    Ahead& chunk = chunks[static_cast<std::size_t>(count)];
    chunk.size = std::min(kChunk, columns - end);
    for (int b = 0; b < chunk.size; ++b) {
      clamp_to_z(X.col(end + b));
      chunk.z.col(b) = z_.col(0);
    }
    end += chunk.size;
  }
  const auto evaluate = [&](int c) {
    Ahead& chunk = chunks[static_cast<std::size_t>(c)];
    chunk.error = nullptr;
    try {
      problem_.evaluate(chunk.z.leftCols(chunk.size), what, chunk.workspace, chunk.evaluation);
    } catch (...) {
      chunk.error = std::current_exception();
    }
  };
  workers().run(count, std::cref(evaluate));
  return end;
}

int Evaluator::evaluate_batch(const Eigen::Ref<const Eigen::MatrixXd>& X, Eigen::ArrayXd& cost,
                              Eigen::ArrayXd& violations, Evaluate what) {
  const int columns = static_cast<int>(X.cols());
  cost.setConstant(columns, Problem::kRejectedCost);
  violations.setConstant(columns, std::numeric_limits<double>::infinity());
  int done = 0;
  // What was evaluated ahead: columns from `first` on, up to `last`.
  int first = 0, last = 0;
  Evaluate ahead_what = what;
  while (done < columns) {
    if (should_stop()) return done;
    const int chunk = std::min({kChunk, columns - done, evaluations_left()});
    last_known_ = false;
    const bool scored = what == Evaluate::kScore && problem_.has_scores();
    const bool score = scored && exact_chunks_ == 0;
    if (scored && !score) --exact_chunks_;
    const Evaluate wanted = score ? Evaluate::kScore : Evaluate::kValue;
    if (done >= last || wanted != ahead_what) {
      first = done;
      last = evaluate_ahead(X, done, wanted);
      ahead_what = wanted;
    }
    Ahead& evaluated = ahead()[static_cast<std::size_t>((done - first) / kChunk)];
    int exact = 0;
    try {
      if (evaluated.error) std::rethrow_exception(evaluated.error);
      count_evaluations(chunk, false);
      for (int b = 0; b < chunk; ++b) {
        const Evaluation* e = &evaluated.evaluation;
        Eigen::Index column = b;
        const auto usable = [&] {
          return e->valid[column] && std::isfinite(e->cost[column]) &&
                 e->constraints.col(column).allFinite();
        };
        // Single precision may overflow where the exact value does not.
        const bool exactly =
            score && (!usable() || improves_any(e->cost[b], violation(e->constraints.col(b))));
        if (exactly) {
          ++exact;
          if (should_stop(false)) return done + b;
          problem_.evaluate(evaluated.z.col(b), Evaluate::kValue, workspace(), exact_evaluation_);
          e = &exact_evaluation_;
          column = 0;
        }
        if (!usable()) continue;
        cost[done + b] = e->cost[column];
        violations[done + b] = violation(e->constraints.col(column));
        if (score && !exactly) {
          note_cost(cost[done + b]);
        } else {
          consider(reduce(evaluated.z.col(b)), cost[done + b], violations[done + b],
                   e->constraints.col(column));
        }
      }
    } catch (...) {
      store_exception();
      return done;
    }
    // A score costs about half of a value: it does not pay where every other one is followed by it.
    if (2 * exact > chunk) exact_chunks_ = kExactChunks;
    done += chunk;
  }
  return done;
}

EvaluationOutcome Evaluator::evaluate_start(const WarmStart& warm_start, Evaluate what,
                                            Eigen::VectorXd& x) {
  const Eigen::Index n = problem_.num_variables();
  x = middle_;
  if (warm_start.x.size() != 0) {
    if (warm_start.x.size() != n) {
      fail("warm_start.x has " + std::to_string(warm_start.x.size()) + " entries; expected " +
           std::to_string(n) + " or none");
      return EvaluationOutcome::kStopped;
    }
    if (!warm_start.x.allFinite()) {
      fail("warm_start.x has a non-finite entry; expected finite numbers");
      return EvaluationOutcome::kStopped;
    }
    x = reduce(warm_start.x).cwiseMax(lower_).cwiseMin(upper_);
  }
  EvaluationOutcome outcome = evaluate(x, what);
  if (outcome != EvaluationOutcome::kRejected) return outcome;
  const Eigen::VectorXd start = x;
  std::mt19937_64 generator(options_.seed);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  constexpr int kTries = 32;
  for (int i = 0; i < kTries && outcome == EvaluationOutcome::kRejected; ++i) {
    if (i == 0 && start != middle_) {
      x = middle_;
    } else {
      // From near the start to anywhere within the bounds.
      const double reach = static_cast<double>(i + 1) / kTries;
      for (Eigen::Index j = 0; j < x.size(); ++j) {
        const double anywhere = lower_[j] + uniform(generator) * (upper_[j] - lower_[j]);
        x[j] = start[j] + reach * (anywhere - start[j]);
      }
    }
    outcome = evaluate(x, what);
  }
  return outcome;
}

EvaluatePoint Evaluator::uncounted() {
  return [this](const Eigen::VectorXd& z, Evaluate what, Evaluation& e) {
    try {
      if (stopped_ || stop_() != StopRequest::kNone) return EvaluationOutcome::kStopped;
      problem_.evaluate(z, what, workspace(), e);
    } catch (...) {
      store_exception();
      return EvaluationOutcome::kStopped;
    }
    return is_usable(e, what) ? EvaluationOutcome::kEvaluated : EvaluationOutcome::kRejected;
  };
}

bool Evaluator::can_descend() {
  if (stopped_ || !incumbent_feasible()) return false;
  const EvaluatePoint evaluate = uncounted();
  const Judgement judgement = judge_first_order(
      problem_, expand(incumbent_), {options_.tolerance, options_.feasibility_tolerance}, evaluate);
  if (judgement.verdict != Judgement::Verdict::kDescent) return false;
  Evaluation e;
  if (evaluate(judgement.better, Evaluate::kValue, e) != EvaluationOutcome::kEvaluated)
    return false;
  consider(reduce(judgement.better), e.cost[0], violation(e.constraints.col(0)),
           e.constraints.col(0));
  return true;
}

Result Evaluator::finish(StopReason reason, bool optimum, std::string detail, WarmStart next) {
  Result result;
  result.stop = stopped_ ? stop_reason_ : reason;
  result.detail = stopped_ ? stop_detail_ : std::move(detail);
  result.counters = counters_;
  result.x = expand(incumbent_);
  result.next = std::move(next);
  result.next.x = result.x;
  if (has_incumbent_) {
    result.cost = incumbent_cost_;
    result.violation = incumbent_violation_;
    const bool converged = result.stop == StopReason::kConverged && optimum;
    result.quality = !incumbent_feasible() ? Quality::kInfeasible
                     : converged           ? Quality::kFeasibleOptimum
                                           : Quality::kFeasible;
    try {
      if (!outer_ && !beside()) result.explanation = problem_.explain(result.x);
    } catch (...) {
      if (result.stop != StopReason::kError) {
        stopped_ = false;
        store_exception();
        result.stop = stop_reason_;
        result.detail = stop_detail_;
      }
    }
  } else {
    result.x = expand(last_x_);
    result.next.x = result.x;
    result.violation = Problem::kRejectedCost;
    if (!stopped_) {
      result.stop = StopReason::kNumericalTrouble;
      result.detail = "the problem is not evaluable at any point tried";
    }
  }
  if (!beside()) result.trace = std::move(trace_);  // adopt() needs it
  result.seconds = seconds_by(stop_.clock()) - begin_;
  return result;
}

Result failed_result(const Problem& problem, std::string detail) {
  Result result;
  result.x = 0.5 * (problem.lower() + problem.upper());
  result.violation = Problem::kRejectedCost;
  result.detail = std::move(detail);
  return result;
}

}  // namespace prospect
