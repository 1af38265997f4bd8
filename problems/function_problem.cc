// SPDX-License-Identifier: Apache-2.0
#include "problems/function_problem.h"

#include <limits>
#include <memory>

namespace prospect {
namespace {

using Vector = Eigen::VectorXd;
using Matrix = Eigen::MatrixXd;

/// A model whose state stands still: a problem with N = 1 is then a plain nonlinear programme in u.
class StillModel final : public MotionModel {
 public:
  StillModel(const Vector& lower, const Vector& upper)
      : limits_{lower, upper,
                Vector::Constant(lower.size(), std::numeric_limits<double>::infinity())} {}
  std::string_view name() const override { return "still"; }
  int nx() const override { return 3; }
  int nu() const override { return static_cast<int>(limits_.lower.size()); }
  void step(const Eigen::Ref<const Vector>& x, const Eigen::Ref<const Vector>&, double,
            Eigen::Ref<Vector> next) const override {
    next = x;
  }
  void jacobians(const Eigen::Ref<const Vector>&, const Eigen::Ref<const Vector>&, double,
                 Eigen::Ref<Matrix> A, Eigen::Ref<Matrix> B) const override {
    A.setIdentity();
    B.setZero();
  }
  void step_batch(const Eigen::Ref<const BatchArray>& x, const Eigen::Ref<const BatchArray>&,
                  double, Eigen::Ref<BatchArray> next) const override {
    next = x;
  }
  const InputLimits& limits() const override { return limits_; }
  PoseLayout pose_layout() const override { return {}; }
  Twist twist(const Eigen::Ref<const Vector>&, const Eigen::Ref<const Vector>&) const override {
    return {};
  }
  Vector state(const Pose&, const Twist&) const override { return Vector::Zero(3); }
  Vector input(const Twist&) const override { return Vector::Zero(nu()); }
  Vector braking_input(const Eigen::Ref<const Vector>&, const Eigen::Ref<const Vector>&,
                       double) const override {
    return Vector::Zero(nu());
  }
  double squared_speed(const Eigen::Ref<const Vector>&, const Eigen::Ref<const Vector>&, Vector*,
                       Vector*) const override {
    return 0.0;
  }
  double max_speed() const override { return 1.0; }
  double max_yaw_rate() const override { return 1.0; }
  double max_deceleration() const override { return 1.0; }

 private:
  InputLimits limits_;
};

}  // namespace

TermTraits FunctionCost::traits() const {
  return {TermKind::kCost, smoothness_, static_cast<bool>(gradient_), "-", "none"};
}

std::optional<ResidualForm> FunctionCost::residual_form(const Horizon&, int sign) const {
  if (sign < 0 || !residuals_) return std::nullopt;
  ResidualForm form{residuals_->offset, residuals_->rows, {}};
  for (int r = 0; r < form.rows; ++r) form.pattern.push_back({r, 0, true});
  return form;
}

void FunctionCost::evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                            TermOutput& out) const {
  for (int b = 0; b < t.batch(); ++b) {
    const Vector u = t.inputs.col(b).matrix();
    out.value(0, b) = value_(u);
    if (request.gradient) out.input_gradient.col(b) += gradient_(u).array();
    if (request.residuals == 0) continue;
    out.residuals = residuals_->r(u);
    out.jacobian.topRows(u.size()) = residuals_->J(u).transpose();
  }
}

TermTraits FunctionConstraint::traits() const {
  return {TermKind::kConstraint, Smoothness::kSmooth, true, "-", "none"};
}

std::vector<JacobianBlock> FunctionConstraint::jacobian_pattern(const Horizon&) const {
  std::vector<JacobianBlock> blocks;
  for (int r = 0; r < rows_; ++r) blocks.push_back({r, 0, true});
  return blocks;
}

void FunctionConstraint::evaluate(const TrajectoryBatch& t, const TermRequest& request,
                                  TermScratch*, TermOutput& out) const {
  for (int b = 0; b < t.batch(); ++b) {
    const Vector u = t.inputs.col(b).matrix();
    out.value.col(b) = value_(u).array();
    if (!request.gradient) continue;
    const Matrix J = jacobian_(u);
    for (int r = 0; r < rows_; ++r) out.jacobian.col(r).head(u.size()) = J.row(r).transpose();
  }
}

Problem FunctionProblem::problem() const {
  ProblemDefinition d;
  d.model = std::make_shared<StillModel>(lower, upper);
  d.x0 = Vector::Zero(3);
  d.u_previous = Vector::Zero(lower.size());
  d.N = d.M = 1;
  d.dt = 1.0;
  d.terms.push_back({std::make_shared<FunctionCost>(f, g, Smoothness::kSmooth, residuals), 1.0});
  if (rows > 0) d.terms.push_back({std::make_shared<FunctionConstraint>(rows, c, J), 1.0});
  return Problem(d);
}

StatedProgramme FunctionProblem::stated() const {
  const int n = static_cast<int>(lower.size());
  StatedProgramme stated{name, start, lower, upper, Expression(objective, n), {}, optimum};
  for (const std::string& row : constraints) {
    stated.rows.push_back({Expression(row, n), 0.0, std::numeric_limits<double>::infinity()});
  }
  return stated;
}

Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) v[i++] = value;
  return v;
}

}  // namespace prospect
