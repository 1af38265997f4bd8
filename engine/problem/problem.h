// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "engine/problem/term.h"
#include "engine/problem/trajectory.h"
#include "engine/task/zone_map.h"

namespace prospect {

/// Raw and weighted value of one term at one point.
struct TermValue {
  std::string name;
  std::string unit;
  double raw = 0.0;       ///< cost: the term's value; constraint: its smallest row
  double weighted = 0.0;  ///< contribution to the objective; 0 for constraints
  bool constraint = false;
  TermQuantity quantity = TermQuantity::kOther;
};

struct Explanation {
  double cost = 0.0;
  double violation = 0.0;  ///< max_r max(0, -c_r)
  std::vector<TermValue> terms;
};

/// What a problem is made of. Checked by Problem's constructor.
struct ProblemDefinition {
  struct WeightedTerm {
    std::shared_ptr<const Term> term;
    double weight = 1.0;  ///< ignored for constraints
  };
  std::shared_ptr<const MotionModel> model;
  Eigen::VectorXd x0;          ///< nx, the present state
  Eigen::VectorXd u_previous;  ///< nu, the input in force
  int N = 20;                  ///< stages of the horizon
  double dt = 0.25;            ///< [s]
  int M = 10;                  ///< knots, 1 <= M <= N (move blocking)
  std::vector<WeightedTerm> terms;
  /// Its slow zones are kept by admissible_inputs(), not by a term; null: none.
  std::shared_ptr<const ZoneMap> zones{};
};

/// What is to be evaluated; each includes what the ones before it give, but kResiduals not kStages.
/// A score is a value for comparing candidates: the constraints are exact, the cost is within
/// Evaluation::cost_error, and terms that can are computed in single precision, at about half the
/// time.
enum class Evaluate { kScore, kValue, kGradient, kStages, kResiduals };

using ResidualJacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// A trajectory and its derivatives stage by stage, for methods that use that structure. The states
/// X are those of the inputs (Problem::evaluate) or some of one's own, which do not follow the
/// dynamics (Problem::evaluate_states). To first order, a change dz of the variables moves them by
///
///   dx_k = S_k dz + e_k,   S_{k+1} = A_k S_k + B_k du_k/dz,   S_0 = 0,
///                          e_{k+1} = A_k e_k + f(x_k, u_k) - x_{k+1},   e_0 = 0:
///
/// e_k is what it takes to follow the dynamics. It is zero where the states are those of the
/// inputs.
struct StageDerivatives {
  Eigen::MatrixXd states;  ///< X, nx x (N+1)
  /// Derivatives of the cost by x_k, nx x (N+1); without the terms of input_hessian.
  Eigen::MatrixXd state_gradient;
  std::vector<Eigen::MatrixXd> sensitivity;  ///< S_k, by node: nx x n
  Eigen::MatrixXd drift;                     ///< e_k, nx x (N+1)
  double gap = 0.0;                          ///< largest |f(x_k, u_k) - x_{k+1}|, in their units
  Eigen::VectorXd constraint_drift;          ///< m: change of the constraints by e alone
  /// J^T J of the residuals of all costs whose residuals depend on inputs alone, n x n: their whole
  /// Hessian where these are linear.
  Eigen::MatrixXd input_hessian;
};

/// Result of an evaluation. Shapes: B candidates, n variables, m constraints.
struct Evaluation {
  Eigen::ArrayXd cost;  ///< B; finite; kRejectedCost where not valid
  /// B; with kScore: bound of the difference between this cost and that of kValue,
  /// kScoreError sum_t |w_t| max(1, |T_t|) over the terms that have scores; else 0.
  Eigen::ArrayXd cost_error;
  /// Value of each term, by ProblemDefinition::terms, not weighted: T x B; 0 of constraints.
  Eigen::ArrayXXd terms;
  Eigen::MatrixXd constraints;                  ///< m x B; >= 0 is feasible
  Eigen::Array<bool, Eigen::Dynamic, 1> valid;  ///< B; false: some term was not evaluable there
  Eigen::VectorXd gradient;                     ///< n; with kGradient (B = 1)
  Eigen::MatrixXd jacobian;  ///< m x n, dense, zero outside the pattern; with kGradient
  StageDerivatives stages;   ///< with kStages
  /// With kResiduals: cost = residual_offset + 1/2 |residuals|^2, to rounding; the cost itself has
  /// the same bits whatever is evaluated. gradient = residual_jacobian^T residuals.
  double residual_offset = 0.0;
  Eigen::VectorXd residuals;
  ResidualJacobian residual_jacobian;
};

/// max_r max(0, -c_r) of one column of constraint values; 0 for none.
double violation(const Eigen::Ref<const Eigen::VectorXd>& constraints);

/// Scratch of one evaluating thread. Made by Problem::make_workspace(); usable only with that
/// problem. Two threads with two workspaces may evaluate one problem at once.
class Workspace {
 public:
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

 private:
  friend class Problem;
  Workspace();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The planning problem: one receding-horizon optimisation, const while it is solved.
///
///   min_z  sum_t w_t T_t(x, u)    s.t.  c(x, u) >= 0,   lower <= z <= upper,
///   x_{k+1} = f(x_k, u_k),   u_k = z[knot(k)]
///
/// z stacks the inputs at M <= N knots (z = [u at knot 0; u at knot 1; ...], n = M nu); stage k
/// uses knot floor(k M / N): single shooting with move blocking, so the dynamics always hold
/// exactly.
///
/// The gradient is one adjoint sweep, lambda_k = dJ/dx_k + A_k^T lambda_{k+1},
/// dJ/du_k = dJ_direct/du_k + B_k^T lambda_{k+1}. The Jacobian of the constraints uses forward
/// sensitivities S_k = dx_k/dz, and so does that of the residuals (ResidualForm, scaled by
/// sqrt(|w_t|)); a residual that stands for a whole term has an adjoint sweep of its own. Terms of
/// weight 0 have no residuals.
///
/// Thread-safety: all methods const; concurrent calls need separate workspaces.
/// Source: formulation, section 7.
class Problem {
 public:
  /// Throws std::invalid_argument naming the entry, its value and what was expected.
  explicit Problem(ProblemDefinition definition);

  int num_variables() const { return static_cast<int>(lower_.size()); }
  int num_constraints() const { return num_constraints_; }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  const ProblemDefinition& definition() const { return definition_; }
  const Horizon& horizon() const { return horizon_; }
  int knot(int stage) const { return stage * definition_.M / definition_.N; }
  /// Whether d c_row / d z_column can be nonzero, m x n.
  const Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic>& jacobian_pattern() const {
    return pattern_;
  }
  /// The roughest smoothness among the terms, and whether all have gradients.
  Smoothness smoothness() const { return smoothness_; }
  bool has_gradient() const { return has_gradient_; }
  /// Whether some term has scores; else kScore is kValue.
  bool has_scores() const { return has_scores_; }
  /// The quoted names of the costs that have no residual form for the sign of their weight,
  /// separated by commas; empty: kResiduals can be asked for.
  std::string terms_without_residuals() const;

  Workspace make_workspace() const;

  /// Evaluates the columns of X (n x B). Beyond kValue, B must be 1. A column has the same bits
  /// alone and in any batch, for what is asked. Never writes a non-finite number; returns false if
  /// any candidate was not evaluable (see Evaluation::valid). Does not allocate after the first
  /// call with a workspace and batch size. Points outside the bounds are evaluated as they are.
  /// Passes on exceptions of terms.
  bool evaluate(const Eigen::Ref<const Eigen::MatrixXd>& X, Evaluate what, Workspace& workspace,
                Evaluation& out) const;

  /// Evaluates kStages at inputs z and states of one's own (nx x (N+1), column 0 is x0). Gradient
  /// and Jacobian are those of dx_k = S_k dz: see StageDerivatives. As evaluate() otherwise.
  bool evaluate_states(const Eigen::Ref<const Eigen::VectorXd>& z,
                       const Eigen::Ref<const Eigen::MatrixXd>& states, Workspace& workspace,
                       Evaluation& out) const;

  /// Every term raw and weighted, at one point (allocates; for reports).
  Explanation explain(const Eigen::Ref<const Eigen::VectorXd>& z) const;

  /// The trajectory of one point.
  TrajectoryBatch rollout(const Eigen::Ref<const Eigen::VectorXd>& z) const;

  /// Knot inputs from stage inputs (N x nu rows): the mean over each knot's stages, clamped into
  /// the bounds.
  Eigen::VectorXd knots_from_inputs(const Eigen::Ref<const Eigen::MatrixXd>& inputs) const;

  /// Finite stand-in for the cost of a candidate that could not be evaluated.
  static constexpr double kRejectedCost = 1e20;

 private:
  using RowRef = Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;
  using GradientRef = Eigen::Ref<const Eigen::VectorXd, 0, Eigen::InnerStride<>>;
  void set_inputs(const Eigen::Ref<const Eigen::MatrixXd>& X, TrajectoryBatch& t) const;
  void roll(const Eigen::Ref<const Eigen::MatrixXd>& X, TrajectoryBatch& t) const;
  /// Evaluates the trajectories of the workspace's batch of that size.
  bool evaluate_trajectories(int B, Evaluate what, Workspace& workspace, Evaluation& out) const;
  void prepare_stages(Workspace& workspace) const;
  /// Fills in what is of the dynamics; the rest is zero then.
  void begin_stages(const TrajectoryBatch& t, Workspace& workspace, StageDerivatives& stages) const;
  /// Evaluates a cost of StageDerivatives::input_hessian by its residuals r and their Jacobian J:
  /// adds J^T r to the gradient by inputs and J^T J to the Hessian.
  void evaluate_input_term(std::size_t term, const TrajectoryBatch& t, TermOutput& o,
                           Workspace& workspace, Eigen::MatrixXd& hessian) const;
  void linearise(const TrajectoryBatch& t, bool sensitivities, Workspace& workspace) const;
  /// Adds the derivative by z of what depends through `block` on x or u to `row` (1 x n).
  void chain(const JacobianBlock& block, const Eigen::Ref<const Eigen::VectorXd>& derivative,
             const Workspace& workspace, RowRef row) const;
  /// Adds the gradient by z of what has these derivatives by states and inputs: the adjoint sweep.
  void pull_back(const GradientRef& state_gradient, const GradientRef& input_gradient,
                 Workspace& workspace, Eigen::Ref<Eigen::VectorXd> gradient) const;
  void prepare_residuals(Workspace& workspace) const;
  /// Evaluates a cost and writes its rows of the residuals.
  void evaluate_residuals(std::size_t term, const TrajectoryBatch& t, TermOutput& o,
                          Workspace& workspace, Evaluation& out) const;

  ProblemDefinition definition_;
  Horizon horizon_;
  Eigen::VectorXd lower_, upper_;
  int num_constraints_ = 0;
  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> pattern_;
  struct TermLayout {
    bool constraint;
    bool scores;
    int rows;
    std::vector<JacobianBlock> blocks;
  };
  std::vector<TermLayout> layouts_;  // by term
  Smoothness smoothness_ = Smoothness::kSmooth;
  bool has_gradient_ = true;
  bool has_scores_ = false;
};

}  // namespace prospect
