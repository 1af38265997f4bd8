// SPDX-License-Identifier: Apache-2.0
#include "solvers/ceres/ceres_solver.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/augmented_lagrangian.h"
#include "solvers/evaluator.h"
#include "solvers/incumbent.h"
#include "solvers/options.h"
#include "solvers/relaxed_barrier.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

/// All residuals of the problem and of its constraints, as one block of one parameter.
class Residuals final : public ceres::CostFunction {
 public:
  /// Writes the rows of the constraints as last evaluated, one more than there are constraints, and
  /// with J not null their Jacobian.
  using Constraints =
      std::function<void(Eigen::Ref<Eigen::VectorXd> r, Eigen::Ref<ResidualJacobian>* J)>;

  /// The evaluator has evaluated residuals before.
  Residuals(Evaluator& evaluator, const Constraints& constraints)
      : evaluator_(evaluator),
        constraints_(constraints),
        costs_(evaluator.residuals().size()),
        gradient_(evaluator.num_variables()) {
    set_num_residuals(static_cast<int>(costs_) + evaluator.num_constraints() + 1);
    mutable_parameter_block_sizes()->push_back(evaluator.num_variables());
  }

  // Called by Ceres, through which no exception may pass: the evaluator lets none out.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const noexcept override {
    const Eigen::Index n = evaluator_.num_variables(), more = evaluator_.num_constraints() + 1;
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], n);
    if (!x.allFinite()) return false;
    if (evaluator_.evaluate(x, prospect::Evaluate::kResiduals) != EvaluationOutcome::kEvaluated)
      return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, costs_ + more);
    r.head(costs_) = evaluator_.residuals();
    if (!jacobians || !jacobians[0]) {
      constraints_(r.tail(more), nullptr);
      return true;
    }
    Eigen::Map<ResidualJacobian> J(jacobians[0], costs_ + more, n);
    J.topRows(costs_) = evaluator_.residual_jacobian();
    Eigen::Ref<ResidualJacobian> rows = J.bottomRows(more);
    constraints_(r.tail(more), &rows);
    gradient_.noalias() = J.transpose() * r;
    for (Eigen::Index i = 0; i < n; ++i) {
      const bool pushed_out = (x[i] <= evaluator_.lower()[i] && gradient_[i] > 0.0) ||
                              (x[i] >= evaluator_.upper()[i] && gradient_[i] < 0.0);
      if (pushed_out) J.col(i).setZero();
    }
    return true;
  }

 private:
  Evaluator& evaluator_;
  const Constraints& constraints_;
  Eigen::Index costs_;
  mutable Eigen::VectorXd gradient_;
};

/// Ends a minimisation when the solve is over, or when steps that were taken gain too little: by
/// the cost of the problem, as Ceres's own test would be relative to what the cost is above an
/// offset.
class Watch final : public ceres::IterationCallback {
 public:
  Watch(Evaluator& evaluator, double tolerance) : evaluator_(evaluator), tolerance_(tolerance) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& s) override {
    if (s.iteration > 0) evaluator_.count_iteration();
    if (evaluator_.should_stop()) return ceres::SOLVER_ABORT;
    if (s.iteration == 0 || !s.step_is_successful) return ceres::SOLVER_CONTINUE;
    const double least = tolerance_ * std::max(1.0, std::abs(evaluator_.incumbent_cost()));
    small_ = s.cost_change <= least ? small_ + 1 : 0;
    return small_ >= kSmallSteps ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

 private:
  static constexpr int kSmallSteps = 2;  // one may be due to a small trust region
  Evaluator& evaluator_;
  double tolerance_;
  int small_ = 0;
};

class CeresSolver final : public SolverFrame {
 public:
  std::string name() const override { return "ceres"; }

  std::vector<OptionInfo> options() const override {
    std::vector<OptionInfo> options = common_options();
    options.push_back(
        {"initial_penalty", 1000.0, "rho of the augmented Lagrangian at the start, above 0"});
    options.push_back({"barrier", 0.01,
                       "mu of the relaxed barrier that stands for constraints at first, above 0"});
    options.push_back({"barrier_width", 0.01,
                       "delta of that barrier, finite below it, above 0 [unit of constraint]"});
    options.push_back({"barrier_trust_region_radius", 1.0,
                       "Ceres: inverse of the first damping with that barrier, above 0 [-]"});
    options.push_back({"initial_trust_region_radius", 1e4,
                       "Ceres: inverse of the first damping otherwise, above 0 [-]"});
    return options;
  }

  std::string explain_unsupported(const Problem& problem) const override {
    const std::string why = explain_no_gradient(problem);
    if (!why.empty()) return why;
    const std::string terms = problem.terms_without_residuals();
    if (terms.empty()) return {};
    return "no residual form for the sign of its weight has " + terms +
           "; a back end that minimises any cost can take this problem";
  }

 protected:
  Evaluate start_evaluation() const override { return Evaluate::kResiduals; }

  void check_options(OptionSet& options) const override {
    for (const char* name : {"initial_penalty", "barrier", "barrier_width",
                             "barrier_trust_region_radius", "initial_trust_region_radius"}) {
      options.require_value(name, options.number(name) > 0.0, "a number above 0");
    }
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    const double tolerance = evaluator.options().tolerance;
    const double margin = 0.5 * evaluator.options().feasibility_tolerance;
    const int m = evaluator.num_constraints();
    const bool constrained = m > 0;
    Eigen::VectorXd x = start;
    Eigen::VectorXd lambda = warm_start.lambda;
    if (constrained && lambda.size() != m) lambda = through_barrier(evaluator, options, margin, x);
    AugmentedLagrangian merit(m, lambda, options.number("initial_penalty"),
                              {.initial = margin, .final = margin});
    const Residuals::Constraints rows = [&](Eigen::Ref<Eigen::VectorXd> r,
                                            Eigen::Ref<ResidualJacobian>* J) {
      r[m] = 0.0;
      merit.residuals(evaluator.constraints(), r.head(m));
      if (!J) return;
      J->row(m).setZero();
      merit.residual_jacobian(evaluator.constraints(), evaluator.jacobian(), J->topRows(m));
    };
    double inner_tolerance = constrained ? std::max(tolerance, 1e-3) : tolerance;
    bool solved = false;
    std::string detail;
    constexpr int kOuter = 40;
    for (int outer = 0; outer < kOuter; ++outer) {
      const double before = evaluator.incumbent_cost();
      const bool converged = minimise(evaluator, rows, inner_tolerance,
                                      options.number("initial_trust_region_radius"), x, detail);
      if (evaluator.stopped() ||
          evaluator.evaluate(x, Evaluate::kResiduals) != EvaluationOutcome::kEvaluated) {
        break;
      }
      const bool precise = inner_tolerance <= tolerance;
      if (constrained) {
        solved = merit.update(evaluator.constraints()) <= margin && precise && converged;
      } else {
        // Nothing gained from a trust region as at the start: that was no small step of a tired
        // one.
        solved = outer > 0 && converged &&
                 before - evaluator.incumbent_cost() <= tolerance * std::max(1.0, std::abs(before));
      }
      if (solved) break;
      inner_tolerance = std::max(tolerance, 0.1 * inner_tolerance);
    }
    if (!evaluator.stopped()) approach_from_incumbent(evaluator, x);
    WarmStart next;
    next.time = warm_start.time;
    next.lambda = merit.lambda();
    const bool optimum = solved && incumbent_is_as_good(evaluator, x);
    return evaluator.finish(
        solved ? StopReason::kConverged : StopReason::kNumericalTrouble, optimum,
        solved ? "Ceres: " + detail
               : "Ceres: the minimisations did not settle, the last one: " + detail,
        std::move(next));
  }

 private:
  /// Minimisations with a falling relaxed barrier, from x to x. Returns estimates of the
  /// multipliers.
  static Eigen::VectorXd through_barrier(Evaluator& evaluator, const OptionSet& options,
                                         double margin, Eigen::VectorXd& x) {
    constexpr int kBarriers = 2;
    constexpr double kFall = 0.1;
    double mu = options.number("barrier");
    Eigen::VectorXd lambda;
    std::string detail;
    for (int i = 0; i < kBarriers && !evaluator.stopped(); ++i, mu *= kFall) {
      const RelaxedBarrier barrier(mu, options.number("barrier_width"), margin);
      const Residuals::Constraints rows = [&](Eigen::Ref<Eigen::VectorXd> r,
                                              Eigen::Ref<ResidualJacobian>* J) {
        barrier.residuals(evaluator.constraints(), r);
        if (J) barrier.residual_jacobian(evaluator.constraints(), evaluator.jacobian(), *J);
      };
      minimise(evaluator, rows, std::max(1e-3, evaluator.options().tolerance),
               options.number("barrier_trust_region_radius"), x, detail);
      if (evaluator.evaluate(x, Evaluate::kResiduals) != EvaluationOutcome::kEvaluated) break;
      lambda = barrier.multipliers(evaluator.constraints());
    }
    return lambda;
  }

  /// One minimisation from x, whose end is left in x. Whether it converged.
  static bool minimise(Evaluator& evaluator, const Residuals::Constraints& constraints,
                       double tolerance, double radius, Eigen::VectorXd& x, std::string& detail) {
    if (evaluator.evaluate(x, Evaluate::kResiduals) != EvaluationOutcome::kEvaluated) return false;
    Residuals residuals(evaluator, constraints);
    ceres::Problem::Options ownership;
    ownership.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ownership.disable_all_safety_checks = true;
    ceres::Problem problem(ownership);
    const int n = evaluator.num_variables();
    problem.AddParameterBlock(x.data(), n);
    problem.AddResidualBlock(&residuals, nullptr, x.data());
    for (int i = 0; i < n; ++i) {
      problem.SetParameterLowerBound(x.data(), i, evaluator.lower()[i]);
      problem.SetParameterUpperBound(x.data(), i, evaluator.upper()[i]);
    }

    ceres::Solver::Options options;
    options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;  // the one that takes bounds
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    const bool constrained = evaluator.num_constraints() > 0;
    options.initial_trust_region_radius = radius;
    // Where a step violates constraints, the line search that Ceres adds for bounds may take a
    // thousandth of it: there a smaller trust region does better.
    if (constrained) options.max_num_line_search_step_size_iterations = 0;
    options.max_num_iterations = 1000000;  // the evaluator keeps the budget and the deadline
    options.max_solver_time_in_seconds = 1e9;
    options.function_tolerance = 0.0;  // see Watch
    options.gradient_tolerance = 1e-12;
    options.parameter_tolerance = 1e-3 * tolerance;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    Watch watch(evaluator, tolerance);
    options.callbacks.push_back(&watch);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    detail = summary.message;
    return summary.termination_type == ceres::CONVERGENCE ||
           summary.termination_type == ceres::USER_SUCCESS;
  }
};

}  // namespace

std::shared_ptr<const Solver> make_ceres_solver() { return std::make_shared<CeresSolver>(); }

}  // namespace prospect
