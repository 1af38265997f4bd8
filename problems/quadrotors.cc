// SPDX-License-Identifier: Apache-2.0
#include "problems/quadrotors.h"

#include <cmath>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "problems/euler_quadrotors.h"

namespace prospect {
namespace {

constexpr int kStages = 29;
constexpr double kStep = 0.1;  // [s]
constexpr int kStates = EulerQuadrotors::kStates;

/// sum_{k=0..N} sum_i w_i (x_k[i] - r_k[i])^2.
class Tracking final : public Term {
 public:
  /// weights: nx; reference: nx x (N+1).
  Tracking(Eigen::VectorXd weights, Eigen::MatrixXd reference)
      : weights_(std::move(weights)), reference_(std::move(reference)) {
    for (int i = 0; i < weights_.size(); ++i) {
      if (weights_[i] > 0.0) counted_.push_back(i);
    }
  }
  std::string_view name() const override { return "tracking"; }
  TermTraits traits() const override { return {.unit = "-", .normalisation = "sum over stages"}; }
  std::optional<ResidualForm> residual_form(const Horizon& h, int sign) const override {
    if (sign < 0) return std::nullopt;
    const int each = static_cast<int>(counted_.size());
    ResidualForm form{0.0, (h.N + 1) * each, {}};
    for (int row = 0; row < form.rows; ++row) form.pattern.push_back({row, row / each, false});
    return form;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    const int nx = t.horizon.nx();
    for (int b = 0; b < t.batch(); ++b) {
      double sum = 0.0;
      Eigen::Index row = 0;
      for (int k = 0; k <= t.horizon.N; ++k) {
        for (const int i : counted_) {
          const double off = t.x(k, i, b) - reference_(i, k);
          sum += weights_[i] * off * off;
          if (request.gradient) out.state_gradient(k * nx + i, b) += 2.0 * weights_[i] * off;
          if (request.residuals != 0) {
            const double root = std::sqrt(2.0 * weights_[i]);
            out.residuals[row] = root * off;
            out.jacobian.col(row).setZero();
            out.jacobian(i, row++) = root;
          }
        }
      }
      out.value(0, b) = sum;
    }
  }

 private:
  Eigen::VectorXd weights_;
  Eigen::MatrixXd reference_;
  std::vector<int> counted_;
};

/// Rows of one state each, from stage 1 on: the one of stage 0 is given.
class StateConstraint : public Term {
 public:
  explicit StateConstraint(int last) : last_(last) {}
  TermTraits traits() const final {
    return {TermKind::kConstraint, Smoothness::kSmooth, true, "-", "none"};
  }
  int rows(const Horizon&) const final { return last_ * rows_a_stage(); }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon&) const final {
    std::vector<JacobianBlock> blocks;
    const int each = rows_a_stage();
    for (int row = 0; row < last_ * each; ++row) blocks.push_back({row, row / each + 1, false});
    return blocks;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const final {
    const int each = rows_a_stage();
    if (request.gradient) out.jacobian.leftCols(last_ * each).setZero();
    for (int b = 0; b < t.batch(); ++b) {
      for (int k = 1; k <= last_; ++k) {
        at(t, k, b, (k - 1) * each, request.gradient ? &out.jacobian : nullptr, out.value);
      }
    }
  }

 protected:
  virtual int rows_a_stage() const = 0;
  /// The rows of a stage from `row` on; by_state: their derivatives, a column each, zero before.
  virtual void at(const TrajectoryBatch& t, int k, int b, int row, Eigen::MatrixXd* by_state,
                  BatchArray& value) const = 0;

 private:
  const int last_;
};

/// lower_i <= x_k[i] <= upper_i of the entries that have such bounds.
class StateBounds final : public StateConstraint {
 public:
  struct Bound {
    int entry;
    double lower, upper;
  };
  explicit StateBounds(std::vector<Bound> bounds)
      : StateConstraint(kStages), bounds_(std::move(bounds)) {}
  std::string_view name() const override { return "state bounds"; }

 private:
  int rows_a_stage() const override { return 2 * static_cast<int>(bounds_.size()); }
  void at(const TrajectoryBatch& t, int k, int b, int row, Eigen::MatrixXd* by_state,
          BatchArray& value) const override {
    for (const Bound& bound : bounds_) {
      const double x = t.x(k, bound.entry, b);
      value(row, b) = x - bound.lower;
      value(row + 1, b) = bound.upper - x;
      if (by_state) {
        (*by_state)(bound.entry, row) = 1.0;
        (*by_state)(bound.entry, row + 1) = -1.0;
      }
      row += 2;
    }
  }
  std::vector<Bound> bounds_;
};

/// (x - cx)^2 + (y - cy)^2 >= r^2 of cylinders that may move and grow: centre and squared radius by
/// stage, 3 x (last+1) each.
class OutsideCylinders final : public StateConstraint {
 public:
  OutsideCylinders(int last, std::vector<Eigen::Matrix3Xd> cylinders)
      : StateConstraint(last), cylinders_(std::move(cylinders)) {}
  std::string_view name() const override { return "outside cylinders"; }

 private:
  int rows_a_stage() const override { return static_cast<int>(cylinders_.size()); }
  void at(const TrajectoryBatch& t, int k, int b, int row, Eigen::MatrixXd* by_state,
          BatchArray& value) const override {
    for (const Eigen::Matrix3Xd& cylinder : cylinders_) {
      const double dx = t.x(k, 0, b) - cylinder(0, k), dy = t.x(k, 1, b) - cylinder(1, k);
      value(row, b) = dx * dx + dy * dy - cylinder(2, k);
      if (by_state) by_state->col(row).head<2>() << 2.0 * dx, 2.0 * dy;
      ++row;
    }
  }
  std::vector<Eigen::Matrix3Xd> cylinders_;
};

/// 0.5 <= |q|^2 <= 1.5.
class QuaternionLength final : public StateConstraint {
 public:
  QuaternionLength() : StateConstraint(kStages) {}
  std::string_view name() const override { return "quaternion length"; }

 private:
  int rows_a_stage() const override { return 2; }
  void at(const TrajectoryBatch& t, int k, int b, int row, Eigen::MatrixXd* by_state,
          BatchArray& value) const override {
    const Eigen::Vector4d q = t.states.col(b).segment<4>(k * t.horizon.nx() + 3).matrix();
    value(row, b) = q.squaredNorm() - 0.5;
    value(row + 1, b) = 1.5 - q.squaredNorm();
    if (by_state) {
      by_state->col(row).segment<4>(3) = 2.0 * q;
      by_state->col(row + 1).segment<4>(3) = -2.0 * q;
    }
  }
};

/// |p_i - p_j|^2 >= 1 m^2 of each two quadrotors.
class Apart final : public StateConstraint {
 public:
  explicit Apart(int count) : StateConstraint(kStages - 1), count_(count) {}
  std::string_view name() const override { return "apart"; }

 private:
  int rows_a_stage() const override { return count_ * (count_ - 1) / 2; }
  void at(const TrajectoryBatch& t, int k, int b, int row, Eigen::MatrixXd* by_state,
          BatchArray& value) const override {
    const int first = k * t.horizon.nx();
    for (int i = 0; i < count_; ++i) {
      for (int j = i + 1; j < count_; ++j, ++row) {
        const Eigen::Vector3d way = (t.states.col(b).segment<3>(first + kStates * i) -
                                     t.states.col(b).segment<3>(first + kStates * j))
                                        .matrix();
        value(row, b) = way.squaredNorm() - 1.0;
        if (!by_state) continue;
        by_state->col(row).segment<3>(kStates * i) = 2.0 * way;
        by_state->col(row).segment<3>(kStates * j) = -2.0 * way;
      }
    }
  }
  int count_;
};

/// Of one quadrotor: position, velocity and rates, by entry.
Eigen::VectorXd weights(double velocity) {
  Eigen::VectorXd w = Eigen::VectorXd::Ones(kStates);
  w.segment<4>(3).setZero();
  w.segment<3>(7).setConstant(velocity);
  return w;
}

StateBounds bounds(int count, double beside, double above) {
  std::vector<StateBounds::Bound> all;
  for (int one = 0; one < count; ++one) {
    for (const int i : {0, 1, 2, 7, 8, 9, 10, 11, 12}) {
      const double bound = i < 2 ? beside : i == 2 ? above : 10.0;
      all.push_back({kStates * one + i, -bound, bound});
    }
  }
  return StateBounds(std::move(all));
}

ProblemDefinition definition(int count) {
  ProblemDefinition d;
  d.model = std::make_shared<EulerQuadrotors>(count);
  d.x0 = d.model->state(Pose{}, Twist{});
  d.u_previous = d.model->input(Twist{});
  d.N = d.M = kStages;
  d.dt = kStep;
  return d;
}

template <typename T>
void add(ProblemDefinition& d, T term) {
  d.terms.push_back({std::make_shared<T>(std::move(term)), 1.0});
}

/// Where a cylinder of quad_track_avoid is [m, m], and its squared radius [m^2], at a time [s].
struct Mover {
  double x, y, reach_x, reach_y, rate_x, rate_y, phase_x, phase_y;
  Eigen::Vector3d at(double t) const {
    return {x + reach_x * std::sin(rate_x * t + phase_x),
            y + reach_y * std::sin(rate_y * t + phase_y), 1.0};
  }
};
constexpr Mover kMovers[] = {{3.0, 3.0, 1.0, 0.5, 0.3, 0.5, 0.0, 0.0},
                             {-3.0, 2.0, 0.5, 1.0, 0.4, 0.3, 1.0, 0.5},
                             {0.0, -3.0, 0.8, 0.8, 0.5, 0.4, 0.5, 1.0}};

Eigen::Vector3d saddle(double s) {
  return {4.0 * std::cos(s), 4.0 * std::sin(s), 2.0 * std::cos(2.0 * s)};
}

}  // namespace

Problem quad_nav_circle(double angle) {
  ProblemDefinition d = definition(1);
  const double radius = std::sqrt(32.0);
  d.x0.head<2>() << radius * std::cos(angle), radius * std::sin(angle);
  add(d, Tracking(weights(1.0), Eigen::MatrixXd::Zero(kStates, kStages + 1)));
  add(d, bounds(1, 10.0, 10.0));
  const Eigen::Matrix3Xd standing =
      (Eigen::Matrix3Xd(3, 4) << 1.0, 1.0, 3.0, 3.0, 1.0, 3.0, 1.0, 3.0, 0.7, 0.7, 0.7, 0.95)
          .finished();  // by column: centre, radius with that of the quadrotor
  std::vector<Eigen::Matrix3Xd> cylinders;
  for (int i = 0; i < standing.cols(); ++i) {
    Eigen::Matrix3Xd cylinder = standing.col(i).replicate(1, kStages);
    for (int k = 0; k < kStages; ++k) {
      cylinder(2, k) = standing(2, i) * standing(2, i) * (1.0 + 0.1 * kStep * k);
    }
    cylinders.push_back(std::move(cylinder));
  }
  add(d, OutsideCylinders(kStages - 1, std::move(cylinders)));
  return Problem(std::move(d));
}

Problem quad_track_avoid(double speed, double place) {
  ProblemDefinition d = definition(1);
  d.x0.head<3>() = saddle(place);
  Eigen::MatrixXd reference = Eigen::MatrixXd::Zero(kStates, kStages + 1);
  std::vector<Eigen::Matrix3Xd> cylinders(std::size(kMovers), Eigen::Matrix3Xd(3, kStages + 1));
  for (int k = 0; k <= kStages; ++k) {
    const double t = kStep * k, s = place + speed * t;
    reference.col(k).head<3>() = saddle(s);
    reference.col(k).segment<3>(7) << -4.0 * std::sin(s), 4.0 * std::cos(s), -4.0 * std::sin(2 * s);
    reference.col(k).segment<3>(7) *= speed;
    for (std::size_t i = 0; i < cylinders.size(); ++i) cylinders[i].col(k) = kMovers[i].at(t);
  }
  add(d, Tracking(weights(1.0), std::move(reference)));
  add(d, bounds(1, 10.0, 10.0));
  add(d, QuaternionLength());
  add(d, OutsideCylinders(kStages, std::move(cylinders)));
  return Problem(std::move(d));
}

bool quad_track_begins_free(double place) {
  for (const Mover& mover : kMovers) {
    if ((saddle(place) - mover.at(0.0)).head<2>().norm() < 1.1) return false;
  }
  return true;
}

Problem quad_multi_swap(int count) {
  ProblemDefinition d = definition(count);
  constexpr double kRadius = 3.0;
  Eigen::VectorXd goal = Eigen::VectorXd::Zero(kStates * count);
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / count;
    d.x0.segment<2>(kStates * i) << kRadius * std::cos(angle), kRadius * std::sin(angle);
    goal.segment<2>(kStates * i) = -d.x0.segment<2>(kStates * i);
  }
  add(d, Tracking(weights(0.1).replicate(count, 1), goal.replicate(1, kStages + 1)));
  add(d, bounds(count, 5.0, 1.5));
  add(d, Apart(count));
  return Problem(std::move(d));
}

Eigen::VectorXd quad_hovering(const Problem& problem) {
  return Eigen::VectorXd::Constant(problem.num_variables(), EulerQuadrotors::hover());
}

}  // namespace prospect
