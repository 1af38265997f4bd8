// SPDX-License-Identifier: Apache-2.0
#include "engine/terms/cost_to_go_term.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>

#include "engine/terms/heading_alignment.h"
#include "models/motion_model.h"

namespace prospect::cost_to_go_term_test {
namespace {

// The terms read poses only; a model with pose (x, y, yaw) and one entry besides is all they need.
class PoseOnly final : public MotionModel {
 public:
  using V = Eigen::Ref<Eigen::VectorXd>;
  using C = Eigen::Ref<const Eigen::VectorXd>;
  using M = Eigen::Ref<Eigen::MatrixXd>;
  std::string_view name() const override { return "pose_only"; }
  int nx() const override { return 4; }
  int nu() const override { return 2; }
  void step(const C&, const C&, double, V) const override {}
  void jacobians(const C&, const C&, double, M, M) const override {}
  void step_batch(const Eigen::Ref<const BatchArray>&, const Eigen::Ref<const BatchArray>&, double,
                  Eigen::Ref<BatchArray>) const override {}
  const InputLimits& limits() const override { return limits_; }
  PoseLayout pose_layout() const override { return {1, 0, -1, 3, 0.0}; }
  Twist twist(const C&, const C&) const override { return {}; }
  Eigen::VectorXd state(const Pose&, const Twist&) const override {
    return Eigen::VectorXd::Zero(4);
  }
  Eigen::VectorXd input(const Twist&) const override { return Eigen::VectorXd::Zero(2); }
  Eigen::VectorXd braking_input(const C&, const C&, double) const override {
    return Eigen::VectorXd::Zero(2);
  }
  double squared_speed(const C&, const C&, Eigen::VectorXd*, Eigen::VectorXd*) const override {
    return 0.0;
  }
  double max_speed() const override { return 1.0; }
  double max_yaw_rate() const override { return 1.0; }
  double max_deceleration() const override { return 1.0; }

 private:
  InputLimits limits_;
};

const PoseOnly kModel;

std::shared_ptr<const CostToGo> field(std::mt19937_64& random, double spread) {
  const GridFrame frame{0.1, -20, -20, 40, 40};
  Grid<double> seconds(frame, 0.0);
  std::uniform_real_distribution<double> draw(0.0, spread);
  for (int k = 0; k < frame.size(); ++k) {
    const Eigen::Vector2d p = frame.center(frame.at(k));
    seconds.data[static_cast<std::size_t>(k)] =
        (p - Eigen::Vector2d(0.4, 0.3)).norm() / 0.6 + draw(random);
  }
  return std::make_shared<const CostToGo>(seconds, Grid<std::uint8_t>(frame, 1), 0.6);
}

TrajectoryBatch random_batch(std::mt19937_64& random, int N, int batch, double span) {
  TrajectoryBatch t;
  t.horizon = {&kModel, N, 0.25};
  t.layout = kModel.pose_layout();
  t.states.resize((N + 1) * 4, batch);
  t.inputs = BatchArray::Zero(N * 2, batch);
  std::uniform_real_distribution<double> draw(-span, span);
  for (double& x : t.states.reshaped()) x = draw(random);
  return t;
}

Eigen::ArrayXd values(const Term& term, const TrajectoryBatch& t) {
  TermOutput out;
  out.value = BatchArray::Zero(1, t.batch());
  term.evaluate(t, {false}, nullptr, out);
  return out.value.row(0).transpose();
}

double slow_cost_to_go(const CostToGo& v, const TrajectoryBatch& t, int b) {
  const int N = t.horizon.N;
  double mean = 0.0;
  for (int k = 1; k <= N; ++k) mean += v.value(t.px(k, b), t.py(k, b)) / N;
  return (0.5 * v.value(t.px(N, b), t.py(N, b)) + 0.5 * mean) / (N * t.horizon.dt);
}

double slow_heading(const CostToGo& v, const TrajectoryBatch& t, int b) {
  double mean = 0.0;
  for (int k = 1; k <= t.horizon.N; ++k) {
    Eigen::Vector2d g;
    v.value({t.px(k, b), t.py(k, b)}, g);
    const double slope = 0.6 * g.norm();
    const double miss = 1.0 - std::cos(t.yaw(k, b) - std::atan2(-g.y(), -g.x()));
    mean += slope * slope / (slope * slope + 0.04) * miss / t.horizon.N;
  }
  return mean;
}

void check_gradient(const Term& term, TrajectoryBatch t, double tolerance) {
  const int rows = static_cast<int>(t.states.rows());
  TermOutput out;
  out.value = BatchArray::Zero(1, 1);
  out.state_gradient = BatchArray::Zero(rows, 1);
  out.input_gradient = BatchArray::Zero(t.inputs.rows(), 1);
  term.evaluate(t, {true}, nullptr, out);
  ASSERT_NEAR(out.value(0, 0), values(term, t)[0], 1e-14);
  EXPECT_EQ(out.input_gradient.abs().maxCoeff(), 0.0);
  for (int row = 0; row < rows; ++row) {
    constexpr double kStep = 1e-6;
    const double x = t.states(row, 0);
    t.states(row, 0) = x + kStep;
    const double up = values(term, t)[0];
    t.states(row, 0) = x - kStep;
    const double down = values(term, t)[0];
    t.states(row, 0) = x;
    const double difference = (up - down) / (2 * kStep);
    ASSERT_NEAR(out.state_gradient(row, 0), difference, tolerance * (1.0 + std::abs(difference)));
  }
}

TEST(CostToGoTerm, IsTheFormulaAndItsGradientIsExact) {
  std::mt19937_64 random(1);
  for (int run = 0; run < 20; ++run) {
    const auto v = field(random, run % 2 == 0 ? 0.0 : 5.0);
    const CostToGoTerm term(v);
    const TrajectoryBatch t = random_batch(random, 1 + run % 9, 7, 2.5);
    const Eigen::ArrayXd value = values(term, t);
    for (int b = 0; b < 7; ++b) EXPECT_NEAR(value[b], slow_cost_to_go(*v, t, b), 1e-12);
    check_gradient(term, random_batch(random, 1 + run % 9, 1, 2.5), 1e-6);
  }
}

TEST(HeadingAlignment, IsTheFormulaAndItsGradientIsExact) {
  std::mt19937_64 random(2);
  for (int run = 0; run < 20; ++run) {
    const auto v = field(random, run % 2 == 0 ? 0.0 : 0.3);
    const HeadingAlignment term(v);
    const TrajectoryBatch t = random_batch(random, 1 + run % 9, 7, 2.5);
    const Eigen::ArrayXd value = values(term, t);
    for (int b = 0; b < 7; ++b) EXPECT_NEAR(value[b], slow_heading(*v, t, b), 1e-12);
    check_gradient(term, random_batch(random, 1 + run % 9, 1, 2.5), 1e-5);
  }
}

// Where grad V vanishes: flat ground, and beyond the window.
TEST(HeadingAlignment, IsSmoothWhereTheCostToGoIsFlat) {
  std::mt19937_64 random(3);
  const GridFrame frame{0.1, 0, 0, 4, 4};
  const auto flat =
      std::make_shared<const CostToGo>(Grid<double>(frame, 3.0), Grid<std::uint8_t>(frame, 1), 0.6);
  check_gradient(HeadingAlignment(flat), random_batch(random, 3, 1, 0.5), 1e-9);
  EXPECT_NEAR(values(HeadingAlignment(flat), random_batch(random, 3, 1, 0.5))[0], 0.0, 1e-20);
  // The bottom of a bowl: the gradient passes through zero there.
  Grid<double> bowl(GridFrame{0.1, -20, -20, 40, 40}, 0.0);
  for (int k = 0; k < bowl.frame.size(); ++k) {
    bowl.data[static_cast<std::size_t>(k)] = bowl.frame.center(bowl.frame.at(k)).squaredNorm();
  }
  const auto v = std::make_shared<const CostToGo>(bowl, Grid<std::uint8_t>(bowl.frame, 1), 0.6);
  const HeadingAlignment term(v);
  for (const double d : {1e-3, 1e-5, 1e-7, 0.0}) {
    TrajectoryBatch t = random_batch(random, 1, 1, 1.0);
    t.states.setConstant(d);
    TermOutput out;
    out.value = BatchArray::Zero(1, 1);
    out.state_gradient = BatchArray::Zero(8, 1);
    out.input_gradient = BatchArray::Zero(2, 1);
    term.evaluate(t, {true}, nullptr, out);
    EXPECT_TRUE(out.state_gradient.isFinite().all());
    EXPECT_LT(out.state_gradient.abs().maxCoeff(), 200.0 * d + 1e-12);
  }
}

TEST(CostToGoTerm, NeverInventsAFiniteNumberAndNeverLosesOne) {
  std::mt19937_64 random(4);
  const auto v = field(random, 1.0);
  const CostToGoTerm cost(v);
  const HeadingAlignment heading(v);
  for (const double span : {1.0, 1e3, 1e12}) {
    const TrajectoryBatch t = random_batch(random, 5, 50, span);
    EXPECT_TRUE(values(cost, t).isFinite().all());
    EXPECT_TRUE(values(heading, t).isFinite().all());
  }
  TrajectoryBatch t = random_batch(random, 5, 2, 1.0);
  t.states(9, 1) = std::numeric_limits<double>::quiet_NaN();  // x at stage 2
  EXPECT_TRUE(std::isfinite(values(cost, t)[0]));
  EXPECT_TRUE(std::isnan(values(cost, t)[1]));
  EXPECT_TRUE(std::isnan(values(heading, t)[1]));
  EXPECT_THROW(CostToGoTerm(nullptr), std::invalid_argument);
  EXPECT_THROW(HeadingAlignment(nullptr), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::cost_to_go_term_test
