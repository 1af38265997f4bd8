// SPDX-License-Identifier: Apache-2.0
#include "solvers/sqp/sqp_solver.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/evaluator.h"
#include "solvers/incumbent.h"
#include "solvers/options.h"
#include "solvers/solver_frame.h"
#include "solvers/sqp/quadratic_program.h"
#include "solvers/sqp/stage_curvature.h"
#include "solvers/sqp/stage_programme.h"

namespace prospect {
namespace {

// Of the states, in their units (m, rad, m/s): wide enough to see over the kinks of maps.
constexpr double kDifference = 0.02;

// Keeps B positive definite where no cost is curved.
constexpr double kLeastCurvature = 1e-8;

constexpr double kSufficientDecrease = 1e-4;
constexpr int kLineSearch = 25;          // points of one line search
constexpr double kLeastFloor = 1e-4;     // of the eigenvalues, as a share of the option's
constexpr int kSmallSteps = 3;           // in a row, that gain no more than the tolerance
constexpr double kLargestPenalty = 1e6;  // rho in search of a common point of the constraints
constexpr double kLessMissing = 0.99;    // what is left by a step that lessens a violation

/// What an evaluation gave.
struct Point {
  Eigen::VectorXd x;
  double cost = 0.0;
  Eigen::VectorXd constraints, gradient;
  Eigen::MatrixXd jacobian;
  StageDerivatives stages;
};

class Sqp {
 public:
  Sqp(Evaluator& evaluator, double least_eigenvalue)
      : evaluator_(evaluator),
        free_(evaluator.free_variables()),
        n_(evaluator.num_variables()),
        m_(evaluator.num_constraints()),
        margin_(0.5 * evaluator.options().feasibility_tolerance),
        least_eigenvalue_(least_eigenvalue),
        by_stage_(evaluator.problem()) {
    const Horizon& h = evaluator.problem().horizon();
    const int variables = evaluator.problem().num_variables();
    curvature_.reset(h.nx(), h.N + 1);
    hessian_.setZero(variables, variables);
    by_drift_.setZero(variables);
    stage_gradient_ = stage_diagonal_ = stage_lower_ = stage_upper_ = by_drift_;
    Q_.setZero(n_, n_);
    // One more variable and column than there are, for the penalty.
    B_.setZero(n_ + 1, n_ + 1);
    g_.setZero(n_ + 1);
    A_.setOnes(m_, n_ + 1);
    lower_.setZero(n_ + 1);
    upper_.setConstant(n_ + 1, std::numeric_limits<double>::infinity());
    B_(n_, n_) = 1.0;
    unit_ = (evaluator_.upper() - evaluator_.lower()).array().square().inverse();
  }

  Result solve(const Eigen::VectorXd& start, int lifted, const WarmStart& warm_start) {
    WarmStart next;
    next.time = warm_start.time;
    here_.x = start;
    if (lifted > 0) iterate_lifted(lifted);
    if (evaluator_.evaluate(here_.x, Evaluate::kStages) == EvaluationOutcome::kRejected) {
      here_.x = start;
      evaluator_.evaluate(here_.x, Evaluate::kStages);
    }
    if (evaluator_.stopped()) return end(StopReason::kConverged, "", std::move(next));
    take(here_);
    begin_remainder();
    const Eigen::MatrixXd& known = warm_start.stage_hessians;
    const Eigen::MatrixXd& hessians = curvature_.hessians();
    if (known.rows() == hessians.rows() && known.cols() == hessians.cols() && known.allFinite()) {
      curvature_.set_hessians(known);
    }
    // Whether the curvature is from differences here.
    bool fresh = hessians.isZero(0.0) && difference();
    int small = 0;
    const double tolerance = evaluator_.options().tolerance;
    while (!evaluator_.should_stop()) {
      evaluator_.count_iteration();
      if (!find_step()) {
        return end(StopReason::kNumericalTrouble, "the quadratic programme has no solution",
                   std::move(next));
      }
      next.lambda = multipliers_;
      const double least = tolerance * std::max(1.0, std::abs(here_.cost));
      const bool feasible =
          violation(here_.constraints) <= evaluator_.options().feasibility_tolerance;
      // Also where constraints that contradict each other hold it: the step promises nothing.
      if (!feasible && expected_ <= 0.1 * least &&
          left_ > kLessMissing * missing(here_.constraints)) {
        return end(StopReason::kNumericalTrouble, "no step lessens the violation", std::move(next));
      }
      if (feasible && (expected_ <= 0.1 * least || small >= kSmallSteps)) {
        return end(StopReason::kConverged, "steps promise less than the tolerance",
                   std::move(next));
      }
      if (search_line()) {
        learn();
        small = std::abs(there_.cost - here_.cost) <= least ? small + 1 : 0;
        std::swap(here_, there_);
        fresh = false;
        continue;
      }
      if (evaluator_.stopped()) break;
      if (fresh) {
        return end(StopReason::kNumericalTrouble, "no step along a descent direction gains",
                   std::move(next));
      }
      fresh = difference();
    }
    return end(StopReason::kNumericalTrouble, "", std::move(next));
  }

 private:
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  /// How far a point is from being feasible by the margin.
  double missing(const Eigen::VectorXd& constraints) const {
    return m_ == 0 ? 0.0 : std::max(0.0, margin_ - constraints.minCoeff());
  }

  Result end(StopReason reason, std::string detail, WarmStart next) {
    next.stage_hessians = curvature_.hessians();
    const bool optimum =
        reason == StopReason::kConverged && incumbent_is_as_good(evaluator_, here_.x);
    return evaluator_.finish(reason, optimum, std::move(detail), std::move(next));
  }

  void take(Point& p) const {
    p.cost = evaluator_.cost();
    p.constraints = evaluator_.constraints();
    p.gradient = evaluator_.gradient();
    p.jacobian = evaluator_.jacobian();
    p.stages = evaluator_.stages();
  }

  /// The curvature of all stages by differences. False if the solve is over.
  bool difference() {
    if (here_.stages.state_gradient.isZero(0.0)) return true;
    for (Eigen::Index i = 0; i < here_.stages.states.rows(); ++i) {
      states_ = here_.stages.states;
      states_.row(i).array() += kDifference;
      const EvaluationOutcome outcome = evaluator_.evaluate_states(here_.x, states_);
      if (outcome == EvaluationOutcome::kStopped) return false;
      if (outcome == EvaluationOutcome::kRejected) continue;  // what was known of it stands
      curvature_.difference(static_cast<int>(i), kDifference, here_.stages.state_gradient,
                            evaluator_.stages().state_gradient);
    }
    curvature_.symmetrise();
    return true;
  }

  /// Moves here_.x by steps of states and inputs together, from all states at x_0.
  void iterate_lifted(int iterations) {
    const ProblemDefinition& d = evaluator_.problem().definition();
    Eigen::MatrixXd states = d.x0.replicate(1, d.N + 1);
    Eigen::VectorXd dz = Eigen::VectorXd::Zero(evaluator_.problem().num_variables());
    for (int i = 0; i < iterations; ++i) {
      evaluator_.count_iteration();
      if (evaluator_.evaluate_states(here_.x, states) != EvaluationOutcome::kEvaluated) return;
      there_.x = here_.x;
      take(there_);
      if (there_.stages.gap == 0.0) return;
      if (i > 0) learn_stages();
      std::swap(here_, there_);
      if ((i == 0 && !difference()) || !find_step()) return;
      here_.x = (here_.x + step_).cwiseMax(evaluator_.lower()).cwiseMin(evaluator_.upper());
      for (Eigen::Index j = 0; j < n_; ++j) dz[free_[at(j)]] = step_[j];
      for (Eigen::Index k = 1; k <= d.N; ++k) {
        states.col(k) = here_.stages.states.col(k) + here_.stages.drift.col(k) +
                        here_.stages.sensitivity[at(k)] * dz;
      }
    }
  }

  /// hessian_ and by_drift_: what the stages say at p.
  void condense(const Point& p) {
    hessian_ = p.stages.input_hessian;
    by_drift_.setZero();
    curvature_.condense(floor_ * least_eigenvalue_, p.stages.sensitivity, p.stages.drift, hessian_,
                        by_drift_);
  }

  /// The step from here, its multipliers, and the decrease of the penalty function that it stands
  /// for: `slope_` to first order, `expected_` by the quadratic model.
  bool find_step() {
    b_ = here_.constraints.array() - margin_;
    b_ += here_.stages.constraint_drift;
    left_ = 0.0;
    formed_ = false;
    if (find_step_by_stage()) return true;
    form_programme();
    QuadraticProgram::Status status = solve_programme();
    if (status == QuadraticProgram::Status::kSolved) {
      step_ = programme_.x();
      multipliers_ = programme_.multipliers();
      const double least = multipliers_.sum();
      if (rho_ < 1.2 * least) rho_ = 2.0 * least;
    } else if (status == QuadraticProgram::Status::kInfeasible) {
      status = solve_penalty();
    }
    if (status != QuadraticProgram::Status::kSolved) return false;
    slope_ = rho_ * (missing(here_.constraints) - left_) - here_.gradient.dot(step_);
    product_.noalias() = B_.topLeftCorner(n_, n_) * step_;
    expected_ = slope_ - 0.5 * step_.dot(product_);
    return true;
  }

  /// The same stage by stage, where every variable moves a state and no constraint holds the step
  /// back. False: it takes the dense programme.
  bool find_step_by_stage() {
    if (!remainder_.empty() || here_.stages.state_gradient.isZero(0.0)) return false;
    const Eigen::VectorXd z = evaluator_.expand(here_.x);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const int column = free_[at(j)];
      stage_gradient_[column] = here_.gradient[j];
      stage_diagonal_[column] =
          kLeastCurvature * (unit_[j] + here_.stages.input_hessian(column, column));
      stage_lower_[column] = evaluator_.lower()[j] - here_.x[j];
      stage_upper_[column] = evaluator_.upper()[j] - here_.x[j];
    }
    by_stage_.linearise(here_.stages.states, z);
    curvature_.project(floor_ * least_eigenvalue_);
    const auto status =
        by_stage_.solve(curvature_.projections(), here_.stages.input_hessian, stage_diagonal_,
                        stage_gradient_, here_.stages.drift, stage_lower_, stage_upper_);
    if (status != StageProgramme::Status::kSolved) return false;
    step_.resize(n_);
    for (Eigen::Index j = 0; j < n_; ++j) step_[j] = by_stage_.x()[free_[at(j)]];
    if (m_ > 0) {
      product_ = b_;
      product_.noalias() += here_.jacobian * step_;
      if (product_.minCoeff() < 0.0) return false;
    }
    multipliers_.setZero(m_);
    slope_ = rho_ * missing(here_.constraints) - here_.gradient.dot(step_);
    // B d = multipliers - g where nothing drifts.
    expected_ = slope_ - 0.5 * by_stage_.x().dot(by_stage_.multipliers() - stage_gradient_);
    return true;
  }

  /// The dense programme at here_: all but b_.
  void form_programme() {
    condense(here_);
    for (Eigen::Index j = 0; j < n_; ++j) {
      const int column = free_[at(j)];
      for (Eigen::Index i = 0; i < n_; ++i) B_(i, j) = hessian_(free_[at(i)], column) + Q_(i, j);
      B_(j, j) += kLeastCurvature * (unit_[j] + B_(j, j));
      g_[j] = here_.gradient[j] + by_drift_[column];
      lower_[j] = evaluator_.lower()[j] - here_.x[j];
      upper_[j] = evaluator_.upper()[j] - here_.x[j];
    }
    formed_ = true;
  }

  QuadraticProgram::Status solve_programme() {
    return programme_.solve(B_.topLeftCorner(n_, n_), g_.head(n_), here_.jacobian, b_,
                            lower_.head(n_), upper_.head(n_));
  }

  /// Where the linearised constraints have no common point: what each of them may miss, at most, is
  /// a variable with the cost rho. rho grows until that is as small as it can be.
  QuadraticProgram::Status solve_penalty() {
    A_.leftCols(n_) = here_.jacobian;
    double before = std::numeric_limits<double>::infinity();
    for (;; rho_ *= 10.0) {
      g_[n_] = rho_;
      const auto status = penalty_.solve(B_, g_, A_, b_, lower_, upper_);
      if (status != QuadraticProgram::Status::kSolved) return status;
      left_ = penalty_.x()[n_];
      if (left_ <= margin_ || left_ > kLessMissing * before || rho_ >= kLargestPenalty) break;
      before = left_;
    }
    step_ = penalty_.x().head(n_);
    multipliers_ = penalty_.multipliers();
    return QuadraticProgram::Status::kSolved;
  }

  /// A point along the step that decreases the penalty function, in there_. False if there is none.
  bool search_line() {
    const double here = here_.cost + rho_ * missing(here_.constraints);
    double alpha = 1.0;
    bool corrected = false;
    for (int i = 0; i < kLineSearch; ++i) {
      there_.x = here_.x + (corrected ? correction_ : step_) * alpha;
      there_.x = there_.x.cwiseMax(evaluator_.lower()).cwiseMin(evaluator_.upper());
      // After the last evaluation nobody asks for derivatives.
      const bool last = evaluator_.evaluations_left() <= 1;
      const EvaluationOutcome outcome =
          evaluator_.evaluate(there_.x, last ? Evaluate::kValue : Evaluate::kStages);
      if (outcome == EvaluationOutcome::kStopped || (last && evaluator_.should_stop())) {
        return false;
      }
      double shorter = 0.25;
      if (outcome == EvaluationOutcome::kEvaluated) {
        const double gain = here - evaluator_.cost() - rho_ * missing(evaluator_.constraints());
        if (gain >= kSufficientDecrease * alpha * slope_) {
          take(there_);
          const bool as_expected = i == 0 && gain >= 0.5 * expected_;
          floor_ = std::clamp(floor_ * (as_expected ? 0.25 : 4.0), kLeastFloor, 1.0);
          return true;
        }
        if (i == 0 && left_ == 0.0 &&
            missing(evaluator_.constraints()) > missing(here_.constraints) && correct()) {
          corrected = true;
          continue;
        }
        // The minimum of the parabola through value and slope here and the value there.
        shorter = std::clamp(0.5 * alpha * slope_ / (alpha * slope_ - gain), 0.1, 0.5);
      }
      alpha *= shorter;
      corrected = false;
    }
    return false;
  }

  /// The step to where the constraints, linearised here, are what they were found to be at its end.
  bool correct() {
    if (!formed_) form_programme();
    b_ = evaluator_.constraints().array() - margin_;
    b_.noalias() -= here_.jacobian * step_;
    if (solve_programme() != QuadraticProgram::Status::kSolved) return false;
    correction_ = programme_.x();
    return (correction_ - step_).squaredNorm() <= step_.squaredNorm();
  }

  /// Which variables move no state; Q is the unit of curvature where no cost tells more.
  void begin_remainder() {
    for (Eigen::Index j = 0; j < n_; ++j) {
      const int column = free_[at(j)];
      const auto still = [&](const Eigen::MatrixXd& S) { return S.col(column).isZero(0.0); };
      const std::vector<Eigen::MatrixXd>& S = here_.stages.sensitivity;
      if (!std::all_of(S.begin(), S.end(), still)) continue;
      remainder_.push_back(j);
      if (here_.stages.input_hessian(column, column) == 0.0) Q_(j, j) = unit_[j];
    }
  }

  /// Curvature from the way from here to there.
  void learn() {
    learn_stages();
    if (remainder_.empty()) return;
    condense(there_);
    s_.setZero(n_);
    y_.setZero(n_);
    for (const Eigen::Index i : remainder_) {
      s_[i] = there_.x[i] - here_.x[i];
      y_[i] = there_.gradient[i] - here_.gradient[i] -
              (there_.jacobian.col(i) - here_.jacobian.col(i)).dot(multipliers_);
      for (Eigen::Index j = 0; j < n_; ++j) {
        y_[i] -= hessian_(free_[at(i)], free_[at(j)]) * (there_.x[j] - here_.x[j]);
      }
    }
    // Powell's damped BFGS; the first time Q is scaled to what was seen.
    if (!scaled_ && y_.dot(s_) > 0.0) {
      Q_ *= (y_.array().square() / unit_.array()).sum() / y_.dot(s_);
      scaled_ = true;
    }
    Qs_.noalias() = Q_ * s_;
    const double sQs = s_.dot(Qs_);
    if (sQs > 0.0) {
      if (s_.dot(y_) < 0.2 * sQs) {
        const double share = 0.8 * sQs / (sQs - s_.dot(y_));
        y_ = share * y_ + (1.0 - share) * Qs_;
      }
      Q_.noalias() -= Qs_ * Qs_.transpose() / sQs;
    }
    const double sy = s_.dot(y_);
    const double lengths =
        (s_.array().square() * unit_.array()).sum() * (y_.array().square() / unit_.array()).sum();
    if (sy > 1e-10 * std::sqrt(lengths)) Q_.noalias() += y_ * y_.transpose() / sy;
  }

  void learn_stages() {
    change_ = there_.stages.states - here_.stages.states;
    gradient_change_ = there_.stages.state_gradient - here_.stages.state_gradient;
    curvature_.update(change_, gradient_change_);
  }

  Evaluator& evaluator_;
  const std::vector<int>& free_;
  Eigen::Index n_, m_;
  double margin_, least_eigenvalue_;
  Point here_, there_;
  StageCurvature curvature_;
  QuadraticProgram programme_, penalty_;
  StageProgramme by_stage_;
  double floor_ = 1.0;  // of what least_eigenvalue_ says
  double rho_ = 1.0, left_ = 0.0, slope_ = 0.0, expected_ = 0.0;
  bool scaled_ = false, formed_ = false;
  std::vector<Eigen::Index> remainder_;
  Eigen::MatrixXd Q_, B_, A_, hessian_, states_, change_, gradient_change_;
  Eigen::VectorXd unit_;  // of second derivatives: 1 over the squared range of a variable
  Eigen::VectorXd g_, b_, lower_, upper_, by_drift_, product_, step_, correction_, multipliers_;
  Eigen::VectorXd stage_gradient_, stage_diagonal_, stage_lower_, stage_upper_;  // of all variables
  Eigen::VectorXd s_, y_, Qs_;
};

class SqpSolver final : public SolverFrame {
 public:
  std::string name() const override { return "sqp"; }

  std::vector<OptionInfo> options() const override {
    std::vector<OptionInfo> options = common_options();
    options.push_back({"lifted", 0,
                       "iterations at first in which the states do not follow the dynamics, from "
                       "all states at x0; 0: none"});
    options.push_back({"least_eigenvalue", 1e-2,
                       "of the second derivatives of a stage in the first step, above 0 [cost "
                       "per squared unit of the state]"});
    return options;
  }

  std::string explain_unsupported(const Problem& problem) const override {
    return explain_no_gradient(problem);
  }

 protected:
  Evaluate start_evaluation() const override { return Evaluate::kStages; }

  void check_options(OptionSet& options) const override {
    const int lifted = options.integer("lifted");
    options.require_value("lifted", lifted >= 0 && lifted <= 1000, "0 to 1000");
    options.require_value("least_eigenvalue", options.number("least_eigenvalue") > 0.0,
                          "a number above 0");
  }

  Result run(Evaluator& evaluator, const OptionSet& options, const WarmStart& warm_start,
             const Eigen::VectorXd& start) const override {
    return Sqp(evaluator, options.number("least_eigenvalue"))
        .solve(start, options.integer("lifted"), warm_start);
  }
};

}  // namespace

std::shared_ptr<const Solver> make_sqp_solver() { return std::make_shared<SqpSolver>(); }

}  // namespace prospect
