// SPDX-License-Identifier: Apache-2.0
#include "solvers/ipopt/ipopt_solver.h"

#include <IpIpoptApplication.hpp>
#include <IpRegOptions.hpp>
#include <IpTNLP.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "solvers/evaluator.h"
#include "solvers/limited_memory_bfgs.h"
#include "solvers/options.h"
#include "solvers/solver_frame.h"

namespace prospect {
namespace {

// One lock for the process: MUMPS keeps static state, and the reference counts and option registry
// of the library are not atomic either.
std::timed_mutex& ipopt_lock() {
  static std::timed_mutex mutex;
  return mutex;
}

// These belong to this back end.
constexpr std::array<std::string_view, 13> kReserved = {"print_level",
                                                        "output_file",
                                                        "file_print_level",
                                                        "option_file_name",
                                                        "print_user_options",
                                                        "print_options_documentation",
                                                        "print_timing_statistics",
                                                        "replace_bounds",
                                                        "derivative_test",
                                                        "fixed_variable_treatment",
                                                        "max_cpu_time",
                                                        "max_wall_time",
                                                        "warm_start_init_point"};

std::vector<OptionInfo> own_options() {
  std::vector<OptionInfo> options = common_options();
  options.push_back({"tol", 1e-6, "Ipopt: scaled error of the optimality conditions [-]"});
  options.push_back({"max_iter", 3000, "Ipopt: iterations"});
  options.push_back({"mu_strategy", std::string("adaptive"), "Ipopt: adaptive or monotone"});
  options.push_back(
      {"limited_memory_max_history", 12, "pairs of the BFGS Hessian kept, 1 or more"});
  options.push_back({"max_soc", 0, "Ipopt: second-order corrections tried for one step"});
  options.push_back({"stall_iterations", 10,
                     "iterations without a gain above 'tolerance' that end the solve once it has a "
                     "feasible point; thrice as many without less violation before; 0: never"});
  options.push_back({"linear_solver", std::string("mumps"), "Ipopt: mumps, or what else it has"});
  return options;
}

/// Dual infeasibility up to which a solve that gains nothing more is taken to be at an optimum;
/// that of acceptable points by Ipopt's own reckoning would be far looser.
constexpr double kStallDual = 1e-3;
constexpr double kStallInfeasibility = 1e-4;
/// Without a feasible point, as many times `stall_iterations` end the solve, if the violation is at
/// no time less than this share of what it was: the restoration phase would go on to the last
/// evaluation.
constexpr int kStallWithoutPoint = 3;
constexpr double kViolationFalls = 0.99;

bool is_reserved(std::string_view name) {
  // The Hessian is ours: what is said of it would have no effect.
  if (name.starts_with("limited_memory_") || name.starts_with("hessian_")) return true;
  return std::find(kReserved.begin(), kReserved.end(), name) != kReserved.end();
}

/// All options the library knows, less the reserved and our own. Constant for the process.
const std::vector<OptionInfo>& library_options() {
  static const std::vector<OptionInfo> options = [] {
    const std::lock_guard lock(ipopt_lock());
    std::vector<OptionInfo> all;
    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
    const std::vector<OptionInfo> own = own_options();
    for (const auto& entry : application->RegOptions()->RegisteredOptionsList()) {
      const std::string& name = entry.first;
      const Ipopt::SmartPtr<Ipopt::RegisteredOption>& option = entry.second;
      const bool listed = std::any_of(own.begin(), own.end(),
                                      [&](const OptionInfo& info) { return info.name == name; });
      if (listed || is_reserved(name)) continue;
      OptionInfo info{name, 0.0, option->ShortDescription()};
      switch (option->Type()) {
        case Ipopt::OT_Number:
          info.fallback = static_cast<double>(option->DefaultNumber());
          break;
        case Ipopt::OT_Integer:
          info.fallback = static_cast<int>(option->DefaultInteger());
          break;
        case Ipopt::OT_String:
          info.fallback = std::string(option->DefaultString());
          break;
        default:
          continue;
      }
      all.push_back(std::move(info));
    }
    return all;
  }();
  return options;
}

/// The reduced problem as Ipopt sees it:  min f(x),  c(x) >= 0,  lower <= x <= upper.
class ReducedProblem final : public Ipopt::TNLP {
 public:
  ReducedProblem(Evaluator& evaluator, const WarmStart& warm_start, Eigen::VectorXd start,
                 bool full_warm_start, int stall_iterations, int history)
      : evaluator_(evaluator),
        bfgs_(evaluator.num_variables(), history),
        start_(std::move(start)),
        last_(start_),
        stall_iterations_(stall_iterations) {
    const auto& pattern = evaluator.problem().jacobian_pattern();
    const std::vector<int>& free = evaluator.free_variables();
    for (int r = 0; r < evaluator.num_constraints(); ++r) {
      for (int i = 0; i < evaluator.num_variables(); ++i) {
        if (pattern(r, free[static_cast<std::size_t>(i)])) entries_.emplace_back(r, i);
      }
    }
    if (full_warm_start) {
      lambda_ = warm_start.lambda.cwiseMax(0.0);
      z_lower_ = evaluator.reduce(warm_start.z_lower).cwiseMax(0.0);
      z_upper_ = evaluator.reduce(warm_start.z_upper).cwiseMax(0.0);
    }
    mu_ = warm_start.mu;
  }

  bool get_nlp_info(Ipopt::Index& n, Ipopt::Index& m, Ipopt::Index& nonzeros,
                    Ipopt::Index& hessian_nonzeros, IndexStyleEnum& style) override {
    n = evaluator_.num_variables();
    m = evaluator_.num_constraints();
    nonzeros = static_cast<Ipopt::Index>(entries_.size());
    hessian_nonzeros = n * (n + 1) / 2;
    style = TNLP::C_STYLE;
    return true;
  }

  bool get_bounds_info(Ipopt::Index n, Ipopt::Number* lower, Ipopt::Number* upper, Ipopt::Index m,
                       Ipopt::Number* c_lower, Ipopt::Number* c_upper) override {
    std::copy_n(evaluator_.lower().data(), n, lower);
    std::copy_n(evaluator_.upper().data(), n, upper);
    std::fill_n(c_lower, m, 0.5 * evaluator_.options().feasibility_tolerance);
    std::fill_n(c_upper, m, 2e19);  // Ipopt's infinity starts at 1e19
    return true;
  }

  bool get_starting_point(Ipopt::Index n, bool init_x, Ipopt::Number* x, bool init_z,
                          Ipopt::Number* z_lower, Ipopt::Number* z_upper, Ipopt::Index m,
                          bool init_lambda, Ipopt::Number* lambda) override {
    if (init_x) std::copy_n(start_.data(), n, x);
    if (init_z) {
      if (z_lower_.size() != n || z_upper_.size() != n) return false;
      std::copy_n(z_lower_.data(), n, z_lower);
      std::copy_n(z_upper_.data(), n, z_upper);
    }
    if (init_lambda) {
      if (lambda_.size() != m) return false;
      // Ipopt's Lagrangian is f + lambda g: multipliers of g >= 0 are negative there.
      for (Ipopt::Index i = 0; i < m; ++i) lambda[i] = -lambda_[i];
    }
    return true;
  }

  bool eval_f(Ipopt::Index n, const Ipopt::Number* x, bool, Ipopt::Number& value) override {
    if (!evaluate(n, x)) return false;
    value = evaluator_.cost();
    return true;
  }

  bool eval_grad_f(Ipopt::Index n, const Ipopt::Number* x, bool, Ipopt::Number* gradient) override {
    if (!evaluate(n, x)) return false;
    std::copy_n(evaluator_.gradient().data(), n, gradient);
    return true;
  }

  bool eval_g(Ipopt::Index n, const Ipopt::Number* x, bool, Ipopt::Index m,
              Ipopt::Number* g) override {
    if (!evaluate(n, x)) return false;
    std::copy_n(evaluator_.constraints().data(), m, g);
    return true;
  }

  bool eval_jac_g(Ipopt::Index n, const Ipopt::Number* x, bool, Ipopt::Index, Ipopt::Index nonzeros,
                  Ipopt::Index* row, Ipopt::Index* column, Ipopt::Number* values) override {
    if (!values) {
      for (std::size_t e = 0; e < entries_.size(); ++e) {
        row[e] = entries_[e].first;
        column[e] = entries_[e].second;
      }
      return true;
    }
    if (!evaluate(n, x)) return false;
    for (Ipopt::Index e = 0; e < nonzeros; ++e) {
      const auto& [r, c] = entries_[static_cast<std::size_t>(e)];
      values[e] = evaluator_.jacobian()(r, c);
    }
    return true;
  }

  /// The Lagrangian's, by BFGS from the points at which Ipopt asks for it: its iterates, one after
  /// the other. Lower triangle, dense.
  bool eval_h(Ipopt::Index n, const Ipopt::Number* x, bool, Ipopt::Number cost_factor,
              Ipopt::Index m, const Ipopt::Number* lambda, bool, Ipopt::Index, Ipopt::Index* row,
              Ipopt::Index* column, Ipopt::Number* values) override {
    if (values) {
      if (!evaluate(n, x)) return false;
      // The restoration phase, where the factor is 0, is about other points and no cost.
      if (cost_factor > 0.0) {
        update_bfgs(Eigen::Map<const Eigen::VectorXd>(x, n),
                    Eigen::Map<const Eigen::VectorXd>(lambda, m) / cost_factor);
      }
    }
    Ipopt::Index e = 0;
    for (Ipopt::Index i = 0; i < n; ++i) {
      for (Ipopt::Index j = 0; j <= i; ++j, ++e) {
        if (values) {
          values[e] = cost_factor * bfgs_.matrix()(i, j);
        } else {
          row[e] = i;
          column[e] = j;
        }
      }
    }
    return true;
  }

  bool intermediate_callback(Ipopt::AlgorithmMode, Ipopt::Index iteration, Ipopt::Number objective,
                             Ipopt::Number infeasibility, Ipopt::Number dual_infeasibility,
                             Ipopt::Number mu, Ipopt::Number, Ipopt::Number, Ipopt::Number,
                             Ipopt::Number, Ipopt::Index, const Ipopt::IpoptData*,
                             Ipopt::IpoptCalculatedQuantities*) override {
    if (iteration > 0) evaluator_.count_iteration();
    mu_ = mu;
    if (evaluator_.should_stop()) return false;
    if (stall_iterations_ == 0 || !evaluator_.has_incumbent()) return true;
    if (!evaluator_.incumbent_feasible()) return lessens_violation(iteration);
    const double cost = evaluator_.incumbent_cost();
    const double slack = evaluator_.options().tolerance * std::max(1.0, std::abs(cost));
    // On the way through infeasible points, or at worse ones than the incumbent, nothing is at
    // rest.
    const bool at_rest = infeasibility <= kStallInfeasibility && objective <= cost + 100.0 * slack;
    if (!stall_known_ || cost < stall_cost_ - slack || !at_rest) {
      stall_known_ = true;
      stall_cost_ = cost;
      stall_begin_ = iteration;
    }
    if (iteration - stall_begin_ < stall_iterations_) return true;
    stalled_ = true;
    stalled_at_optimum_ = dual_infeasibility <= kStallDual;
    return false;
  }

  void finalize_solution(Ipopt::SolverReturn, Ipopt::Index n, const Ipopt::Number* x,
                         const Ipopt::Number* z_lower, const Ipopt::Number* z_upper, Ipopt::Index m,
                         const Ipopt::Number*, const Ipopt::Number* lambda, Ipopt::Number,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    last_ = Eigen::Map<const Eigen::VectorXd>(x, n);
    if (z_lower && z_upper && (lambda || m == 0)) {
      z_lower_ = Eigen::Map<const Eigen::VectorXd>(z_lower, n);
      z_upper_ = Eigen::Map<const Eigen::VectorXd>(z_upper, n);
      lambda_.resize(m);
      for (Ipopt::Index i = 0; i < m; ++i) lambda_[i] = -lambda[i];
      has_multipliers_ = true;
    }
  }

  const Eigen::VectorXd& last() const { return last_; }
  /// The callback ended the solve, because nothing was gained any more.
  bool stalled() const { return stalled_; }
  bool stalled_at_optimum() const { return stalled_at_optimum_; }

  /// The primal-dual point for the next solve; the fixed variables' multipliers are zero.
  WarmStart next() const {
    WarmStart next;
    if (!has_multipliers_ || !lambda_.allFinite() || !z_lower_.allFinite() ||
        !z_upper_.allFinite()) {
      return next;
    }
    next.lambda = lambda_.cwiseMax(0.0);
    next.z_lower.setZero(evaluator_.problem().num_variables());
    next.z_upper = next.z_lower;
    for (int i = 0; i < evaluator_.num_variables(); ++i) {
      const int j = evaluator_.free_variables()[static_cast<std::size_t>(i)];
      next.z_lower[j] = std::max(0.0, z_lower_[i]);
      next.z_upper[j] = std::max(0.0, z_upper_[i]);
    }
    next.mu = std::isfinite(mu_) ? mu_ : 0.0;
    return next;
  }

 private:
  /// The gradients of f + lambda c at the last point and at this one, with the multipliers of this
  /// one.
  void update_bfgs(const Eigen::Ref<const Eigen::VectorXd>& x, const Eigen::VectorXd& lambda) {
    if (hessian_x_.size() > 0) {
      const Eigen::VectorXd y = evaluator_.gradient() - hessian_gradient_ +
                                (evaluator_.jacobian() - hessian_jacobian_).transpose() * lambda;
      bfgs_.update(x - hessian_x_, y);
    }
    hessian_x_ = x;
    hessian_gradient_ = evaluator_.gradient();
    hessian_jacobian_ = evaluator_.jacobian();
  }

  /// Whether it is worth going on for a feasible point.
  bool lessens_violation(Ipopt::Index iteration) {
    const double violation = evaluator_.incumbent_violation();
    if (violation < kViolationFalls * stall_violation_) {
      stall_violation_ = violation;
      stall_begin_ = iteration;
    }
    stalled_ = iteration - stall_begin_ >= kStallWithoutPoint * stall_iterations_;
    return !stalled_;
  }

  /// A rejected point cuts Ipopt's step; after a stop everything fails, so that it ends by itself.
  /// With derivatives at once, as most trial points are taken: to ask for them later would evaluate
  /// the point again.
  bool evaluate(Ipopt::Index n, const Ipopt::Number* x) {
    return evaluator_.evaluate(Eigen::Map<const Eigen::VectorXd>(x, n), Evaluate::kGradient) ==
           EvaluationOutcome::kEvaluated;
  }

  Evaluator& evaluator_;
  LimitedMemoryBfgs bfgs_;
  Eigen::VectorXd hessian_x_, hessian_gradient_;
  Eigen::MatrixXd hessian_jacobian_;
  Eigen::VectorXd start_, last_;
  std::vector<std::pair<int, int>> entries_;  // (row, column) of the Jacobian
  Eigen::VectorXd lambda_, z_lower_, z_upper_;
  double mu_ = 0.0;
  bool has_multipliers_ = false;
  int stall_iterations_, stall_begin_ = 0;
  double stall_cost_ = 0.0, stall_violation_ = std::numeric_limits<double>::infinity();
  bool stall_known_ = false, stalled_ = false, stalled_at_optimum_ = false;
};

void set_option(Ipopt::IpoptApplication& application, const std::string& name,
                const OptionValue& value) {
  bool accepted = false;
  if (const double* number = std::get_if<double>(&value)) {
    accepted = application.Options()->SetNumericValue(name, *number);
  } else if (const int* integer = std::get_if<int>(&value)) {
    accepted = application.Options()->SetIntegerValue(name, *integer);
  } else {
    accepted = application.Options()->SetStringValue(name, std::get<std::string>(value));
  }
  if (!accepted) {
    throw std::invalid_argument("Ipopt does not take " + describe(value) + " for option '" + name +
                                "'");
  }
}

class IpoptSolver final : public SolverFrame {
 public:
  std::string name() const override { return "ipopt"; }
  std::vector<OptionInfo> options() const override { return own_options(); }
  std::string explain_unsupported(const Problem& problem) const override {
    return explain_no_gradient(problem);
  }

 protected:
  std::vector<OptionInfo> further_options() const override { return library_options(); }

  void check_options(OptionSet& options) const override {
    options.require(options.text("linear_solver") != "ma97",
                    "option 'linear_solver' is 'ma97', which ends the whole process where its "
                    "library is absent; expected mumps, ma27, ma57, ...");
    options.require_value("limited_memory_max_history",
                          options.integer("limited_memory_max_history") >= 1, "1 or more");
    options.require(options.integer("stall_iterations") >= 0,
                    "option 'stall_iterations' is negative; expected 0 or more");
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    std::unique_lock lock(ipopt_lock(), std::defer_lock);
    while (!lock.try_lock_for(std::chrono::microseconds(500))) {
      if (evaluator.should_stop()) return evaluator.finish(StopReason::kDeadline, false, "", {});
    }
    const Eigen::Index n = evaluator.problem().num_variables();
    const bool full = warm_start.x.size() == n && warm_start.z_lower.size() == n &&
                      warm_start.z_upper.size() == n &&
                      warm_start.lambda.size() == evaluator.num_constraints() &&
                      warm_start.z_lower.allFinite() && warm_start.z_upper.allFinite() &&
                      warm_start.lambda.allFinite();

    const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
    const CommonOptions& common = evaluator.options();
    std::map<std::string, OptionValue> settings = {
        {"print_level", 0},
        {"sb", std::string("yes")},
        {"hessian_approximation", std::string("exact")},  // ours, see eval_h()
        // A refinement of every solution costs as much as the solution and changes no result.
        {"min_refinement_steps", 0},
        // Within the bounds, always: terms need not be defined outside, and what is relaxed here
        // would be violated there.
        {"bound_relax_factor", 0.0},
        {"constr_viol_tol", 0.5 * common.feasibility_tolerance},
        {"acceptable_constr_viol_tol", 0.5 * common.feasibility_tolerance},
        {"max_cpu_time", 1e10},  // the evaluator keeps the wall-clock deadline
    };
    // Of problems this small the choice of an ordering takes longer than what it saves.
    if (options.text("linear_solver") == "mumps") settings["mumps_pivot_order"] = 0;
    if (full) {
      settings["warm_start_init_point"] = std::string("yes");
      for (const char* push :
           {"warm_start_bound_push", "warm_start_bound_frac", "warm_start_slack_bound_push",
            "warm_start_slack_bound_frac", "warm_start_mult_bound_push"}) {
        settings[push] = 1e-8;
      }
      if (warm_start.mu > 0.0 && std::isfinite(warm_start.mu)) {
        settings["mu_init"] = std::clamp(warm_start.mu, 1e-8, 1e-1);
      }
    }
    const std::vector<OptionInfo> of_all = common_options();
    for (const OptionInfo& info : own_options()) {
      const bool is_common = std::any_of(of_all.begin(), of_all.end(),
                                         [&](const OptionInfo& o) { return o.name == info.name; });
      const bool is_ours = is_common || info.name == "stall_iterations";
      if (!is_ours) settings[info.name] = options.value(info.name);
    }
    for (const OptionInfo& info : library_options()) {
      if (options.is_given(info.name)) settings[info.name] = options.value(info.name);
    }
    for (const auto& [name, value] : settings) set_option(*application, name, value);
    if (application->Initialize(std::string()) != Ipopt::Solve_Succeeded) {
      throw std::runtime_error("Ipopt did not initialise; is the linear solver '" +
                               options.text("linear_solver") + "' there?");
    }

    // A point whose value is fine but whose gradient is not ends Ipopt. The incumbent is evaluable:
    // it goes on from there.
    Ipopt::SmartPtr<ReducedProblem> reduced;
    Ipopt::ApplicationReturnStatus status = Ipopt::Internal_Error;
    constexpr int kStarts = 3;
    for (int attempt = 0; attempt < kStarts; ++attempt) {
      if (attempt > 0 && full) set_option(*application, "warm_start_init_point", std::string("no"));
      reduced = new ReducedProblem(
          evaluator, warm_start, attempt == 0 ? start : evaluator.incumbent(), full,
          options.integer("stall_iterations"), options.integer("limited_memory_max_history"));
      // OptimizeTNLP anew each time: ReOptimizeTNLP of 3.11 keeps the clock of the first solve.
      status = application->OptimizeTNLP(Ipopt::SmartPtr<Ipopt::TNLP>(GetRawPtr(reduced)));
      if (status != Ipopt::Invalid_Number_Detected || evaluator.stopped()) break;
    }
    WarmStart next = reduced->next();
    next.time = warm_start.time;
    return end(evaluator, status, *reduced, std::move(next));
  }

 private:
  static Result end(Evaluator& evaluator, Ipopt::ApplicationReturnStatus status,
                    const ReducedProblem& reduced, WarmStart next) {
    if (reduced.stalled()) {
      return evaluator.finish(StopReason::kConverged, reduced.stalled_at_optimum(),
                              evaluator.incumbent_feasible()
                                  ? "Ipopt: the cost no longer falls"
                                  : "Ipopt: the violation no longer falls",
                              std::move(next));
    }
    StopReason reason = StopReason::kNumericalTrouble;
    std::string detail;
    switch (status) {
      case Ipopt::Solve_Succeeded:
        reason = StopReason::kConverged;
        detail = "Ipopt: optimal";
        break;
      case Ipopt::Solved_To_Acceptable_Level:
        reason = StopReason::kConverged;
        detail = "Ipopt: the cost no longer changes";
        break;
      case Ipopt::Feasible_Point_Found:
        reason = StopReason::kConverged;
        detail = "Ipopt: feasible point found";
        break;
      case Ipopt::Infeasible_Problem_Detected:
        detail = "Ipopt: converged to a point of local infeasibility";
        break;
      case Ipopt::Search_Direction_Becomes_Too_Small:
        detail = "Ipopt: the search direction became too small";
        break;
      case Ipopt::Diverging_Iterates:
        detail = "Ipopt: the iterates diverge";
        break;
      case Ipopt::Maximum_Iterations_Exceeded:
        reason = StopReason::kIterationLimit;
        detail = "Ipopt: max_iter used up";
        break;
      case Ipopt::Restoration_Failed:
        detail = "Ipopt: the restoration phase failed";
        break;
      case Ipopt::Error_In_Step_Computation:
        detail = "Ipopt: no step could be computed";
        break;
      case Ipopt::Invalid_Number_Detected:
        detail = "Ipopt: the problem is not evaluable where it has to be";
        break;
      case Ipopt::Invalid_Option:
      case Ipopt::Invalid_Problem_Definition:
      case Ipopt::Not_Enough_Degrees_Of_Freedom:
        reason = StopReason::kError;
        detail =
            "Ipopt: invalid option or problem, status " + std::to_string(static_cast<int>(status));
        break;
      default:
        reason = StopReason::kError;
        detail = "Ipopt: status " + std::to_string(static_cast<int>(status));
        break;
    }
    // Optimality was shown for the last iterate; the incumbent may be another point.
    bool optimum = false;
    if (reason == StopReason::kConverged && !evaluator.stopped() &&
        evaluator.incumbent_feasible() &&
        evaluator.evaluate(reduced.last(), Evaluate::kValue) == EvaluationOutcome::kEvaluated) {
      const double slack = 10.0 * std::max(evaluator.options().tolerance, 1e-9);
      optimum = evaluator.incumbent_cost() <=
                evaluator.cost() + slack * std::max(1.0, std::abs(evaluator.cost()));
    }
    return evaluator.finish(reason, optimum, std::move(detail), std::move(next));
  }
};

}  // namespace

std::shared_ptr<const Solver> make_ipopt_solver() { return std::make_shared<IpoptSolver>(); }

}  // namespace prospect
