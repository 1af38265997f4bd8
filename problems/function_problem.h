// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/problem/problem.h"
#include "problems/stated_programme.h"

namespace prospect {

/// f(u) = offset + 1/2 |r(u)|^2; without rows only a lower bound, offset, of f.
struct FunctionResiduals {
  double offset = 0.0;
  int rows = 0;
  std::function<Eigen::VectorXd(const Eigen::VectorXd& u)> r = {};  ///< rows
  std::function<Eigen::MatrixXd(const Eigen::VectorXd& u)> J = {};  ///< rows x n
};

/// Cost f(u) of the inputs of the first stage. Without a gradient, back ends with derivatives
/// refuse the problem; without residuals, those that minimise sums of squares.
class FunctionCost final : public Term {
 public:
  using Value = std::function<double(const Eigen::VectorXd& u)>;
  using Gradient = std::function<Eigen::VectorXd(const Eigen::VectorXd& u)>;
  FunctionCost(Value value, Gradient gradient, Smoothness smoothness = Smoothness::kSmooth,
               std::optional<FunctionResiduals> residuals = std::nullopt)
      : value_(std::move(value)),
        gradient_(std::move(gradient)),
        smoothness_(smoothness),
        residuals_(std::move(residuals)) {}
  std::string_view name() const override { return "function"; }
  TermTraits traits() const override;
  std::optional<ResidualForm> residual_form(const Horizon& horizon, int sign) const override;
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override;

 private:
  Value value_;
  Gradient gradient_;
  Smoothness smoothness_;
  std::optional<FunctionResiduals> residuals_;
};

/// Constraints c(u) >= 0 of the inputs of the first stage, with a dense Jacobian (rows x n).
class FunctionConstraint final : public Term {
 public:
  using Value = std::function<Eigen::VectorXd(const Eigen::VectorXd& u)>;
  using Jacobian = std::function<Eigen::MatrixXd(const Eigen::VectorXd& u)>;
  FunctionConstraint(int rows, Value value, Jacobian jacobian)
      : rows_(rows), value_(std::move(value)), jacobian_(std::move(jacobian)) {}
  std::string_view name() const override { return "constraint function"; }
  TermTraits traits() const override;
  int rows(const Horizon&) const override { return rows_; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon&) const override;
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override;

 private:
  int rows_;
  Value value_;
  Jacobian jacobian_;
};

/// A plain nonlinear programme, min f(u) subject to c(u) >= 0 and finite bounds, with its known
/// optimum: what is left of a planning problem with one stage and a model whose state stands still.
struct FunctionProblem {
  std::string name;
  Eigen::VectorXd lower, upper, start;  ///< n; the start may lie outside the bounds
  FunctionCost::Value f = {};
  FunctionCost::Gradient g = {};
  std::optional<FunctionResiduals> residuals = std::nullopt;
  int rows = 0;  ///< of c
  FunctionConstraint::Value c = {};
  FunctionConstraint::Jacobian J = {};
  double optimum = 0.0;         ///< f at the global solution
  bool several_basins = false;  ///< local methods may end in another minimum
  /// f, and the rows of c, as expressions.
  std::string objective{};
  std::vector<std::string> constraints{};

  /// N = M = 1, so that z = u.
  Problem problem() const;
  StatedProgramme stated() const;
  double violation(const Eigen::VectorXd& u) const {
    return rows == 0 ? 0.0 : prospect::violation(c(u));
  }
};

/// The numbers as a vector.
Eigen::VectorXd vec(std::initializer_list<double> values);

}  // namespace prospect
