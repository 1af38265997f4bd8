// SPDX-License-Identifier: Apache-2.0
#include "solvers/nlopt/nlopt_solver.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "solvers/augmented_lagrangian.h"
#include "solvers/evaluator.h"
#include "solvers/incumbent.h"
#include "solvers/options.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

using Constraints = NloptAlgorithm::Constraints;
using Handle = std::unique_ptr<std::remove_pointer_t<nlopt_opt>, decltype(&nlopt_destroy)>;

/// What the C callbacks work on during one nlopt_optimize().
struct Callback {
  Evaluator& evaluator;
  nlopt_opt handle = nullptr;
  const AugmentedLagrangian* merit = nullptr;  ///< null: constraints are native or there are none
  double penalty = 0.0;                        ///< > 0: static penalty
  double margin = 0.0;
  bool scaled = false;  ///< NLopt's variables are shares of the widths of the bounds
  double last_value = 0.0;
  double largest_addition = 0.0;  ///< of merit over cost, so that a rejected point stays the worst
  bool not_finite = false;        ///< the algorithm asked for a point that is not a number

  Eigen::VectorXd width() const { return evaluator.upper() - evaluator.lower(); }
  Eigen::VectorXd to_nlopt(const Eigen::VectorXd& x) const {
    return scaled ? Eigen::VectorXd((x - evaluator.lower()).cwiseQuotient(width())) : x;
  }
  Eigen::VectorXd from_nlopt(const Eigen::Ref<const Eigen::VectorXd>& y) const {
    return scaled ? Eigen::VectorXd(evaluator.lower() + width().cwiseProduct(y))
                  : Eigen::VectorXd(y);
  }
};

// The callbacks are called from C. The evaluator lets no exception out; nothing else here throws.
double objective(unsigned n, const double* x, double* gradient, void* data) noexcept {
  Callback& c = *static_cast<Callback*>(data);
  const Eigen::VectorXd point = c.from_nlopt(Eigen::Map<const Eigen::VectorXd>(x, n));
  Eigen::Map<Eigen::VectorXd> g(gradient, gradient ? n : 0);
  EvaluationOutcome outcome = EvaluationOutcome::kStopped;
  if (point.allFinite()) {
    outcome = c.evaluator.evaluate(point, gradient ? Evaluate::kGradient : Evaluate::kValue);
  } else {
    c.not_finite = true;
  }
  if (outcome == EvaluationOutcome::kStopped) {
    nlopt_force_stop(c.handle);
    g.setZero();
    return c.last_value;
  }
  double value = c.evaluator.cost();
  if (gradient) g = c.evaluator.gradient();
  if (outcome == EvaluationOutcome::kRejected) {
    value += c.largest_addition;
  } else {
    double addition = 0.0;
    if (c.merit) {
      addition = c.merit->value(0.0, c.evaluator.constraints());
      if (gradient) {
        c.merit->add_gradient(c.evaluator.constraints(), c.evaluator.jacobian(), g);
      }
    } else if (c.penalty > 0.0) {
      addition = c.penalty * (c.margin - c.evaluator.constraints().array()).max(0.0).sum();
    }
    c.largest_addition = std::max(c.largest_addition, addition);
    value += addition;
  }
  if (gradient && c.scaled) g = g.cwiseProduct(c.width()).eval();
  c.last_value = value;
  return value;
}

/// NLopt wants r(x) <= 0: r_i = margin - c_i.
void native_constraints(unsigned m, double* result, unsigned n, const double* x, double* gradient,
                        void* data) noexcept {
  Callback& c = *static_cast<Callback*>(data);
  const Eigen::VectorXd point = c.from_nlopt(Eigen::Map<const Eigen::VectorXd>(x, n));
  EvaluationOutcome outcome = EvaluationOutcome::kStopped;
  if (point.allFinite()) {
    outcome = c.evaluator.evaluate(point, gradient ? Evaluate::kGradient : Evaluate::kValue);
  } else {
    c.not_finite = true;
  }
  if (outcome == EvaluationOutcome::kStopped) nlopt_force_stop(c.handle);
  Eigen::Map<Eigen::ArrayXd>(result, m) = c.margin - c.evaluator.constraints().array();
  if (!gradient) return;
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> J(gradient, m,
                                                                                       n);
  J = -c.evaluator.jacobian();
  if (c.scaled) J = J * c.width().asDiagonal();
}

class NloptSolver final : public SolverFrame {
 public:
  NloptSolver(std::string name, const NloptAlgorithm& algorithm)
      : name_(std::move(name)),
        algorithm_(algorithm),
        id_(nlopt_algorithm_from_string(std::string(algorithm.name).c_str())) {
    // The function returns NLOPT_NUM_ALGORITHMS or -1, by version, for a name it does not know.
    if (static_cast<int>(id_) < 0 || id_ >= NLOPT_NUM_ALGORITHMS) {
      throw std::invalid_argument("this NLopt has no algorithm " + std::string(algorithm.name));
    }
  }

  std::string name() const override { return name_; }
  std::vector<OptionInfo> options() const override { return nlopt_options(algorithm_); }

  std::string explain_unsupported(const Problem& problem) const override {
    const auto free = (problem.lower().array() < problem.upper().array()).count();
    if (free > 0 && free < algorithm_.least_variables) {
      return std::string(algorithm_.name) + " needs at least " +
             std::to_string(algorithm_.least_variables) + " free variables, the problem has " +
             std::to_string(free);
    }
    return algorithm_.gradient ? explain_no_gradient(problem) : std::string();
  }

 protected:
  Evaluate start_evaluation() const override {
    return algorithm_.gradient ? Evaluate::kGradient : Evaluate::kValue;
  }

  void check_options(OptionSet& options) const override {
    for (const OptionInfo& info : this->options()) {
      if (info.name == "population" || info.name == "vector_storage") {
        options.require(options.integer(info.name) >= 0,
                        "option '" + info.name + "' is negative; expected 0 or more");
      } else if (info.name == "initial_step") {
        const double step = options.number(info.name);
        options.require_value(info.name, step >= 0.0 && step <= 1.0, "0 to 1");
      } else if (info.name == "penalty" || info.name == "initial_penalty") {
        options.require_value(info.name, options.number(info.name) > 0.0, "a number above 0");
      } else if (info.name == "initial_margin") {
        options.require_value(info.name, options.number(info.name) >= 0.0, "a number from 0 on");
      }
    }
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    nlopt_srand(static_cast<unsigned long>(options.common().seed));
    const bool outer_loop = evaluator.num_constraints() > 0 &&
                            algorithm_.constraints == Constraints::kAugmentedLagrangian;
    return outer_loop ? run_augmented(evaluator, options, warm_start, start)
                      : run_direct(evaluator, options, warm_start, start);
  }

 private:
  struct Inner {
    nlopt_result code = NLOPT_FAILURE;
    std::string message;
    bool not_finite = false;
  };

  /// One nlopt_optimize() from x, whose last point is left in x. `step`: fraction of the range of
  /// each variable, 0: NLopt's choice; not with scaled variables.
  Inner optimize(Evaluator& evaluator, const OptionSet& options, Callback& callback,
                 double tolerance, double step, Eigen::VectorXd& x) const {
    const auto n = static_cast<unsigned>(evaluator.num_variables());
    const Handle handle(nlopt_create(id_, n), &nlopt_destroy);
    if (!handle) throw std::runtime_error("nlopt_create failed");
    nlopt_opt opt = handle.get();
    callback.handle = opt;
    const auto check = [&](nlopt_result code, const char* what) {
      if (code < 0) {
        const char* message = nlopt_get_errmsg(opt);
        throw std::runtime_error(std::string(what) + " failed" +
                                 (message ? std::string(": ") + message : std::string()));
      }
    };
    check(nlopt_set_min_objective(opt, &objective, &callback), "nlopt_set_min_objective");
    const Eigen::VectorXd lower = callback.to_nlopt(evaluator.lower());
    const Eigen::VectorXd upper = callback.to_nlopt(evaluator.upper());
    check(nlopt_set_lower_bounds(opt, lower.data()), "nlopt_set_lower_bounds");
    check(nlopt_set_upper_bounds(opt, upper.data()), "nlopt_set_upper_bounds");
    const int m = evaluator.num_constraints();
    if (m > 0 && algorithm_.constraints == Constraints::kNative) {
      // Together with the margin, what NLopt takes for feasible is feasible.
      const std::vector<double> tolerances(static_cast<std::size_t>(m), callback.margin);
      check(nlopt_add_inequality_mconstraint(opt, static_cast<unsigned>(m), &native_constraints,
                                             &callback, tolerances.data()),
            "nlopt_add_inequality_mconstraint");
    }
    // The global methods compare the best value with the one before it: a small improvement early
    // on would end them. They run until the evaluations are used up.
    if (!algorithm_.global) {
      // Without derivatives two improvements in a row say less about the distance to the optimum.
      const double relative = algorithm_.gradient ? tolerance : 0.01 * tolerance;
      check(nlopt_set_ftol_rel(opt, relative), "nlopt_set_ftol_rel");
      check(nlopt_set_ftol_abs(opt, 1e-3 * relative), "nlopt_set_ftol_abs");
      check(nlopt_set_xtol_rel(opt, 1e-3 * relative), "nlopt_set_xtol_rel");
    }
    // The evaluator ends the solve; this only bounds how often remembered points are asked for.
    const int calls = std::numeric_limits<int>::max() / 8;
    check(nlopt_set_maxeval(opt, 4 * std::min(calls, evaluator.options().max_evaluations) + 100),
          "nlopt_set_maxeval");
    if (algorithm_.name == "LD_MMA" || algorithm_.name == "LD_CCSAQ") {
      // Their dual problem, one variable a constraint, is solved between two evaluations, where no
      // deadline is asked for. The default, MMA itself to 1e-14 with 100000 steps, took 1 s for 80
      // constraints. (Versions that do not know a parameter ignore it.)
      check(nlopt_set_param(opt, "dual_algorithm", NLOPT_LD_LBFGS), "dual_algorithm");
      check(nlopt_set_param(opt, "dual_ftol_rel", 1e-8), "dual_ftol_rel");
      check(nlopt_set_param(opt, "dual_maxeval", 50), "dual_maxeval");
    }
    if (step > 0.0) {
      const Eigen::VectorXd steps = step * (evaluator.upper() - evaluator.lower());
      check(nlopt_set_initial_step(opt, steps.data()), "nlopt_set_initial_step");
    }
    for (const OptionInfo& info : this->options()) {
      if (info.name == "population" && options.integer(info.name) > 0) {
        check(nlopt_set_population(opt, static_cast<unsigned>(options.integer(info.name))),
              "nlopt_set_population");
      } else if (info.name == "vector_storage" && options.integer(info.name) > 0) {
        check(nlopt_set_vector_storage(opt, static_cast<unsigned>(options.integer(info.name))),
              "nlopt_set_vector_storage");
      }
    }

    x = x.cwiseMax(evaluator.lower()).cwiseMin(evaluator.upper());
    const Eigen::VectorXd before = x;
    double value = 0.0;
    Inner inner;
    callback.not_finite = false;
    Eigen::VectorXd y = callback.to_nlopt(x).cwiseMax(lower).cwiseMin(upper);
    inner.code = nlopt_optimize(opt, y.data(), &value);
    x = callback.from_nlopt(y);
    inner.not_finite = callback.not_finite;
    if (!x.allFinite()) {
      x = before;
      inner.not_finite = true;
    }
    if (const char* message = nlopt_get_errmsg(opt)) inner.message = message;
    return inner;
  }

  static bool converged(nlopt_result code) {
    return code == NLOPT_SUCCESS || code == NLOPT_FTOL_REACHED || code == NLOPT_XTOL_REACHED;
  }

  Result end(Evaluator& evaluator, const Inner& inner, bool optimum, WarmStart next) const {
    StopReason reason = StopReason::kNumericalTrouble;
    std::string detail = std::string(algorithm_.name) + ": ";
    if (inner.not_finite) {
      detail += "the algorithm asked for a point that is not a number";
    } else {
      detail += nlopt_result_to_string(inner.code);
      if (!inner.message.empty()) detail += ", " + inner.message;
      if (converged(inner.code)) {
        reason = StopReason::kConverged;
      } else if (inner.code == NLOPT_MAXEVAL_REACHED) {
        reason = StopReason::kIterationLimit;
      } else if (inner.code == NLOPT_INVALID_ARGS || inner.code == NLOPT_OUT_OF_MEMORY) {
        reason = StopReason::kError;
      }
    }
    return evaluator.finish(reason, optimum && !algorithm_.global, std::move(detail),
                            std::move(next));
  }

  Result run_direct(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
                    Eigen::VectorXd x) const {
    Callback callback{evaluator};
    const double tolerance = evaluator.options().tolerance;
    callback.margin = 0.5 * evaluator.options().feasibility_tolerance;
    if (evaluator.num_constraints() > 0 && algorithm_.constraints == Constraints::kPenalty) {
      callback.penalty = options.number("penalty");
    }
    const double step =
        algorithm_.gradient || algorithm_.global ? 0.0 : options.number("initial_step");
    Inner inner;
    // SLSQP ends with "roundoff limited" or a line search that fails, both at solutions and far
    // from them. A restart with a fresh Hessian tells which: at a solution it gains nothing.
    constexpr int kRestarts = 5;
    for (int attempt = 0; attempt <= kRestarts; ++attempt) {
      const double before = evaluator.incumbent_cost();
      const double violation_before = evaluator.incumbent_violation();
      inner = optimize(evaluator, options, callback, tolerance, step, x);
      evaluator.count_iteration();
      if (!algorithm_.gradient || evaluator.stopped() || inner.code == NLOPT_MAXEVAL_REACHED ||
          inner.code == NLOPT_INVALID_ARGS || inner.code == NLOPT_OUT_OF_MEMORY) {
        break;
      }
      const bool gained =
          before - evaluator.incumbent_cost() > tolerance * std::max(1.0, std::abs(before)) ||
          evaluator.incumbent_violation() <
              violation_before - evaluator.options().feasibility_tolerance;
      if (!gained && attempt > 0) {
        // Where one variable is metres and another millimetres, SLSQP's first step is too short in
        // one to change the cost, and it takes that for its end.
        if (!callback.scaled && algorithm_.gradient && evaluator.can_descend()) {
          callback.scaled = true;
          x = evaluator.incumbent();
          continue;
        }
        if (!inner.not_finite && !converged(inner.code)) inner.code = NLOPT_FTOL_REACHED;
        break;
      }
      // After trouble x may be anything; after convergence it is the point to be tested.
      if (!converged(inner.code) || inner.not_finite) x = evaluator.incumbent();
    }
    if (!evaluator.stopped()) approach_from_incumbent(evaluator, x);
    WarmStart next;
    next.time = warm_start.time;
    const bool optimum = converged(inner.code) && incumbent_is_as_good(evaluator, x);
    return end(evaluator, inner, optimum, std::move(next));
  }

  Result run_augmented(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
                       Eigen::VectorXd x) const {
    const double tolerance = evaluator.options().tolerance;
    const double margin = 0.5 * evaluator.options().feasibility_tolerance;
    AugmentedLagrangian merit(evaluator.num_constraints(), warm_start.lambda,
                              options.number("initial_penalty"),
                              {.initial = options.number("initial_margin"), .final = margin});
    double step = algorithm_.gradient ? 0.0 : options.number("initial_step");
    Inner inner;
    bool solved = false;
    constexpr int kOuter = 40;
    double inner_tolerance = std::max(tolerance, 1e-3);
    for (int outer = 0; outer < kOuter; ++outer) {
      Callback callback{evaluator};
      callback.merit = &merit;
      callback.margin = margin;
      inner = optimize(evaluator, options, callback, inner_tolerance, step, x);
      evaluator.count_iteration();
      if (evaluator.stopped()) break;
      const EvaluationOutcome outcome = evaluator.evaluate(x, Evaluate::kValue);
      if (outcome == EvaluationOutcome::kStopped) break;
      if (outcome == EvaluationOutcome::kRejected || inner.not_finite) {
        x = evaluator.incumbent();
        if (outer + 1 == kOuter || inner.not_finite) break;
        continue;
      }
      if (inner.code == NLOPT_INVALID_ARGS || inner.code == NLOPT_OUT_OF_MEMORY) break;
      const bool precise = inner_tolerance <= tolerance;
      const double sigma = merit.update(evaluator.constraints());
      if (sigma <= margin && precise) {
        solved = true;
        break;
      }
      inner_tolerance = std::max(tolerance, 0.1 * inner_tolerance);
      // Later solves start next to their solution: a long first step would throw that away.
      if (!algorithm_.gradient) step = std::max(0.02, 0.3 * (step > 0.0 ? step : 0.25));
    }
    if (!evaluator.stopped()) approach_from_incumbent(evaluator, x);
    WarmStart next;
    next.time = warm_start.time;
    next.lambda = merit.lambda();
    if (!solved && converged(inner.code)) {
      inner.code = NLOPT_FAILURE;
      inner.message = "the multipliers of the constraints did not settle";
    } else if (solved && !converged(inner.code)) {
      inner.code = NLOPT_FTOL_REACHED;  // roundoff in the inner solve, yet sigma is in tolerance
    }
    return end(evaluator, inner, solved && incumbent_is_as_good(evaluator, x), std::move(next));
  }

  std::string name_;
  NloptAlgorithm algorithm_;
  nlopt_algorithm id_;
};

}  // namespace

std::shared_ptr<const Solver> make_nlopt_solver(std::string name, const NloptAlgorithm& algorithm) {
  return std::make_shared<NloptSolver>(std::move(name), algorithm);
}

}  // namespace prospect
