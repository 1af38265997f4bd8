// SPDX-License-Identifier: Apache-2.0
#include "solvers/judge.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "engine/support/eigenvalues.h"
#include "solvers/descent_direction.h"
#include "solvers/sqp/quadratic_program.h"
#include "solvers/typical_change.h"

namespace prospect {
namespace {

using Eigen::Index;
using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Verdict = Judgement::Verdict;

constexpr double kNear = 1e-4;                // distance of an active constraint [typical change]
constexpr double kAtBound = 1e-6;             // likewise, of a bound
constexpr double kGradientDifference = 1e-5;  // of the gradients that the Hessian is from, likewise
constexpr double kAsymmetry = 0.1;            // of a matrix of differences of a smooth gradient
constexpr double kReach = 0.3;                // of the steps that tell a minimum
constexpr double kLessViolated = 0.99;        // what is left by a step that lessens a violation
constexpr std::array kProbes = {1e-3, 3e-3, 1e-2, 3e-2, 1e-1, kReach};

/// The time is over: leaves the whole judgement.
struct Over {};

class Judge {
 public:
  Judge(const Problem& problem, const Vector& z, const JudgeTolerances& tolerances,
        const EvaluatePoint& evaluate)
      : problem_(problem), tolerances_(tolerances), evaluate_(evaluate), z_(z) {
    for (int i = 0; i < problem.num_variables(); ++i) {
      if (problem.lower()[i] < problem.upper()[i]) free_.push_back(i);
    }
    lower_ = problem.lower()(free_);
    upper_ = problem.upper()(free_);
    x_ = z(free_);
    s_ = typical_change(x_, lower_, upper_);
  }

  Judgement first_order() {
    if (!begin() || violation_ > tolerances_.feasibility) return {};
    count_from(std::max(1.0, std::abs(cost_)));
    return descend(counts_) ? found(Verdict::kDescent) : Judgement{Verdict::kUnproven, "", {}};
  }

  Judgement all() {
    if (!begin()) return {Verdict::kUnknown, "the problem has no gradient there", {}};
    if (violation_ > tolerances_.feasibility) return infeasible();
    if (free_.empty()) return {Verdict::kOptimum, "", {}};
    count_from(tolerances_.size > 0.0 ? tolerances_.size : std::max(1.0, std::abs(cost_)));
    if (descend(refutes()) || descend_beside()) return found(Verdict::kDescent);
    return second_order();
  }

 private:
  bool at(const Vector& x, Evaluate what, Evaluation& e) {
    Vector z = z_;
    for (std::size_t i = 0; i < free_.size(); ++i) z[free_[i]] = x[static_cast<Index>(i)];
    const EvaluationOutcome outcome = evaluate_(z, what, e);
    if (outcome == EvaluationOutcome::kStopped) throw Over();
    return outcome == EvaluationOutcome::kEvaluated;
  }

  Vector within(const Vector& x) const { return x.cwiseMax(lower_).cwiseMin(upper_); }

  /// Of scaled constraints.
  double violation_of(const Evaluation& e) const {
    return e.constraints.rows() == 0
               ? 0.0
               : std::max(0.0, -(e.constraints.col(0).array() / unit_.array()).minCoeff());
  }

  /// Whether the gradient of constraint r is small there alone, as of (x - 1)^3 near 1: within
  /// reach it changes by a plain unit.
  bool vanishes(Index r) {
    if (unit_[r] >= kSmallestUnit) return false;
    const Vector step = kReach / unit_[r] * s_.cwiseProduct(A_.row(r).transpose());
    Evaluation e;
    for (const double side : {1.0, -1.0}) {
      if (!at(within(x_ + side * step), Evaluate::kValue, e)) continue;
      const double change = std::abs(e.constraints(r, 0) - e_.constraints(r, 0));
      if (change >= kReach * kSmallestUnit) return true;
    }
    return false;
  }

  /// Value and derivatives at x, scaled. False where there are none.
  bool begin() {
    if (!problem_.has_gradient() || !at(x_, Evaluate::kGradient, e_)) return false;
    cost_ = e_.cost[0];
    g_ = e_.gradient(free_).cwiseProduct(s_);
    A_ = e_.jacobian(Eigen::all, free_) * s_.asDiagonal();
    unit_ = A_.rowwise().norm();
    for (Index r = 0; r < unit_.size(); ++r) {
      if (is_plain_unit(unit_[r]) || vanishes(r)) unit_[r] = 1.0;
    }
    A_.array().colwise() /= unit_.array();
    c_ = e_.constraints.col(0).cwiseQuotient(unit_);
    violation_ = violation_of(e_);
    for (Index r = 0; r < c_.size(); ++r) {
      if (c_[r] <= std::min(10.0 * tolerances_.feasibility, kNear * A_.row(r).norm())) {
        active_.push_back(r);
      }
    }
    shares_ = (x_ - lower_).cwiseQuotient(upper_ - lower_);
    const Vector near = kAtBound * s_.cwiseQuotient(upper_ - lower_);
    for (Index i = 0; i < x_.size(); ++i) {
      if (shares_[i] <= near[i]) shares_[i] = 0.0;
      if (shares_[i] >= 1.0 - near[i]) shares_[i] = 1.0;
    }
    return true;
  }

  void count_from(double size) { counts_ = 10.0 * std::max(tolerances_.cost, 1e-9) * size; }

  /// What a slope must promise and gain to refute a claim: methods end a little short of a minimum.
  double refutes() const { return 10.0 * counts_; }

  /// Whether the evaluated point at x is feasible and gains `least`: keeps it.
  bool gains(const Vector& x, const Evaluation& e, double least) {
    if (!(cost_ - e.cost[0] > least)) return false;
    if (violation_of(e) > tolerances_.feasibility) return false;
    // In the unit that the problem states it must not be worse either.
    if (violation(e.constraints.col(0)) >
        std::max(tolerances_.feasibility, violation(e_.constraints.col(0)))) {
      return false;
    }
    better_ = x;
    return true;
  }

  Judgement found(Verdict verdict) const {
    Vector z = z_;
    for (std::size_t i = 0; i < free_.size(); ++i) z[free_[i]] = better_[static_cast<Index>(i)];
    return {verdict,
            verdict == Verdict::kDescent ? "a step down the cost gains more"
                                         : "a step lessens the violation",
            z};
  }

  /// Steps down the cost, from far to near: where the cost is curved much, only a short one gains.
  bool descend(double least) {
    if (free_.empty()) return false;
    const Vector d = descent_direction(g_, A_(active_, Eigen::all), shares_, &multipliers_);
    const double longest = d.lpNorm<Eigen::Infinity>();
    for (double step = 0.1; longest > 0.0 && step > 1e-6; step *= 0.2) {
      const double along = step / longest;
      // To first order that is all it gains.
      if (-along * g_.dot(d) < least) break;
      const Vector x = within(x_ + along * d.cwiseProduct(s_));
      Evaluation e;
      if (at(x, Evaluate::kValue, e) && gains(x, e, least)) return true;
    }
    return false;
  }

  /// Steps to the minimum of the linearised cost with |d|^2 among all linearised constraints: along
  /// those that are near, but not active.
  bool descend_beside() {
    const Index n = x_.size();
    const double length = g_.norm();
    if (A_.rows() == static_cast<Index>(active_.size()) || !(length > 0.0)) return false;
    constexpr double kStep = 0.1;
    QuadraticProgram programme;
    const auto status =
        programme.solve(length / kStep * Matrix::Identity(n, n), g_, A_, c_.cwiseMax(0.0),
                        (lower_ - x_).cwiseQuotient(s_), (upper_ - x_).cwiseQuotient(s_));
    if (status != QuadraticProgram::Status::kSolved) return false;
    for (double share = 1.0; share > 1e-5; share *= 0.2) {
      const Vector d = share * programme.x();
      if (-g_.dot(d) < refutes()) break;
      const Vector x = within(x_ + s_.cwiseProduct(d));
      Evaluation e;
      if (at(x, Evaluate::kValue, e) && gains(x, e, refutes())) return true;
    }
    return false;
  }

  /// The gradient of the Lagrangian.
  Vector lagrangian(const Evaluation& e) const {
    Vector gradient = e.gradient(free_).cwiseProduct(s_);
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const Index r = active_[k];
      const double multiplier = multipliers_[static_cast<Index>(k)];
      if (multiplier == 0.0) continue;
      gradient -= multiplier / unit_[r] * e.jacobian.row(r)(free_).transpose().cwiseProduct(s_);
    }
    return gradient;
  }

  /// Z_: what bounds and constraints leave of which a step of 0.1 off them costs what counts.
  void span_rest() {
    const Index n = x_.size(), rows = static_cast<Index>(active_.size());
    const double least = 10.0 * counts_;
    strong_.clear();
    std::vector<Vector> normals;
    for (Index k = 0; k < rows; ++k) {
      const Vector normal = A_.row(active_[static_cast<std::size_t>(k)]).transpose();
      if (multipliers_[k] * normal.norm() < least) continue;
      strong_.push_back(active_[static_cast<std::size_t>(k)]);
      normals.push_back(normal.normalized());
    }
    for (Index i = 0; i < n; ++i) {
      if (multipliers_[rows + i] >= least) normals.push_back(Vector::Unit(n, i));
    }
    if (normals.empty()) {
      Z_.setIdentity(n, n);
      return;
    }
    Matrix N(n, static_cast<Index>(normals.size()));
    for (std::size_t k = 0; k < normals.size(); ++k) N.col(static_cast<Index>(k)) = normals[k];
    Eigen::ColPivHouseholderQR<Matrix> qr(N);
    qr.setThreshold(1e-8);
    const Matrix Q = qr.householderQ();
    Z_ = Q.rightCols(n - qr.rank());
  }

  /// The Hessian of the Lagrangian in Z_, by differences. False where they cannot be had.
  bool difference() {
    const Index k = Z_.cols();
    const Vector here = lagrangian(e_);
    H_.resize(k, k);
    Evaluation e;
    for (Index j = 0; j < k; ++j) {
      bool known = false;
      // To the side that the bounds leave, else the other one.
      double length = kGradientDifference;
      const auto cut = [&](double h) {
        const Vector x = x_ + h * s_.cwiseProduct(Z_.col(j));
        return (within(x) - x).cwiseQuotient(s_).norm();
      };
      if (cut(length) > cut(-length)) length = -length;
      for (const double h : {length, -length}) {
        const Vector x = within(x_ + h * s_.cwiseProduct(Z_.col(j)));
        if (!at(x, Evaluate::kGradient, e)) continue;
        H_.col(j) = Z_.transpose() * (lagrangian(e) - here) / h;
        known = H_.col(j).allFinite();
        if (known) break;
      }
      if (!known) return false;
    }
    const double length = H_.norm();
    smooth_ = (H_ - H_.transpose()).norm() <= kAsymmetry * length;
    H_ = 0.5 * (H_ + H_.transpose()).eval();
    return true;
  }

  /// What the residual forms of the terms say of the cost.
  double lower_bound() const {
    double bound = 0.0;
    for (const auto& [term, weight] : problem_.definition().terms) {
      if (term->traits().kind != TermKind::kCost || weight == 0.0) continue;
      const auto form = term->residual_form(problem_.horizon(), weight > 0.0 ? 1 : -1);
      if (!form) return -std::numeric_limits<double>::infinity();
      bound += std::abs(weight) * form->offset;
    }
    return bound;
  }

  Judgement second_order() {
    span_rest();
    if (!difference()) return {Verdict::kUnproven, "no curvature can be had there", {}};
    double unit = g_.lpNorm<Eigen::Infinity>();
    if (H_.size() > 0) unit = std::max(unit, 0.5 * H_.cwiseAbs().maxCoeff());
    if (!(unit > 0.0)) return {Verdict::kUnproven, "the cost is flat there", {}};
    const double coarse = counts_;
    count_from(tolerances_.size > 0.0 ? std::min(tolerances_.size, unit)
                                      : size_of_cost(cost_, unit));
    if (counts_ < coarse) {
      if (descend(refutes()) || descend_beside()) return found(Verdict::kDescent);
      span_rest();
      if (!difference()) return {Verdict::kUnproven, "no curvature can be had there", {}};
    }
    if (cost_ - lower_bound() <= counts_) return {Verdict::kOptimum, "", {}};
    const double worth =
        tolerances_.feasibility * multipliers_.head(static_cast<Index>(active_.size())).sum();
    if (worth > refutes()) {
      return {Verdict::kUnproven, "the cost hangs on the tolerance of the constraints", {}};
    }
    if (Z_.cols() == 0) return {Verdict::kOptimum, "", {}};
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(H_);
    const Vector& values = eigen.eigenvalues();  // from the least on
    // Three times what counts, by a step of kReach.
    const double least = 6.0 * counts_ / (kReach * kReach);
    Index weak = 0;
    while (weak < values.size() && values[weak] < least) ++weak;
    const Matrix V = Z_ * eigen.eigenvectors();
    valley_ = V.rightCols(values.size() - weak);
    valley_curvature_ = values.tail(values.size() - weak);
    if (!is_stationary()) {
      if (newton()) return found(Verdict::kDescent);
      return {Verdict::kUnproven, "the cost has a slope there", {}};
    }
    // Differences make a little curvature of its change, as at 0 of x^3.
    constexpr double kLittle = 1e-3;
    for (Index j = weak; j < values.size(); ++j) {
      const bool little = j == weak || values[j] <= kLittle * values[values.size() - 1];
      if (little && falls_along(V.col(j))) return found(Verdict::kDescent);
    }
    if (weak == 0 && smooth_) return {Verdict::kOptimum, "", {}};
    bool rises = true;
    for (Index j = 0; j < weak; ++j) {
      for (const double side : {1.0, -1.0}) {
        const Side probed = probe(side * V.col(j));
        if (probed == Side::kFalls) return found(Verdict::kDescent);
        rises = rises && probed == Side::kRises;
      }
    }
    if (!smooth_) return {Verdict::kUnproven, "the cost has kinks there", {}};
    if (weak == 1 && rises) return {Verdict::kOptimum, "", {}};
    return {Verdict::kUnproven, "the cost is flat there in some direction", {}};
  }

  /// Whether Newton's step promises little: where the cost is curved by far more in one direction
  /// than in another, steps down its gradient say little of how far the minimum is.
  bool is_stationary() {
    const Vector slope = valley_.transpose() * lagrangian(e_);
    newton_ = -valley_ * slope.cwiseQuotient(valley_curvature_);
    return -0.5 * lagrangian(e_).dot(newton_) < refutes();
  }

  bool newton() {
    Vector x = within(x_ + s_.cwiseProduct(newton_));
    Evaluation e;
    return return_to_constraints(x) && at(x, Evaluate::kValue, e) && gains(x, e, counts_);
  }

  /// Whether a step along v or against it gains, however little it may matter.
  bool falls_along(const Vector& v) {
    Evaluation e;
    for (const double side : {1.0, -1.0}) {
      for (auto t = kProbes.rbegin(); t != kProbes.rend(); ++t) {
        Vector x = within(x_ + side * *t * s_.cwiseProduct(v));
        if (return_to_constraints(x) && at(x, Evaluate::kValue, e) && gains(x, e, refutes())) {
          return true;
        }
      }
    }
    return false;
  }

  enum class Side { kFalls, kRises, kUnclear };

  /// The cost along v from x, one side.
  Side probe(const Vector& v) {
    Evaluation e;
    for (const double t : kProbes) {
      const Vector straight = within(x_ + t * s_.cwiseProduct(v));
      if ((straight - x_).cwiseQuotient(s_).norm() < 0.1 * t) return Side::kRises;  // a bound
      if (!at(straight, Evaluate::kGradient, e)) return Side::kUnclear;
      if (gains(straight, e, refutes())) return Side::kFalls;
      const bool left = violation_of(e) > tolerances_.feasibility;
      double least = left ? std::numeric_limits<double>::infinity() : e.cost[0];
      Vector x = straight;
      if (valley_.cols() > 0) {
        const Vector slope = valley_.transpose() * lagrangian(e);
        x = within(x - s_.cwiseProduct(valley_ * slope.cwiseQuotient(valley_curvature_)));
      }
      if (valley_.cols() > 0 || !strong_.empty()) {
        if (!return_to_constraints(x)) continue;
        if (!at(x, Evaluate::kValue, e)) continue;
        if (gains(x, e, refutes())) return Side::kFalls;
        if (violation_of(e) <= tolerances_.feasibility) least = std::min(least, e.cost[0]);
      }
      if (std::isinf(least)) {
        // Held by a constraint that was not active: no way down here.
        if (strong_.empty()) return Side::kRises;
        continue;
      }
      if (least - cost_ > counts_) return Side::kRises;
    }
    return Side::kUnclear;
  }

  /// Newton's steps from x to where the strong constraints are what they are at x_.
  bool return_to_constraints(Vector& x) {
    if (strong_.empty()) return true;
    const Matrix N = A_(strong_, Eigen::all);
    const Matrix NN = N * N.transpose();
    Evaluation e;
    for (int i = 0; i < 2; ++i) {
      if (!at(x, Evaluate::kValue, e)) return false;
      const Vector off = e.constraints.col(0)(strong_).cwiseQuotient(unit_(strong_)) - c_(strong_);
      if (off.lpNorm<Eigen::Infinity>() <= 0.1 * tolerances_.feasibility) return true;
      const Vector y = N.transpose() * NN.completeOrthogonalDecomposition().solve(off);
      x = within(x - s_.cwiseProduct(y));
    }
    return true;
  }

  bool lessens(const Vector& x) {
    Evaluation e;
    if (!at(x, Evaluate::kValue, e) || violation_of(e) > kLessViolated * violation_) return false;
    better_ = x;
    return true;
  }

  /// min_d t + tiny |d|^2 / 2  s.t.  c_r + a_r d + t >= 0,  |d_i| <= 0.1, within the bounds: what
  /// is left of the violation by the best small step, to first order.
  Judgement infeasible() {
    const Index n = x_.size(), m = c_.size();
    if (n > 0) {
      constexpr double kStep = 0.1, kTiny = 1e-6;
      Matrix B = kTiny * violation_ * Matrix::Identity(n + 1, n + 1);
      Vector g = Vector::Zero(n + 1);
      g[n] = 1.0;
      Matrix A = Matrix::Ones(m, n + 1);
      A.leftCols(n) = A_;
      Vector lower(n + 1), upper(n + 1);
      lower << (lower_ - x_).cwiseQuotient(s_).cwiseMax(-kStep), 0.0;
      upper << (upper_ - x_).cwiseQuotient(s_).cwiseMin(kStep),
          std::numeric_limits<double>::infinity();
      QuadraticProgram programme;
      if (programme.solve(B, g, A, c_, lower, upper) == QuadraticProgram::Status::kSolved) {
        const Vector d = programme.x().head(n);
        for (double step = 1.0; step > 1e-5; step *= 0.2) {
          if (lessens(within(x_ + step * s_.cwiseProduct(d)))) return found(Verdict::kLessens);
        }
      }
      // Where the gradients of the constraints vanish, as between two feasible sets.
      for (const double step : {0.01, 0.1, 0.5}) {
        for (Index i = 0; i < n; ++i) {
          for (const double side : {step, -step}) {
            if (lessens(within(x_ + side * s_[i] * Vector::Unit(n, i)))) {
              return found(Verdict::kLessens);
            }
          }
        }
      }
    }
    return {Verdict::kInfeasible, "no small step lessens the violation", {}};
  }

  const Problem& problem_;
  JudgeTolerances tolerances_;
  const EvaluatePoint& evaluate_;
  Vector z_;
  std::vector<Index> free_, active_, strong_;
  Vector lower_, upper_, x_, s_, shares_;
  Evaluation e_;  // at x
  bool smooth_ = true;
  double cost_ = 0.0, violation_ = 0.0, counts_ = 0.0;
  Vector g_, c_, unit_, multipliers_;
  Matrix A_, Z_, H_, valley_;
  Vector valley_curvature_, newton_, better_;
};

}  // namespace

Judgement judge(const Problem& problem, const Eigen::VectorXd& z, const JudgeTolerances& tolerances,
                const EvaluatePoint& evaluate) {
  try {
    return Judge(problem, z, tolerances, evaluate).all();
  } catch (const Over&) {
    return {Verdict::kUnknown, "no time was left to prove it", {}};
  }
}

Judgement judge_first_order(const Problem& problem, const Eigen::VectorXd& z,
                            const JudgeTolerances& tolerances, const EvaluatePoint& evaluate) {
  try {
    return Judge(problem, z, tolerances, evaluate).first_order();
  } catch (const Over&) {
    return {};
  }
}

Judgement judge(const Problem& problem, const Eigen::VectorXd& z, const JudgeTolerances& tolerances,
                const StopCondition& stop) {
  if (z.size() != problem.num_variables() || !z.allFinite()) return {};
  try {
    Workspace workspace = problem.make_workspace();
    return judge(problem, z, tolerances, [&](const Vector& at, Evaluate what, Evaluation& e) {
      if (stop() != StopRequest::kNone) return EvaluationOutcome::kStopped;
      problem.evaluate(at, what, workspace, e);
      return is_usable(e, what) ? EvaluationOutcome::kEvaluated : EvaluationOutcome::kRejected;
    });
  } catch (...) {
    return {Verdict::kUnknown, "a term throws there", {}};
  }
}

}  // namespace prospect
