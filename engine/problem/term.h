// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/problem/trajectory.h"

namespace prospect {

/// How smooth a term is in (x, u). Solvers that need gradients refuse a discontinuous problem.
enum class Smoothness { kSmooth, kC1, kC0, kDiscontinuous };

enum class TermKind {
  kCost,       ///< one value a candidate, weighted and summed into the objective
  kConstraint  ///< rows() values a candidate, feasible where all are >= 0
};

/// What a term's raw value measures, for whoever looks for a quantity and not for a name.
enum class TermQuantity {
  kOther,
  kClearance  ///< the smallest distance from the robot to an obstacle, above d_safe
};

struct TermTraits {
  TermKind kind = TermKind::kCost;
  Smoothness smoothness = Smoothness::kSmooth;
  bool has_gradient = true;
  std::string unit;           ///< of the raw value, e.g. "m^2", "-"
  std::string normalisation;  ///< what makes it O(1), e.g. "mean over stages"
  bool scores = false;        ///< costs: makes use of TermRequest::score
  TermQuantity quantity = TermQuantity::kOther;
};

/// Scratch that a term needs to evaluate without allocating. Owned by a Workspace; a term is const.
class TermScratch {
 public:
  virtual ~TermScratch() = default;
};

struct TermRequest {
  bool gradient = false;  ///< only ever set for batches of one
  /// +1 or -1: the residuals of that sign and their Jacobian too. Only ever set for batches of one,
  /// without `gradient`, and for a cost whose residual_form() of that sign has rows.
  int residuals = 0;
  /// Costs only, without the others: the value is for comparing candidates and may be off by up to
  /// kScoreError max(1, |value|), for instance computed in single precision. Terms whose traits
  /// say nothing of scores ignore it.
  bool score = false;
};

/// Bound of the error of a score, relative to a value above 1, absolute below.
inline constexpr double kScoreError = 1e-5;

/// Where a term writes.
///   Cost:        value (1 x B). With request.gradient, *adds* d value/d x_k into state_gradient
///                (((N+1) nx) x B, zeroed before the call) and d value/d u_k into input_gradient
///                ((N nu) x B, zeroed).
///   Constraint:  value (rows x B). With request.gradient, writes jacobian.col(n).head(nx or nu)
///   for
///                the n-th block of jacobian_pattern().
///   Residuals:   value as ever, residuals (rows of the residual form) and their Jacobian as that
///                of a constraint.
struct TermOutput {
  BatchArray value;
  BatchArray state_gradient;
  BatchArray input_gradient;
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd residuals;

  /// Adds a gradient with respect to the pose (x, y, z, yaw) at stage k to state_gradient.
  void add_pose_gradient(const TrajectoryBatch& t, int k, int b, double gx, double gy, double gz,
                         double gyaw) {
    const int row = k * t.horizon.nx();
    state_gradient(row + t.layout.px, b) += gx;
    state_gradient(row + t.layout.py, b) += gy;
    if (t.layout.pz >= 0) state_gradient(row + t.layout.pz, b) += gz;
    state_gradient(row + t.layout.yaw, b) += gyaw;
  }

  /// Writes the derivative of a row with respect to a pose as a block of the Jacobian.
  void set_pose_block(const TrajectoryBatch& t, Eigen::Index block, double gx, double gy, double gz,
                      double gyaw) {
    auto column = jacobian.col(block);
    column.setZero();
    column[t.layout.px] = gx;
    column[t.layout.py] = gy;
    if (t.layout.pz >= 0) column[t.layout.pz] = gz;
    column[t.layout.yaw] = gyaw;
  }
};

/// One nonzero block of the Jacobian of a constraint or of residuals: row `row` depends on x_stage
/// or u_stage.
struct JacobianBlock {
  int row = 0;
  int stage = 0;
  bool input = false;  ///< false: d/dx_stage (nx entries), true: d/du_stage (nu entries)
};

/// A cost T as a sum of squares, for back ends that minimise those:
///
///   sign T(x, u) = offset + 1/2 sum_{r < rows} r_r(x, u)^2,     sign = +1 or -1
///
/// for every trajectory, to rounding, so that what such a back end minimises is the cost of the
/// problem. A reward has a negative weight there, hence the sign. Without rows the form says only
/// that `offset` is a lower bound of sign T; the Problem then makes one residual of the whole,
/// r = sqrt(2 (sign T - offset)), from value and gradient. The more of T's structure is in the
/// rows, the more of its curvature is in the product of their Jacobians.
struct ResidualForm {
  double offset = 0.0;
  int rows = 0;
  std::vector<JacobianBlock> pattern;  ///< nonzero blocks of d r, of rows 0..rows-1
};

/// A residual for a part t >= 0 of a cost: 1/2 r^2 = t, and dr = slope dt. The floor, far below
/// what counts in a cost, keeps the slope finite where t vanishes with its derivative.
struct RootResidual {
  static constexpr double kFloor = 1e-14;
  explicit RootResidual(double t) : value(std::sqrt(2.0 * (t + kFloor))), slope(1.0 / value) {}
  double value, slope;
};

/// One cost or constraint over a batch of trajectories.
///
/// A user adds a term by deriving from this class in a file of their own and putting it into a
/// Problem; see docs/examples. evaluate() is const and may be called from several threads with
/// different scratch. It writes finite numbers, or a non-finite value for a candidate it cannot
/// evaluate (the Problem then rejects that candidate); it does not allocate after its first call
/// with a given scratch and batch size. What several terms need alike they may keep in the
/// evaluation's SharedResults. An exception thrown from it ends the solve with an error.
class Term {
 public:
  virtual ~Term() = default;

  virtual std::string_view name() const = 0;
  virtual TermTraits traits() const = 0;

  /// Rows of a constraint; 1 for a cost.
  virtual int rows(const Horizon&) const { return 1; }
  /// Constraints only: the nonzero blocks, fixed for a horizon.
  virtual std::vector<JacobianBlock> jacobian_pattern(const Horizon&) const { return {}; }
  /// Costs only: sign T as a sum of squares, fixed for a horizon; none: it has no such form.
  virtual std::optional<ResidualForm> residual_form(const Horizon&, int /*sign*/) const {
    return std::nullopt;
  }
  /// Scratch for batches of up to max_batch; null if none is needed.
  virtual std::unique_ptr<TermScratch> make_scratch(const Horizon&, int /*max_batch*/) const {
    return nullptr;
  }

  virtual void evaluate(const TrajectoryBatch& trajectories, const TermRequest& request,
                        TermScratch* scratch, TermOutput& out) const = 0;
};

}  // namespace prospect
