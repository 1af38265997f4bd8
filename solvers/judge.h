// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>

#include "engine/problem/problem.h"
#include "engine/problem/stop_condition.h"
#include "solvers/evaluation_outcome.h"

namespace prospect {

/// The only judge of what a back end claims: of a feasible point, whether it is a local minimum; of
/// one that is not, whether a step makes it less so. What is not shown is not said.
///
/// Everything is in variables that are shares of typical_change(), y_i = x_i / s_i; a constraint
/// whose gradient by y is no plain unit, nor small at this point alone, is divided by its length,
/// so that the unit of a variable or of a constraint does not matter. g is the gradient of the cost
/// by y, a_r that of the constraint c_r >= 0, which is active where c_r is at most ten times the
/// feasibility tolerance, and nearer than 1e-4. A difference of cost counts from
///
///   w = 10 tolerance size_of_cost(f, max(|g|, |H| / 2))
///
/// on: neither an offset nor a scale of the cost hides it.
///
/// First order. d = descent_direction() gives a steepest descent that bounds and active constraints
/// leave, and multipliers. Steps along d, of 0.1 and ever shorter ones, must not gain 10 w, as
/// methods end a little short of a minimum; nor must those along the least g . d + |g| |d|^2 / 0.2
/// that all linearised constraints leave.
/// Second order. Z spans what is left by bounds and active constraints whose multipliers make a
/// step of 0.1 off them cost w. H is the Hessian of the Lagrangian in Z, by differences of its
/// gradient. Where all its eigenvalues make a step of 0.3 cost more than w, x is a minimum, unless
/// steps along the vectors of the least ones gain 10 w: differences take a change of curvature for
/// curvature. Along a vector of any other eigenvalue steps of 0.001 to 0.3 are tried to both sides,
/// each followed by Newton's step in the others (along a curved valley the cost may fall where
/// every straight line rises), and by one back to the active constraints. One that gains 10 w
/// refutes the claim. So does Newton's step from x, if it gains; if it promises 10 w and does not,
/// nothing is shown. Where there is one such vector and the cost rises by w to both sides, x is a
/// minimum; else nothing is shown: saddles of higher order, plateaus, and variables that do not
/// matter look alike.
///
/// A cost within w of the lower bound that its terms state (ResidualForm) is a minimum, whatever
/// its curvature.
///
/// A claim also needs the cost to be known: where the feasibility tolerance of the constraints is
/// worth more than 10 w by their multipliers, nothing is shown.
///
/// Evaluations: one with gradient, a few values, and at a stationary point one with gradient for
/// each dimension of Z. Source: Nocedal and Wright (2006), sections 12.3 and 12.5; the thresholds
/// are ours.
struct Judgement {
  enum class Verdict {
    kOptimum,     ///< feasible, no step gains, and the cost rises all around
    kUnproven,    ///< feasible, and nothing found that refutes or proves a minimum
    kDescent,     ///< `better` is feasible, and its cost is lower by what counts
    kInfeasible,  ///< violates a constraint, and no small step lessens that
    kLessens,     ///< violates a constraint, `better` does so less
    kUnknown      ///< not evaluable, without a gradient, or the time is over
  };
  Verdict verdict = Verdict::kUnknown;
  std::string why;         ///< a few words
  Eigen::VectorXd better;  ///< n
};

/// Evaluates the problem at a point of n variables. Nothing is asked after it said kStopped.
using EvaluatePoint =
    std::function<EvaluationOutcome(const Eigen::VectorXd& z, Evaluate what, Evaluation&)>;

struct JudgeTolerances {
  double cost = 1e-6;         ///< CommonOptions::tolerance
  double feasibility = 1e-6;  ///< in plain units
  /// What a tolerance of 1 stood for in the solve, in place of max(1, |f|); 0: that.
  double size = 0.0;
};

/// Judges z (n, within the bounds). Passes on what `evaluate` throws. Deterministic; stateless.
Judgement judge(const Problem& problem, const Eigen::VectorXd& z, const JudgeTolerances& tolerances,
                const EvaluatePoint& evaluate);

/// The same with a workspace of its own: for what a back end from elsewhere claims. kUnknown where
/// a term throws, z has not n finite entries, or the stop condition strikes.
Judgement judge(const Problem& problem, const Eigen::VectorXd& z,
                const JudgeTolerances& tolerances = {}, const StopCondition& stop = {});

/// The first-order part alone, with differences of cost that count from 10 tolerance max(1, |f|)
/// on: kDescent or kUnproven at a feasible point, else kUnknown.
Judgement judge_first_order(const Problem& problem, const Eigen::VectorXd& z,
                            const JudgeTolerances& tolerances, const EvaluatePoint& evaluate);

}  // namespace prospect
