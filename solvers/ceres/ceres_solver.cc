#include "solvers/ceres/ceres_solver.h"

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "solvers/augmented_lagrangian.h"
#include "solvers/evaluator.h"
#include "solvers/incumbent.h"
#include "solvers/options.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

using Rows = AugmentedLagrangian::Rows;

/// All residuals of the problem and of its constraints, as one block of one parameter.
class Residuals final : public ceres::CostFunction {
 public:
  /// The evaluator has evaluated residuals before.
  Residuals(Evaluator& evaluator, const AugmentedLagrangian& merit)
      : evaluator_(evaluator),
        merit_(merit),
        costs_(evaluator.residuals().size()),
        gradient_(evaluator.num_variables()) {
    set_num_residuals(static_cast<int>(costs_) + evaluator.num_constraints());
    mutable_parameter_block_sizes()->push_back(evaluator.num_variables());
  }

  // Called by Ceres, through which no exception may pass: the evaluator lets none out.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const noexcept override {
    const Eigen::Index n = evaluator_.num_variables(), m = evaluator_.num_constraints();
    const Eigen::Map<const Eigen::VectorXd> x(parameters[0], n);
    if (!x.allFinite()) return false;
    if (evaluator_.evaluate(x, prospect::Evaluate::kResiduals) != Outcome::kEvaluated) return false;
    Eigen::Map<Eigen::VectorXd> r(residuals, costs_ + m);
    r.head(costs_) = evaluator_.residuals();
    if (!jacobians || !jacobians[0]) {
      merit_.residuals(evaluator_.constraints(), evaluator_.jacobian(), r.tail(m), nullptr);
      return true;
    }
    Eigen::Map<Rows> J(jacobians[0], costs_ + m, n);
    J.topRows(costs_) = evaluator_.residual_jacobian();
    Eigen::Ref<Rows> rows = J.bottomRows(m);
    merit_.residuals(evaluator_.constraints(), evaluator_.jacobian(), r.tail(m), &rows);
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
  const AugmentedLagrangian& merit_;
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
    options.push_back(
        {"initial_trust_region_radius", 1e4, "Ceres: inverse of the first damping, above 0 [-]"});
    options.push_back({"linear_solver", std::string("dense_normal_cholesky"),
                       "Ceres: dense_normal_cholesky or dense_qr"});
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
    for (const char* name : {"initial_penalty", "initial_trust_region_radius"}) {
      options.require_value(name, options.number(name) > 0.0, "a number above 0");
    }
    ceres::LinearSolverType type;
    options.require_value("linear_solver", linear_solver(options, type),
                          "dense_normal_cholesky or dense_qr");
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    const double tolerance = evaluator.options().tolerance;
    const double margin = 0.5 * evaluator.options().feasibility_tolerance;
    const bool constrained = evaluator.num_constraints() > 0;
    AugmentedLagrangian merit(evaluator.num_constraints(), warm_start.lambda,
                              options.number("initial_penalty"), margin);
    Eigen::VectorXd x = start;
    double inner_tolerance = constrained ? std::max(tolerance, 1e-3) : tolerance;
    bool solved = false;
    std::string detail;
    constexpr int kOuter = 40;
    for (int outer = 0; outer < kOuter; ++outer) {
      const double before = evaluator.incumbent_cost();
      const bool converged = minimise(evaluator, options, merit, inner_tolerance, x, detail);
      if (evaluator.stopped() || evaluator.evaluate(x, Evaluate::kValue) != Outcome::kEvaluated) {
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
  static bool linear_solver(const OptionSet& options, ceres::LinearSolverType& type) {
    const std::string& name = options.text("linear_solver");
    type = name == "dense_qr" ? ceres::DENSE_QR : ceres::DENSE_NORMAL_CHOLESKY;
    return name == "dense_qr" || name == "dense_normal_cholesky";
  }

  /// One minimisation from x, whose end is left in x. Whether it converged.
  static bool minimise(Evaluator& evaluator, const OptionSet& set, const AugmentedLagrangian& merit,
                       double tolerance, Eigen::VectorXd& x, std::string& detail) {
    // The residuals are counted where x was evaluated with them: mostly remembered.
    if (evaluator.evaluate(x, Evaluate::kResiduals) != Outcome::kEvaluated) return false;
    Residuals residuals(evaluator, merit);
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
    linear_solver(set, options.linear_solver_type);
    options.initial_trust_region_radius = set.number("initial_trust_region_radius");
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
