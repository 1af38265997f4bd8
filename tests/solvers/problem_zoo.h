#pragma once

#include <Eigen/Core>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/problem.h"
#include "models/unicycle.h"

namespace prospect::zoo {

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

/// What is watched, and what goes wrong, while a problem is evaluated. Counts columns, from 1.
struct Watch {
  /// Called at the start of every call of the cost term, before anything else.
  std::function<void()> on_call = {};
  bool record = false;
  int nan_at = 0;             ///< the evaluation that gives NaN, 0: none
  int throw_at = 0;           ///< the evaluation that throws, 0: none
  double seconds_a_call = 0;  ///< how long one call of the term takes, whatever its batch

  std::atomic<int> calls{0};
  std::atomic<int> evaluations{0};
  std::mutex mutex;
  std::vector<Vector> points;  ///< knot inputs as evaluated

  /// Called by the cost term for each candidate; returns whether the value is to be NaN.
  bool evaluated(const TrajectoryBatch& t, int b) {
    const int count = ++evaluations;
    if (record) {
      const std::lock_guard lock(mutex);
      points.push_back(t.inputs.col(b).matrix());
    }
    if (count == throw_at) throw std::runtime_error("injected fault");
    return count == nan_at;
  }
};

/// Cost f(u) of one stage.
class FunctionCost final : public Term {
 public:
  using Value = std::function<double(const Vector& u)>;
  using Gradient = std::function<Vector(const Vector& u)>;
  FunctionCost(Value value, Gradient gradient, std::shared_ptr<Watch> watch,
               Smoothness smoothness = Smoothness::kSmooth)
      : value_(std::move(value)),
        gradient_(std::move(gradient)),
        watch_(std::move(watch)),
        smoothness_(smoothness) {}
  std::string_view name() const override { return "function"; }
  TermTraits traits() const override {
    return {TermKind::kCost, smoothness_, static_cast<bool>(gradient_), "-", "none"};
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    ++watch_->calls;
    if (watch_->on_call) watch_->on_call();
    if (watch_->seconds_a_call > 0.0) {
      std::this_thread::sleep_for(std::chrono::duration<double>(watch_->seconds_a_call));
    }
    for (int b = 0; b < t.batch(); ++b) {
      const Vector u = t.inputs.col(b).matrix();
      const bool nan = watch_->evaluated(t, b);
      out.value(0, b) = nan ? std::numeric_limits<double>::quiet_NaN() : value_(u);
      if (request.gradient) out.input_gradient.col(b) += gradient_(u).array();
    }
  }

 private:
  Value value_;
  Gradient gradient_;
  std::shared_ptr<Watch> watch_;
  Smoothness smoothness_;
};

/// Constraints c(u) >= 0 of one stage, with a dense Jacobian.
class FunctionConstraint final : public Term {
 public:
  using Value = std::function<Vector(const Vector& u)>;
  using Jacobian = std::function<Matrix(const Vector& u)>;
  FunctionConstraint(int rows, Value value, Jacobian jacobian)
      : rows_(rows), value_(std::move(value)), jacobian_(std::move(jacobian)) {}
  std::string_view name() const override { return "constraint function"; }
  TermTraits traits() const override {
    return {TermKind::kConstraint, Smoothness::kSmooth, true, "-", "none"};
  }
  int rows(const Horizon&) const override { return rows_; }
  std::vector<JacobianBlock> jacobian_pattern(const Horizon&) const override {
    std::vector<JacobianBlock> blocks;
    for (int r = 0; r < rows_; ++r) blocks.push_back({r, 0, true});
    return blocks;
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    for (int b = 0; b < t.batch(); ++b) {
      const Vector u = t.inputs.col(b).matrix();
      out.value.col(b) = value_(u).array();
      if (!request.gradient) continue;
      const Matrix J = jacobian_(u);
      for (int r = 0; r < rows_; ++r) out.jacobian.col(r).head(u.size()) = J.row(r).transpose();
    }
  }

 private:
  int rows_;
  Value value_;
  Jacobian jacobian_;
};

/// One problem with a known solution.
struct Case {
  std::string name;
  Vector lower, upper, start;
  FunctionCost::Value f = {};
  FunctionCost::Gradient g = {};
  int rows = 0;
  FunctionConstraint::Value c = {};
  FunctionConstraint::Jacobian J = {};
  double optimum = 0.0;
  bool several_basins = false;  ///< local methods may end in another minimum

  Problem problem(const std::shared_ptr<Watch>& watch = std::make_shared<Watch>()) const {
    ProblemDefinition d;
    d.model = std::make_shared<StillModel>(lower, upper);
    d.x0 = Vector::Zero(3);
    d.u_previous = Vector::Zero(lower.size());
    d.N = d.M = 1;
    d.dt = 1.0;
    d.terms.push_back({std::make_shared<FunctionCost>(f, g, watch), 1.0});
    if (rows > 0) d.terms.push_back({std::make_shared<FunctionConstraint>(rows, c, J), 1.0});
    return Problem(d);
  }
  double violation(const Vector& u) const { return rows == 0 ? 0.0 : prospect::violation(c(u)); }
};

inline Vector vec(std::initializer_list<double> values) {
  Vector v(static_cast<Eigen::Index>(values.size()));
  Eigen::Index i = 0;
  for (const double value : values) v[i++] = value;
  return v;
}

inline Case rosenbrock() {
  Case p{"Rosenbrock", vec({-2, -2}), vec({2, 2}), vec({-1.2, 1})};
  p.f = [](const Vector& x) {
    return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2);
  };
  p.g = [](const Vector& x) {
    const double r = x[1] - x[0] * x[0];
    return vec({-400 * x[0] * r - 2 * (1 - x[0]), 200 * r});
  };
  return p;
}

/// sum_i (i+1) (x_i - t_i)^2 with every third t_i outside the bounds.
inline Case bounded_quadratic() {
  constexpr int n = 10;
  Case p{"bounded quadratic", Vector::Constant(n, -1), Vector::Constant(n, 1), Vector::Zero(n)};
  Vector t(n);
  for (int i = 0; i < n; ++i) t[i] = i % 3 == 0 ? 1.5 : 0.8 * std::sin(1.0 + i);
  p.f = [t](const Vector& x) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += (i + 1) * std::pow(x[i] - t[i], 2);
    return sum;
  };
  p.g = [t](const Vector& x) {
    Vector g(x.size());
    for (int i = 0; i < n; ++i) g[i] = 2 * (i + 1) * (x[i] - t[i]);
    return g;
  };
  for (int i = 0; i < n; i += 3) p.optimum += (i + 1) * 0.25;
  return p;
}

// Hock and Schittkowski, "Test examples for nonlinear programming codes" (1981), by their numbers;
// absent bounds are replaced by wide ones.

inline Case hs12() {
  Case p{"HS12", vec({-10, -10}), vec({10, 10}), vec({0, 0})};
  p.f = [](const Vector& x) {
    return 0.5 * x[0] * x[0] + x[1] * x[1] - x[0] * x[1] - 7 * x[0] - 7 * x[1];
  };
  p.g = [](const Vector& x) { return vec({x[0] - x[1] - 7, 2 * x[1] - x[0] - 7}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({25 - 4 * x[0] * x[0] - x[1] * x[1]}); };
  p.J = [](const Vector& x) { return Matrix(vec({-8 * x[0], -2 * x[1]}).transpose()); };
  p.optimum = -30;
  return p;
}

inline Case hs21() {
  Case p{"HS21", vec({2, -50}), vec({50, 50}), vec({-1, -1})};  // starts outside its bounds
  p.f = [](const Vector& x) { return 0.01 * x[0] * x[0] + x[1] * x[1] - 100; };
  p.g = [](const Vector& x) { return vec({0.02 * x[0], 2 * x[1]}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({10 * x[0] - x[1] - 10}); };
  p.J = [](const Vector&) { return Matrix(vec({10, -1}).transpose()); };
  p.optimum = -99.96;
  return p;
}

inline Case hs22() {
  Case p{"HS22", vec({-5, -5}), vec({5, 5}), vec({2, 2})};  // an infeasible start
  p.f = [](const Vector& x) { return std::pow(x[0] - 2, 2) + std::pow(x[1] - 1, 2); };
  p.g = [](const Vector& x) { return vec({2 * (x[0] - 2), 2 * (x[1] - 1)}); };
  p.rows = 2;
  p.c = [](const Vector& x) { return vec({2 - x[0] - x[1], x[1] - x[0] * x[0]}); };
  p.J = [](const Vector& x) {
    Matrix J(2, 2);
    J << -1, -1, -2 * x[0], 1;
    return J;
  };
  p.optimum = 1;
  return p;
}

inline Case hs29() {
  Case p{"HS29", vec({-10, -10, -10}), vec({10, 10, 10}), vec({1, 1, 1})};
  p.f = [](const Vector& x) { return -x[0] * x[1] * x[2]; };
  p.g = [](const Vector& x) { return vec({-x[1] * x[2], -x[0] * x[2], -x[0] * x[1]}); };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({48 - x[0] * x[0] - 2 * x[1] * x[1] - 4 * x[2] * x[2]}); };
  p.J = [](const Vector& x) { return Matrix(vec({-2 * x[0], -4 * x[1], -8 * x[2]}).transpose()); };
  p.optimum = -16 * std::sqrt(2.0);
  return p;
}

inline Case hs35() {
  Case p{"HS35", vec({0, 0, 0}), vec({10, 10, 10}), vec({0.5, 0.5, 0.5})};
  p.f = [](const Vector& x) {
    return 9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + 2 * x[0] * x[0] + 2 * x[1] * x[1] + x[2] * x[2] +
           2 * x[0] * x[1] + 2 * x[0] * x[2];
  };
  p.g = [](const Vector& x) {
    return vec(
        {-8 + 4 * x[0] + 2 * x[1] + 2 * x[2], -6 + 4 * x[1] + 2 * x[0], -4 + 2 * x[2] + 2 * x[0]});
  };
  p.rows = 1;
  p.c = [](const Vector& x) { return vec({3 - x[0] - x[1] - 2 * x[2]}); };
  p.J = [](const Vector&) { return Matrix(vec({-1, -1, -2}).transpose()); };
  p.optimum = 1.0 / 9.0;
  return p;
}

inline Case hs43() {
  Case p{"HS43", Vector::Constant(4, -10), Vector::Constant(4, 10), Vector::Zero(4)};
  p.f = [](const Vector& x) {
    return x[0] * x[0] + x[1] * x[1] + 2 * x[2] * x[2] + x[3] * x[3] - 5 * x[0] - 5 * x[1] -
           21 * x[2] + 7 * x[3];
  };
  p.g = [](const Vector& x) {
    return vec({2 * x[0] - 5, 2 * x[1] - 5, 4 * x[2] - 21, 2 * x[3] + 7});
  };
  p.rows = 3;
  p.c = [](const Vector& x) {
    const Vector s = x.cwiseAbs2();
    return vec({8 - s.sum() - x[0] + x[1] - x[2] + x[3],
                10 - s[0] - 2 * s[1] - s[2] - 2 * s[3] + x[0] + x[3],
                5 - 2 * s[0] - s[1] - s[2] - 2 * x[0] + x[1] + x[3]});
  };
  p.J = [](const Vector& x) {
    Matrix J(3, 4);
    J << -2 * x[0] - 1, -2 * x[1] + 1, -2 * x[2] - 1, -2 * x[3] + 1,  //
        -2 * x[0] + 1, -4 * x[1], -2 * x[2], -4 * x[3] + 1,           //
        -4 * x[0] - 2, -2 * x[1] + 1, -2 * x[2], 1;
    return J;
  };
  p.optimum = -44;
  return p;
}

inline Case hs76() {
  Case p{"HS76", Vector::Zero(4), Vector::Constant(4, 10), Vector::Constant(4, 0.5)};
  p.f = [](const Vector& x) {
    return x[0] * x[0] + 0.5 * x[1] * x[1] + x[2] * x[2] + 0.5 * x[3] * x[3] - x[0] * x[2] +
           x[2] * x[3] - x[0] - 3 * x[1] + x[2] - x[3];
  };
  p.g = [](const Vector& x) {
    return vec({2 * x[0] - x[2] - 1, x[1] - 3, 2 * x[2] - x[0] + x[3] + 1, x[3] + x[2] - 1});
  };
  p.rows = 3;
  p.c = [](const Vector& x) {
    return vec({5 - x[0] - 2 * x[1] - x[2] - x[3], 4 - 3 * x[0] - x[1] - 2 * x[2] + x[3],
                x[1] + 4 * x[2] - 1.5});
  };
  p.J = [](const Vector&) {
    Matrix J(3, 4);
    J << -1, -2, -1, -1, -3, -1, -2, 1, 0, 1, 4, 0;
    return J;
  };
  p.optimum = -4.681818181818182;
  return p;
}

/// Six-hump camel back: two of its six minima are global.
inline Case camel() {
  Case p{"six-hump camel", vec({-3, -2}), vec({3, 2}), vec({-1.8, 0.9})};
  p.f = [](const Vector& x) {
    const double a = x[0] * x[0], b = x[1] * x[1];
    return (4 - 2.1 * a + a * a / 3) * a + x[0] * x[1] + (-4 + 4 * b) * b;
  };
  p.g = [](const Vector& x) {
    const double a = x[0] * x[0];
    return vec({8 * x[0] - 8.4 * x[0] * a + 2 * x[0] * a * a + x[1],
                x[0] - 8 * x[1] + 16 * x[1] * x[1] * x[1]});
  };
  p.optimum = -1.031628453489877;
  p.several_basins = true;
  return p;
}

inline std::vector<Case> all_cases() {
  return {rosenbrock(), bounded_quadratic(), hs12(), hs21(), hs22(), hs29(), hs35(), hs43(), hs76(),
          camel()};
}

/// Mean squared distance of the positions to a path [m^2], and the distance to a disc as a hard
/// constraint [m].
class FollowPath final : public Term {
 public:
  FollowPath(Eigen::Matrix2Xd path, std::shared_ptr<Watch> watch)
      : path_(std::move(path)), watch_(std::move(watch)) {}
  std::string_view name() const override { return "follow path"; }
  TermTraits traits() const override {
    return {TermKind::kCost, Smoothness::kSmooth, true, "m^2", "mean over stages"};
  }
  void evaluate(const TrajectoryBatch& t, const TermRequest& request, TermScratch*,
                TermOutput& out) const override {
    ++watch_->calls;
    const int N = t.horizon.N;
    for (int b = 0; b < t.batch(); ++b) {
      const bool nan = watch_->evaluated(t, b);
      double sum = nan ? std::numeric_limits<double>::quiet_NaN() : 0.0;
      for (int k = 1; k <= N; ++k) {
        const double dx = t.px(k, b) - path_(0, k), dy = t.py(k, b) - path_(1, k);
        sum += (dx * dx + dy * dy) / N;
        if (request.gradient) out.add_pose_gradient(t, k, b, 2 * dx / N, 2 * dy / N, 0, 0);
      }
      out.value(0, b) = sum;
    }
  }

 private:
  Eigen::Matrix2Xd path_;
  std::shared_ptr<Watch> watch_;
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

/// A unicycle has to find the inputs behind a path that passes a disc, which is there `discs`
/// times: the optimum is 0. Start: at rest. N = 20, M = 10, n = 20, m = 20 discs.
struct PathProblem {
  Problem problem;
  Vector solution;
};

inline PathProblem path_problem(const std::shared_ptr<Watch>& watch = std::make_shared<Watch>(),
                                int discs = 1) {
  ProblemDefinition d;
  d.model = std::make_shared<Unicycle>(Unicycle::Parameters{});
  d.x0 = vec({0, 0, 0});
  d.u_previous = vec({0.3, 0});
  d.N = 20;
  d.M = 10;
  d.dt = 0.25;
  Vector z(20);
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
  d.terms.push_back({std::make_shared<FollowPath>(path, watch), 1.0});
  for (int i = 0; i < discs; ++i) {
    d.terms.push_back({std::make_shared<OutsideDisc>(centre, clearance - 0.05), 1.0});
  }
  return {Problem(d), z};
}

}  // namespace prospect::zoo
