// SPDX-License-Identifier: Apache-2.0
#include "engine/safety/stop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "engine/planner/stopping_plan.h"
#include "engine/safety/guard.h"
#include "models/limited_twist.h"
#include "models/make_model.h"
#include "models/unicycle.h"
#include "tests/engine/obstacle_worlds.h"

namespace prospect::stop_test {
namespace {

using test::ObstacleWorld;

constexpr double kDt = 0.25;
constexpr double kCurvature = 0.8;  // [1/m] of the plan: 1.2 rad/s at 1.5 m/s

std::shared_ptr<const MotionModel> fast_model() {
  Unicycle::Parameters p;
  p.v_max = 1.5;
  p.a_max = 1.5;
  p.omega_max = 1.5;
  return std::make_shared<const Unicycle>(p);
}

Certifier::Options options() {
  Certifier::Options options;
  options.slice = {0.1, 0.5};
  options.margin = 0.005;
  options.unknown = UnknownPolicy::kFree;
  return options;
}

/// 0.5 s on a circle to the left at full speed, from the origin along x, and the stop after it.
Plan turning_plan(const MotionModel& model) {
  Plan plan;
  plan.kind = PlanKind::kOptimised;
  plan.certified = true;
  plan.committed = 2;
  plan.dt = kDt;
  const Eigen::Vector2d u(1.5, 1.5 * kCurvature);
  Eigen::VectorXd x = model.state({}, {}), next(model.nx());
  plan.states.push_back(x);
  for (int k = 0; k < 2; ++k) {
    model.step(x, u, kDt, next);
    x = next;
    plan.states.push_back(x);
    plan.inputs.emplace_back(u);
    plan.commands.push_back(model.twist(x, u));
  }
  const Eigen::MatrixXd tail = stopping_tail(model, x, u, kDt);
  for (Eigen::Index k = 0; k < tail.cols(); ++k) {
    model.step(x, tail.col(k), kDt, next);
    plan.tail.push_back(model.twist(next, tail.col(k)));
    x = next;
  }
  return plan;
}

/// In force when the plan begins.
const Twist kBefore{{1.5, 0.0, 0.0}, 0.6};

struct Block {
  int i_low, i_high, j_low, j_high;
};
ObstacleWorld world_of(const std::vector<Block>& blocks) {
  ObstacleWorld world;
  for (const Block& b : blocks) {
    for (int i = b.i_low; i <= b.i_high; ++i) {
      for (int j = b.j_low; j <= b.j_high; ++j) world.occupy_column(i, j);
    }
  }
  return world;
}

// A wall that ends beside the plan's path: known all the while. A stop straight on from where the
// plan turns ends in it.
constexpr Block kWall{7, 12, -20, -2};
// One cell that has become occupied since, where the plan's own stop would have ended.
constexpr Block kLate{11, 11, 5, 5};

// The robot braked straight where its plan turned, and touched a corner that was in the map.
TEST(Stop, GuardStopsWhereNothingIsTouchedElseLast) {
  struct Row {
    const char* what;
    std::vector<Block> blocks;
    double yaw_rate;  // of the first command
    bool free;
  };
  const Row rows[] = {
      {"the rest of the plan ends in a late cell, a straight stop in the wall",
       {kWall, kLate},
       0.9,
       true},
      {"both stops are free: on the certified ground", {kLate}, 0.9, true},
      {"a late cell on the path, nothing straight on", {{5, 6, 3, 3}}, 0.0, true},
      {"a wall across: who turns meets it last", {{7, 8, -20, 20}}, 1.125, false},
  };
  const auto model = fast_model();
  const Guard guard(model, CylinderShape{}, options());
  const Certifier certifier(CylinderShape{}, options());
  const Plan plan = turning_plan(*model);
  for (const Row& row : rows) {
    SCOPED_TRACE(row.what);
    const Belief belief = world_of(row.blocks).belief();
    const GuardVerdict verdict = guard.check(plan, 0, kBefore, belief, 0.0);
    EXPECT_EQ(verdict.reason, GuardReason::kMap);
    EXPECT_NEAR(verdict.command.linear.x(), 1.5 - 1.5 * kDt, 1e-9);
    EXPECT_NEAR(verdict.command.yaw_rate, row.yaw_rate, 1e-6);
    const Stop stop = choose_stop(certifier, belief, *model, &plan, model->state({}, kBefore),
                                  model->input(kBefore), kDt);
    const Certificate found =
        certifier.certify_inputs(belief, *model, model->state({}, kBefore), stop.inputs, kDt);
    EXPECT_EQ(found.ok(), row.free) << found.detail;
  }
}

// What the guard begins, the planner's stop ends: every stage passes, none leaves the path.
TEST(Stop, AStoppingPlanFollowsTheCertifiedPathToItsEnd) {
  const auto model = fast_model();
  const Guard guard(model, CylinderShape{}, options());
  const Certifier certifier(CylinderShape{}, options());
  const Plan certified = turning_plan(*model);
  Belief belief = world_of({kWall, kLate}).belief();
  belief.command = kBefore;
  const Plan stop = stopping_plan(
      belief, *model, kDt, {.along = &certified, .certifier = &certifier}, "a cell is occupied");
  ASSERT_EQ(stop.committed, static_cast<int>(stop.commands.size()));
  Twist before = kBefore;
  for (int stage = 0; stage < stop.committed; ++stage) {
    const auto k = static_cast<std::size_t>(stage);
    belief.pose = model->pose(stop.states[k]);
    belief.set_stamps(stage * kDt);
    const GuardVerdict verdict = guard.check(stop, stage, before, belief, belief.stamp);
    EXPECT_TRUE(verdict.passed()) << stage << ": " << verdict.detail;
    before = verdict.command;
    EXPECT_FALSE(certifier.in_collision(belief, model->pose(stop.states[k + 1]), true));
    if (before.linear.x() > 0.0) {
      EXPECT_NEAR(before.yaw_rate / before.linear.x(), kCurvature, 1e-6) << stage;
    }
  }
  EXPECT_TRUE(is_at_rest(before));
  // The same stop where the straight one has become the better: it is not driven.
  belief = world_of({{5, 6, 3, 3}}).belief();
  belief.set_stamps(0.0);
  const GuardVerdict verdict = guard.check(stop, 0, kBefore, belief, 0.0);
  EXPECT_EQ(verdict.reason, GuardReason::kMap);
  EXPECT_NEAR(verdict.command.yaw_rate, 0.0, 1e-9);
  // A wall across, which each stop touches: the one that touches last is driven.
  belief = world_of({{7, 8, -20, 20}}).belief();
  belief.command = kBefore;
  const Plan late = stopping_plan(belief, *model, kDt,
                                  {.along = &certified, .certifier = &certifier}, "a wall across");
  belief.set_stamps(0.0);
  const GuardVerdict last = guard.check(late, 0, kBefore, belief, 0.0);
  EXPECT_TRUE(last.passed()) << last.detail;
  EXPECT_GT(std::abs(last.command.yaw_rate), 0.5);
}

// A tail that turns and takes less from the speed, or turns on for ever, is none.
TEST(Stop, ASteeringTailBrakesAsHardToRest) {
  const auto model = fast_model();
  const Guard guard(model, CylinderShape{}, options());
  Belief belief = ObstacleWorld().belief();
  const auto passes = [&](const std::vector<Eigen::VectorXd>& inputs) {
    Plan plan = turning_plan(*model);
    plan.kind = PlanKind::kStoppingTail;
    plan.certified = false;
    plan.committed = static_cast<int>(inputs.size());
    plan.inputs.assign(inputs.begin(), inputs.end());
    plan.commands.clear();
    for (const auto& u : inputs) plan.commands.push_back({{u[0], 0.0, 0.0}, u[1]});
    return guard.check(plan, 0, kBefore, belief, 0.0).passed();
  };
  const auto u = [](double v, double w) -> Eigen::VectorXd { return Eigen::Vector2d(v, w); };
  const std::vector<Eigen::VectorXd> sound{u(1.125, 0.9), u(0.75, 0.6), u(0.375, 0.3), u(0.0, 0.0)};
  EXPECT_TRUE(passes(sound));
  const auto with = [&](std::size_t k, const Eigen::VectorXd& input) {
    std::vector<Eigen::VectorXd> inputs = sound;
    inputs[k] = input;
    return inputs;
  };
  EXPECT_FALSE(passes(with(0, u(1.2, 0.9))));
  EXPECT_FALSE(passes({sound.begin(), sound.end() - 1}));
  EXPECT_FALSE(passes(with(3, u(0.0, 0.3))));
  EXPECT_FALSE(passes(with(2, u(std::nan(""), 0.3))));
  EXPECT_FALSE(passes(with(2, Eigen::Vector3d(0.375, 0.3, 0.0)))) << "an input of another robot";
}

/// Left, then right, from a place and a yaw of its own; the second half as stages or as the tail.
struct Bends {
  Plan plan;
  Eigen::VectorXd middle;  // state between the bends
  Bends(const MotionModel& model, bool right_is_tail) {
    plan.certified = true;
    plan.stamp = 20.0;
    plan.dt = kDt;
    Eigen::VectorXd x = model.state({{3.0, -2.0, 0.0}, 1.0}, {}), next(model.nx());
    plan.states = {x};
    for (int k = 0; k < 8; ++k) {
      if (k == 4) middle = x;
      const Eigen::Vector2d u(0.6, k < 4 ? 1.2 : -1.2);
      model.step(x, u, kDt, next);
      (right_is_tail && k >= 4 ? plan.tail : plan.commands).push_back(model.twist(next, u));
      x = next;
    }
    plan.committed = static_cast<int>(plan.commands.size());
  }
};

TEST(Stop, BeginsWhereThePlanIsNearest) {
  Unicycle::Parameters p;
  p.alpha_max = 20.0;
  p.omega_max = 1.5;
  const Unicycle model(p);
  for (const bool right_is_tail : {false, true}) {
    const Bends bends(model, right_is_tail);
    const Eigen::MatrixXd stop =
        stop_along(model, bends.plan, bends.middle, Eigen::Vector2d(0.6, -1.2), 0.05);
    ASSERT_GT(stop.cols(), 10) << right_is_tail;
    for (Eigen::Index k = 0; stop(0, k) > 0.05; ++k) {
      EXPECT_NEAR(stop(1, k) / stop(0, k), -2.0, 1e-6) << right_is_tail << k;
    }
    // Beside it, or across it, there is no path.
    Eigen::VectorXd away = bends.middle;
    away.head<2>() += 0.3 * Eigen::Vector2d(-std::sin(away[2]), std::cos(away[2]));
    EXPECT_EQ(stop_along(model, bends.plan, away, Eigen::Vector2d(0.6, 0.0), 0.05).cols(), 0);
    away = bends.middle;
    away[2] += 0.6;
    EXPECT_EQ(stop_along(model, bends.plan, away, Eigen::Vector2d(0.6, 0.0), 0.05).cols(), 0);
  }
  // Where the plan stands, who still moves brakes straight on.
  Plan stands;
  stands.dt = kDt;
  stands.committed = 2;
  stands.commands.resize(2);
  stands.states = {model.state({}, {})};
  const Eigen::MatrixXd stop =
      stop_along(model, stands, stands.states[0], Eigen::Vector2d(0.4, 0.0), 0.05);
  ASSERT_GT(stop.cols(), 0);
  EXPECT_TRUE(stop.allFinite());
  EXPECT_NEAR(stop(0, 0), 0.4 - 0.8 * 0.05, 1e-9);
}

// On the path, whatever the model: at each place the plan's own yaw, up to what the rates allow.
TEST(Stop, KeepsToThePathOfEveryModel) {
  for (const std::string& name : model_names()) {
    SCOPED_TRACE(name);
    const auto model = make_model(name);
    Plan plan;
    plan.certified = true;
    plan.committed = 8;
    plan.dt = kDt;
    const Twist on_circle{{0.4, 0.0, 0.0}, 0.9};
    plan.commands.assign(8, on_circle);
    plan.states = {model->state({}, on_circle)};
    const Eigen::VectorXd start = plan.states.front(), u = model->input(on_circle);
    const Eigen::MatrixXd stop = stop_along(*model, plan, start, u, 0.05);
    ASSERT_GT(stop.cols(), 0);
    Eigen::VectorXd x = start, next(model->nx());
    for (Eigen::Index k = 0; k < stop.cols(); ++k) {
      model->step(x, stop.col(k), 0.05, next);
      x = next;
    }
    EXPECT_TRUE(is_at_rest(model->twist(x, stop.col(stop.cols() - 1))));
    const Pose end = model->pose(x);
    // As far aside as the circle is there, from a straight stop.
    const double x_end = end.position.x(), radius = 0.4 / 0.9;
    const double aside = radius - std::sqrt(radius * radius - x_end * x_end);
    EXPECT_NEAR(end.position.y(), aside, 0.25 * aside);
    // Elsewhere there is no path.
    Pose away;
    away.position.y() = 1.0;
    EXPECT_EQ(stop_along(*model, plan, model->state(away, on_circle), u, 0.05).cols(), 0);
  }
}

}  // namespace
}  // namespace prospect::stop_test
