// SPDX-License-Identifier: Apache-2.0
// The three terms of clearance: ObstacleCost, ClearanceConstraint, BrakingConstraint.
#include <gtest/gtest.h>

#include <limits>

#include "engine/terms/braking_constraint.h"
#include "engine/terms/clearance_constraint.h"
#include "engine/terms/obstacle_cost.h"
#include "models/multirotor.h"
#include "models/unicycle.h"
#include "models/unicycle_accel.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/engine/term_derivatives.h"

namespace prospect::obstacle_terms_test {
namespace {

using test::evaluate;
using test::ObstacleWorld;
using test::random_trajectories;
using test::random_world;

using Obstacles = ClearanceField::Obstacles;

std::shared_ptr<const BodyClearance> clearance_in(const ObstacleWorld& world,
                                                  const RobotShape& shape, bool vertical = false,
                                                  Obstacles obstacles = Obstacles::kOccupied) {
  ClearanceField::Options options;
  options.vertical = vertical;
  options.reach = 3.0;
  options.vertical_reach = 0.6;
  options.obstacles = obstacles;
  return std::make_shared<const BodyClearance>(
      std::make_shared<const ClearanceField>(Eigen::Vector3d(0.0, 0.0, 0.4), world.voxels,
                                             world.ground, options),
      shape);
}

struct Case {
  std::shared_ptr<const MotionModel> model;
  std::shared_ptr<const BodyClearance> clearance;
};

std::vector<Case> cases(Obstacles obstacles) {
  ObstacleWorld world = random_world(31, 0.1, 3.0);
  for (int i = 12; i < 30; ++i) {
    for (int j = -10; j < 30; ++j) world.forget_column(i, j);
  }
  const CylinderShape disc;
  const BoxShape box{{0.03, 0.0, 0.2}, {0.5, 0.3, 0.3}};
  return {{std::make_shared<Unicycle>(), clearance_in(world, disc, false, obstacles)},
          {std::make_shared<UnicycleAccel>(), clearance_in(world, box, false, obstacles)},
          {std::make_shared<Multirotor>(), clearance_in(world, box, true, obstacles)}};
}

Pose middle(const Pose& a, const Pose& b) {
  return {0.5 * (a.position + b.position), 0.5 * (a.yaw + b.yaw)};
}

TEST(ObstacleCost, IsTheMeanOfPhiOverNodesAndMidPoints) {
  std::mt19937_64 random(1);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const double d_safe = 0.03, d_des = 0.3;
    const ObstacleCost cost(c.clearance, d_safe, d_des);
    const TrajectoryBatch t = random_trajectories(*c.model, 7, 0.25, 5, 2.0, random);
    const TermOutput out = evaluate(cost, t, false);
    for (int b = 0; b < 5; ++b) {
      double sum = 0.0;
      for (int k = 1; k <= 7; ++k) {
        for (const Pose& pose : {t.pose(k, b), middle(t.pose(k - 1, b), t.pose(k, b))}) {
          const double d = c.clearance->clearance(pose);
          sum += 0.5 * (1.0 - std::tanh(6.0 / (d_des - d_safe) * (d - 0.5 * (d_des + d_safe))));
        }
      }
      EXPECT_NEAR(out.value(0, b), sum / 14.0, 1e-12);
      EXPECT_GE(out.value(0, b), 0.0);
      EXPECT_LE(out.value(0, b), 1.0);
    }
  }
}

TEST(ObstacleCost, GradientMatchesFiniteDifferences) {
  std::mt19937_64 random(2);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const ObstacleCost cost(c.clearance, 0.03, 0.3);
    for (int sample = 0; sample < 15; ++sample) {
      const TrajectoryBatch t = random_trajectories(*c.model, 4, 0.25, 1, 2.0, random);
      test::expect_derivative_matches_differences(cost, t, 0, 1e-6, 2e-4);
    }
  }
}

/// Some that stand, walk, and are near.
std::vector<Mover> people() {
  return {{{0.4, 0.3}, {0.0, 0.0}, 0.2, 0.3},
          {{-1.0, 0.5}, {1.2, -0.3}, 0.3, 0.2},
          {{30.0, 0.0}, {0.0, 0.0}, 0.3, 0.2}};
}

TEST(ObstacleCost, OfMoversIsThatOfBeingNearAnyOfThemAtItsTime) {
  std::mt19937_64 random(11);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const double d_safe = 0.03, d_des = 0.3, radius = 0.25, dt = 0.25;
    const ObstacleCost cost(c.clearance, d_safe, d_des, people(), radius);
    const TrajectoryBatch t = random_trajectories(*c.model, 6, dt, 5, 2.0, random);
    const TermOutput out = evaluate(cost, t, false);
    const auto near = [&](double d) {
      return 0.5 * (1.0 - std::tanh(6.0 / (d_des - d_safe) * (d - 0.5 * (d_des + d_safe))));
    };
    double most = 0.0;
    for (int b = 0; b < 5; ++b) {
      double sum = 0.0;
      const auto add = [&](const Pose& pose, double time) {
        double clear = 1.0 - near(c.clearance->clearance(pose));
        for (const Mover& m : people()) {
          const Eigen::Vector2d at = m.position + time * m.velocity;
          const double d = (pose.position.head<2>() - at).norm() - m.radius -
                           std::min(m.spread * time, Mover::kMostSpread) - radius;
          clear *= 1.0 - near(d);
        }
        sum += 1.0 - clear;
      };
      for (int k = 1; k <= 6; ++k) {
        add(t.pose(k, b), k * dt);
        add(middle(t.pose(k - 1, b), t.pose(k, b)), (k - 0.5) * dt);
      }
      EXPECT_NEAR(out.value(0, b), sum / 12.0, 1e-12);
      most = std::max(most, out.value(0, b));
    }
    EXPECT_GT(most, 0.05);
    // Nobody far away changes anything.
    const ObstacleCost alone(c.clearance, d_safe, d_des);
    const ObstacleCost far(c.clearance, d_safe, d_des, {people()[2]}, radius);
    const TermOutput a = evaluate(alone, t, false), f = evaluate(far, t, false);
    for (int b = 0; b < 5; ++b) EXPECT_NEAR(a.value(0, b), f.value(0, b), 1e-12);
  }
}

TEST(ObstacleCost, GradientAmongMoversMatchesFiniteDifferences) {
  std::mt19937_64 random(12);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const ObstacleCost cost(c.clearance, 0.03, 0.3, people(), 0.25);
    for (int sample = 0; sample < 15; ++sample) {
      const TrajectoryBatch t = random_trajectories(*c.model, 4, 0.25, 1, 2.0, random);
      test::expect_derivative_matches_differences(cost, t, 0, 1e-6, 2e-4);
    }
  }
}

TEST(ObstacleCost, RejectsMoversThatAreNotFinite) {
  const auto c = cases(Obstacles::kOccupied).front().clearance;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ObstacleCost(c, 0.1, 0.3, {{{kNan, 0.0}, {0.0, 0.0}, 0.2, 0.0}}),
               std::invalid_argument);
  EXPECT_THROW(ObstacleCost(c, 0.1, 0.3, {{{0.0, 0.0}, {0.0, 0.0}, -0.2, 0.0}}),
               std::invalid_argument);
  EXPECT_THROW(ObstacleCost(c, 0.1, 0.3, {}, kNan), std::invalid_argument);
}

TEST(ObstacleCost, RejectsBadDistances) {
  const auto c = cases(Obstacles::kOccupied).front().clearance;
  EXPECT_THROW(ObstacleCost(c, 0.3, 0.3), std::invalid_argument);
  EXPECT_THROW(ObstacleCost(c, -0.1, 0.3), std::invalid_argument);
  EXPECT_THROW(ObstacleCost(c, 0.1, 5.0), std::invalid_argument);
  EXPECT_THROW(ObstacleCost(c, std::numeric_limits<double>::quiet_NaN(), 0.3),
               std::invalid_argument);
  EXPECT_THROW(ObstacleCost(nullptr, 0.1, 0.3), std::invalid_argument);
}

TEST(ClearanceConstraint, RowsAreClearanceLessWhatIsRequired) {
  std::mt19937_64 random(3);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const ClearanceConstraint constraint(c.clearance, {});
    const TrajectoryBatch t = random_trajectories(*c.model, 6, 0.25, 8, 2.0, random);
    EXPECT_EQ(constraint.rows(t.horizon), 12);
    const TermOutput out = evaluate(constraint, t, false);
    for (int b = 0; b < 8; ++b) {
      const double d_0 = c.clearance->clearance(t.pose(0, b));
      for (int k = 1; k <= 6; ++k) {
        EXPECT_NEAR(out.value(k - 1, b),
                    c.clearance->clearance(t.pose(k, b)) - constraint.required(d_0, k / 6.0),
                    1e-14);
        EXPECT_NEAR(out.value(5 + k, b),
                    c.clearance->clearance(middle(t.pose(k - 1, b), t.pose(k, b))) -
                        constraint.required(d_0, (k - 0.5) / 6.0),
                    1e-14);
      }
    }
  }
}

TEST(ClearanceConstraint, JacobianMatchesFiniteDifferences) {
  std::mt19937_64 random(4);
  for (const Case& c : cases(Obstacles::kOccupied)) {
    const ClearanceConstraint constraint(c.clearance, {});
    for (int sample = 0; sample < 15; ++sample) {
      const TrajectoryBatch t = random_trajectories(*c.model, 4, 0.25, 1, 2.0, random);
      // x_0 moves the requirement too, which the Jacobian leaves out on purpose.
      test::expect_derivative_matches_differences(constraint, t, 1, 1e-6, 5e-4);
    }
  }
}

TEST(ClearanceConstraint, RequirementRelaxesButNeverBelowTheFloor) {
  const auto c = cases(Obstacles::kOccupied).front().clearance;
  ClearanceConstraint::Options options;
  options.d_safe = 0.1;
  options.floor = 0.02;
  options.slack = 0.005;
  const ClearanceConstraint constraint(c, options);
  EXPECT_EQ(constraint.required(0.3, 0.5), 0.1);
  EXPECT_EQ(constraint.required(0.1, 0.5), 0.1);
  EXPECT_DOUBLE_EQ(constraint.required(0.06, 0.5), 0.055);
  EXPECT_EQ(constraint.required(0.022, 0.5), 0.02);
  // Replanning from what the last plan was allowed: stays at the floor, however often.
  double d = 0.09;
  for (int replan = 0; replan < 100; ++replan) {
    d = std::min(constraint.required(d, 1.0), constraint.required(d, 0.05));
    ASSERT_GE(d, options.floor);
  }
  EXPECT_EQ(d, options.floor);
  // Inside an obstacle: stay no deeper than now, and be above the floor at the end.
  EXPECT_NEAR(constraint.required(-0.1, 0.0), -0.105, 1e-15);
  EXPECT_NEAR(constraint.required(-0.1, 1.0), 0.02, 1e-15);
  EXPECT_LT(constraint.required(-0.1, 0.3), constraint.required(-0.1, 0.6));
}

TEST(ClearanceConstraint, RefusesASlackThatIsNone) {
  const auto c = cases(Obstacles::kOccupied).front().clearance;
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double bad : {-1e-6, infinite, std::numeric_limits<double>::quiet_NaN()}) {
    ClearanceConstraint::Options options;
    options.slack = bad;
    EXPECT_THROW(ClearanceConstraint(c, options), std::invalid_argument) << bad;
  }
}

TEST(ClearanceConstraint, ARobotInAWallHasAWayOut) {
  ObstacleWorld world(0.1, 3.0);
  for (int j = -30; j < 30; ++j) {
    for (int i = 0; i < 10; ++i) world.occupy_column(i, j);
  }
  const ClearanceConstraint constraint(clearance_in(world, CylinderShape{}), {});
  const Unicycle model;
  TrajectoryBatch t;
  t.horizon = {&model, 10, 0.25};
  t.layout = model.pose_layout();
  t.states.resize(33, 3);
  t.inputs.setZero(20, 3);
  for (int k = 0; k <= 10; ++k) {
    // Away from the wall; staying; further in.
    for (int b = 0; b < 3; ++b) {
      t.states(3 * k, b) = -0.1 - (b == 0 ? 0.1 : b == 1 ? 0.0 : -0.02) * k;
      t.states(3 * k + 1, b) = 0.0;
      t.states(3 * k + 2, b) = 0.0;
    }
  }
  const TermOutput out = evaluate(constraint, t, false);
  EXPECT_GE(out.value.col(0).minCoeff(), 0.0);
  EXPECT_LT(out.value.col(1).minCoeff(), 0.0);
  EXPECT_LT(out.value.col(2).minCoeff(), 0.0);
}

TEST(BrakingConstraint, RowsLeaveRoomToStop) {
  std::mt19937_64 random(5);
  for (const Case& c : cases(Obstacles::kOccupiedAndUnknown)) {
    BrakingConstraint::Options options;
    options.margin = 0.04;
    const BrakingConstraint constraint(c.clearance, options);
    const TrajectoryBatch t = random_trajectories(*c.model, 6, 0.25, 8, 2.0, random);
    const TermOutput out = evaluate(constraint, t, false);
    for (int b = 0; b < 8; ++b) {
      const double d_0 = c.clearance->clearance(t.pose(0, b));
      const double required = std::min(0.04, std::max(-c.clearance->largest_radius(), d_0 - 0.005));
      for (int k = 1; k <= 6; ++k) {
        const int nx = c.model->nx(), nu = c.model->nu();
        const Eigen::VectorXd x = t.states.col(b).segment(k * nx, nx);
        const Eigen::VectorXd u = t.inputs.col(b).segment((k - 1) * nu, nu);
        const double speed = c.model->twist(x, u).linear.norm();
        const Pose before = t.pose(k - 1, b);
        Pose stop = t.pose(k, b);
        const Eigen::Vector3d way = stop.position - before.position;
        const double turned = stop.yaw - before.yaw;
        const double turn = turned / 0.25 * speed / (2.0 * c.model->max_deceleration());
        const Eigen::AngleAxisd half(0.5 * (turned + turn), Eigen::Vector3d::UnitZ());
        stop.position +=
            speed * speed / (2.0 * c.model->max_deceleration()) * (half * way.normalized());
        stop.yaw += turn;
        // Rounded off at rest: by 1 mm of way and 1 cm/s.
        EXPECT_NEAR(out.value(k - 1, b), c.clearance->clearance(stop) - required, 0.02);
      }
    }
  }
}

TEST(BrakingConstraint, JacobianMatchesFiniteDifferences) {
  std::mt19937_64 random(6);
  for (const Case& c : cases(Obstacles::kOccupiedAndUnknown)) {
    const BrakingConstraint constraint(c.clearance, {});
    for (int sample = 0; sample < 15; ++sample) {
      TrajectoryBatch t = random_trajectories(*c.model, 4, 0.25, 1, 2.0, random);
      if (sample % 3 == 0) t.inputs.setZero();  // at rest the speed itself is not differentiable
      test::expect_derivative_matches_differences(constraint, t, 1, 1e-6, 5e-4);
    }
  }
}

BrakingConstraint braking_of_a_disc(const ObstacleWorld& world, double radius) {
  CylinderShape body;
  body.radius = radius;
  return {clearance_in(world, body, false, Obstacles::kOccupiedAndUnknown), {}};
}

Unicycle unicycle_of_speed(double v_max) {
  Unicycle::Parameters parameters;
  parameters.v_max = v_max;
  return Unicycle(parameters);
}

TrajectoryBatch two_of_one_stage(const Unicycle& model) {
  TrajectoryBatch t;
  t.horizon = {&model, 1, 0.1};
  t.layout = model.pose_layout();
  t.states.setZero(6, 2);
  t.inputs.setZero(2, 2);
  return t;
}

TEST(BrakingConstraint, AWallBesideTheWayDoesNotSlowARobotDownAndOneAheadDoes) {
  ObstacleWorld world(0.1, 3.0);
  for (int i = -30; i < 30; ++i) {
    for (const int j : {-4, 3}) world.occupy_column(i, j);  // a corridor 0.6 m wide
  }
  for (int j = -4; j < 4; ++j) world.occupy_column(20, j);  // its end, at x = 2
  const BrakingConstraint constraint = braking_of_a_disc(world, 0.2);
  const Unicycle model = unicycle_of_speed(1.5);
  const double way = 0.5 * 1.5 * 1.5 / model.max_deceleration();
  TrajectoryBatch t = two_of_one_stage(model);
  for (const int b : {0, 1}) {
    t.inputs(0, b) = 1.5;
    // 0.3 m more than it needs, and 0.3 m less.
    t.states(3, b) = 2.0 - 0.2 - way + (b == 0 ? -0.3 : 0.3);
    t.states(0, b) = t.states(3, b) - 0.15;
  }
  const TermOutput out = evaluate(constraint, t, false);
  EXPECT_GE(out.value(0, 0), 0.0);
  EXPECT_LT(out.value(0, 1), 0.0);
}

TEST(BrakingConstraint, TheWayToTheStopBendsWithTheWay) {
  // A quarter of a circle of radius 1 m: it ends where the arc does, not beside it.
  ObstacleWorld world(0.05, 3.0);
  for (int n = 0; n < world.voxels.frame().size(); ++n) {
    const Cell c = world.voxels.frame().at(n);
    const Eigen::Vector2d p = world.voxels.frame().center(c) - Eigen::Vector2d(0.0, 1.0);
    if (std::abs(p.norm() - 1.0) > 0.3) world.occupy_column(c.i, c.j);
  }
  const BrakingConstraint constraint = braking_of_a_disc(world, 0.15);
  const Unicycle model = unicycle_of_speed(1.0);
  TrajectoryBatch t = two_of_one_stage(model);
  for (const int b : {0, 1}) {
    t.inputs.col(b) = Eigen::Vector2d(1.0, b == 0 ? 1.0 : 0.0);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(3), next(3);
    model.step(x, t.inputs.col(b).matrix(), 0.1, next);
    t.states.col(b).tail(3) = next;
  }
  const TermOutput out = evaluate(constraint, t, false);
  EXPECT_GE(out.value(0, 0), 0.0);  // along the ring
  EXPECT_LT(out.value(0, 1), 0.0);  // straight out of it
}

TEST(BrakingConstraint, ARobotSurroundedByTheUnknownMayTurnButNotDrive) {
  ObstacleWorld world(0.1, 3.0);
  for (int n = 0; n < world.voxels.frame().size(); ++n) {
    const Cell c = world.voxels.frame().at(n);
    if (c.i * c.i + c.j * c.j > 2) world.forget_column(c.i, c.j);
  }
  const BrakingConstraint constraint(
      clearance_in(world, CylinderShape{}, false, Obstacles::kOccupiedAndUnknown), {});
  const Unicycle model;
  TrajectoryBatch t;
  t.horizon = {&model, 8, 0.25};
  t.layout = model.pose_layout();
  t.states.setZero(27, 2);
  t.inputs.setZero(16, 2);
  for (int k = 1; k <= 8; ++k) {
    t.states(3 * k + 2, 0) = 0.25 * k;  // turns
    t.inputs(2 * (k - 1) + 1, 0) = 1.0;
    t.states(3 * k, 1) = 0.6 * 0.25 * k;  // drives
    t.inputs(2 * (k - 1), 1) = 0.6;
  }
  const TermOutput out = evaluate(constraint, t, false);
  EXPECT_GE(out.value.col(0).minCoeff(), 0.0);
  EXPECT_LT(out.value.col(1).minCoeff(), -0.1);
}

TEST(UnknownSpaceConstraint, FollowsThePolicy) {
  const auto known = cases(Obstacles::kOccupiedAndUnknown).front().clearance;
  const auto occupied = cases(Obstacles::kOccupied).front().clearance;
  EXPECT_EQ(unknown_space_constraint(UnknownPolicy::kFree, known, 0.05), nullptr);
  EXPECT_EQ(unknown_space_constraint(UnknownPolicy::kBlocked, known, 0.05)->name(), "known_space");
  EXPECT_EQ(unknown_space_constraint(UnknownPolicy::kBraking, known, 0.05)->name(), "braking");
  EXPECT_THROW(unknown_space_constraint(UnknownPolicy::kBraking, occupied, 0.05),
               std::invalid_argument);
  EXPECT_THROW(unknown_space_constraint(UnknownPolicy::kBlocked, nullptr, 0.05),
               std::invalid_argument);
}

TEST(ObstacleTerms, NeverNonFinite) {
  std::mt19937_64 random(7);
  for (const Obstacles obstacles : {Obstacles::kOccupied, Obstacles::kOccupiedAndUnknown}) {
    for (const Case& c : cases(obstacles)) {
      std::vector<std::shared_ptr<const Term>> terms = {
          std::make_shared<ObstacleCost>(c.clearance, 0.03, 0.3),
          std::make_shared<ObstacleCost>(c.clearance, 0.03, 0.3, people(), 0.25),
          std::make_shared<ClearanceConstraint>(c.clearance, ClearanceConstraint::Options{})};
      if (obstacles == Obstacles::kOccupiedAndUnknown) {
        terms.push_back(
            std::make_shared<BrakingConstraint>(c.clearance, BrakingConstraint::Options{}));
      }
      for (const double spread : {0.0, 2.0, 50.0, 1e6, 1e100}) {
        for (int sample = 0; sample < 40; ++sample) {
          const TrajectoryBatch t = random_trajectories(*c.model, 3, 0.25, 1, spread, random);
          for (const auto& term : terms) {
            const TermOutput out = evaluate(*term, t, true);
            ASSERT_TRUE(out.value.allFinite()) << term->name() << " " << spread;
            ASSERT_TRUE(out.state_gradient.allFinite());
            ASSERT_TRUE(out.jacobian.allFinite());
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace prospect::obstacle_terms_test
