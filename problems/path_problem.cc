// SPDX-License-Identifier: Apache-2.0
#include "problems/path_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "models/sinc.h"
#include "models/unicycle.h"
#include "problems/expression_builder.h"

namespace prospect {
namespace {

/// Mean squared distance of the positions to a path [m^2], and the distance to a disc as a hard
/// constraint [m].
class FollowPath final : public Term {
 public:
  explicit FollowPath(Eigen::Matrix2Xd path) : path_(std::move(path)) {}
  std::string_view name() const override { return "follow path"; }
  TermTraits traits() const override {
    return {TermKind::kCost, Smoothness::kSmooth, true, "m^2", "mean over stages"};
  }
  std::optional<ResidualForm> residual_form(const Horizon& h, int sign) const override {
    if (sign < 0) return std::nullopt;
    ResidualForm form{0.0, 2 * h.N, {}};
    for (int row = 0; row < form.rows; ++row) form.pattern.push_back({row, row / 2 + 1, false});
    return form;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    const int N = t.horizon.N;
    const double root = std::sqrt(2.0 / N);
    for (int b = 0; b < t.batch(); ++b) {
      double sum = 0.0;
      for (int k = 1; k <= N; ++k) {
        const double dx = t.px(k, b) - path_(0, k), dy = t.py(k, b) - path_(1, k);
        sum += (dx * dx + dy * dy) / N;
        if (request.gradient) out.add_pose_gradient(t, k, b, 2 * dx / N, 2 * dy / N, 0, 0);
        if (request.residuals == 0) continue;
        const int row = 2 * (k - 1);
        out.residuals.segment<2>(row) << root * dx, root * dy;
        out.set_pose_block(t, row, root, 0, 0, 0);
        out.set_pose_block(t, row + 1, 0, root, 0, 0);
      }
      out.value(0, b) = sum;
    }
  }

 private:
  Eigen::Matrix2Xd path_;
};

class OutsideDisc final : public Term {
 public:
  OutsideDisc(Eigen::Vector2d centre, double radius) : centre_(centre), radius_(radius) {}
  std::string_view name() const override { return "outside disc"; }
  TermTraits traits() const override {
    return {TermKind::kConstraint, Smoothness::kSmooth, true, "m", "none"};
  }
  int rows(const Horizon& h) const override { return h.N; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon& h) const override {
    std::vector<JacobianBlock> blocks;
    for (int k = 0; k < h.N; ++k) blocks.push_back({k, k + 1, false});
    return blocks;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      for (int k = 0; k < t.horizon.N; ++k) {
        const Eigen::Vector2d r(t.px(k + 1, b) - centre_.x(), t.py(k + 1, b) - centre_.y());
        const double distance = std::sqrt(r.squaredNorm() + 1e-12);
        out.value(k, b) = distance - radius_;
        if (request.gradient) {
          out.jacobian.col(k).setZero();
          out.jacobian.col(k).head<2>() = r / distance;
        }
      }
    }
  }

 private:
  Eigen::Vector2d centre_;
  double radius_;
};

using Formula = ExpressionBuilder::Formula;

/// sinc of models/sinc.h: its series near 0.
Formula stated_sinc(ExpressionBuilder& e, Formula x) {
  using enum Expression::Operation;
  const Formula z = x * x;
  Formula series = e.number(1.0);
  for (const double divisor : {210.0, 156.0, 110.0, 72.0, 42.0, 20.0, 6.0}) {
    series = 1.0 - z / divisor * series;
  }
  const Formula near = e.of(kAbs, x) < kSincSeriesRadius;
  // Nothing is divided by 0 on the side that does not count either.
  const Formula apart = e.choose(near, e.number(1.0), x);
  return e.choose(near, series, e.of(kSin, apart) / apart);
}

StatedProgramme stated_path(const Problem& problem, const Eigen::Matrix2Xd& path,
                            const Eigen::Vector2d& centre, double radius, int discs) {
  using enum Expression::Operation;
  const ProblemDefinition& d = problem.definition();
  const int n = problem.num_variables();
  ExpressionBuilder e(n);
  Formula px = e.number(0.0), py = e.number(0.0), theta = e.number(0.0);
  std::vector<Formula> cost, outside;
  for (int k = 0; k < d.N; ++k) {
    const int m = problem.knot(k);
    const Formula phi = 0.5 * d.dt * e.x(2 * m + 1);
    const Formula chord = e.x(2 * m) * d.dt * stated_sinc(e, phi);
    px = px + chord * e.of(kCos, theta + phi);
    py = py + chord * e.of(kSin, theta + phi);
    theta = theta + d.dt * e.x(2 * m + 1);
    const Formula dx = px - path(0, k + 1), dy = py - path(1, k + 1);
    cost.push_back((dx * dx + dy * dy) / d.N);
    const Formula rx = px - centre.x(), ry = py - centre.y();
    outside.push_back(e.of(kSqrt, rx * rx + ry * ry + 1e-12) - radius);
  }
  StatedProgramme stated{"path past a disc",
                         Eigen::VectorXd::Zero(n),
                         problem.lower(),
                         problem.upper(),
                         e.finish(e.sum(cost)),
                         {},
                         0.0};
  for (int i = 0; i < discs; ++i) {
    for (const Formula& row : outside) {
      stated.rows.push_back({e.finish(row), 0.0, std::numeric_limits<double>::infinity()});
    }
  }
  return stated;
}

}  // namespace

PathProblem path_problem(int discs) {
  ProblemDefinition d;
  d.model = std::make_shared<Unicycle>(Unicycle::Parameters{});
  d.x0 = Eigen::Vector3d::Zero();
  d.u_previous = Eigen::Vector2d(0.3, 0.0);
  d.N = 20;
  d.M = 10;
  d.dt = 0.25;
  Eigen::VectorXd z(20);
  for (int m = 0; m < 10; ++m) {
    z[2 * m] = 0.3 + 0.1 * std::sin(0.5 * m);
    z[2 * m + 1] = 0.4 * std::sin(0.6 * m);
  }
  const TrajectoryBatch t = Problem(d).rollout(z);
  Eigen::Matrix2Xd path(2, d.N + 1);
  for (int k = 0; k <= d.N; ++k) path.col(k) << t.px(k, 0), t.py(k, 0);
  // A disc beside the middle of the path, which it clears by 5 cm.
  Eigen::Vector2d centre = path.col(10) + Eigen::Vector2d(0.1, -0.3);
  double clearance = std::numeric_limits<double>::infinity();
  for (int k = 1; k <= d.N; ++k) clearance = std::min(clearance, (path.col(k) - centre).norm());
  d.terms.push_back({std::make_shared<FollowPath>(path), 1.0});
  for (int i = 0; i < discs; ++i) {
    d.terms.push_back({std::make_shared<OutsideDisc>(centre, clearance - 0.05), 1.0});
  }
  Problem problem(d);
  StatedProgramme stated = stated_path(problem, path, centre, clearance - 0.05, discs);
  return {std::move(problem), z, std::move(stated)};
}

}  // namespace prospect
