// SPDX-License-Identifier: Apache-2.0
// What keeps a robot out of zones, part by part: certificate, guard, admissible inputs, clearance,
// traversability, frontiers.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <string>

#include "engine/frontiers/frontier_planner.h"
#include "engine/maps/clearance_field.h"
#include "engine/maps/traversability.h"
#include "engine/problem/admissible_inputs.h"
#include "engine/safety/certificate.h"
#include "engine/safety/guard.h"
#include "engine/task/zone_map.h"
#include "engine/terms/control_effort.h"
#include "engine/terms/rate_limit.h"
#include "engine/terms/speed_limit.h"
#include "models/make_model.h"
#include "tests/engine/ground_worlds.h"
#include "tests/engine/obstacle_worlds.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::zone_enforcement_test {
namespace {

using Status = Certificate::Status;
using test::ObstacleWorld;

constexpr double kDt = 0.25;
const Polygon kAhead = {{1, -1}, {3, -1}, {3, 1}, {1, 1}};

std::shared_ptr<const ZoneMap> map_of(const Zones& zones) {
  return std::make_shared<const ZoneMap>(zones);
}
std::shared_ptr<const ZoneMap> keep_out() {
  Zones zones;
  zones.keep_out = {kAhead};
  return map_of(zones);
}
std::shared_ptr<const ZoneMap> slow(double speed) {
  Zones zones;
  zones.slow = {{kAhead, speed}};
  return map_of(zones);
}

Certifier::Options certificate(std::shared_ptr<const ZoneMap> zones) {
  Certifier::Options options;
  options.slice = {0.1, 0.5};
  options.unknown = UnknownPolicy::kFree;
  options.zones = std::move(zones);
  return options;
}

Eigen::MatrixXd forward(int n, double speed) {
  Eigen::MatrixXd u = Eigen::MatrixXd::Zero(2, n);
  u.row(0).setConstant(speed);
  return u;
}

TEST(ZoneEnforcement, NoCertificateIntoAKeepOutWithTheStopAfterIt) {
  const auto model = make_model("unicycle");
  const Belief belief = ObstacleWorld().belief();
  const Certifier certifier(CylinderShape{{0, 0, 0.3}, 0.2, 0.4}, certificate(keep_out()));
  const Eigen::VectorXd u = model->input({});
  // The disc may come to x = 0.79 (margin 0.01): 0.4 m/s for 0.5 s and the stop are 0.25 m.
  const auto verdict = [&](double x) {
    return certifier.certify(belief, *model, Eigen::Vector3d(x, 0, 0), u, forward(2, 0.4), kDt);
  };
  EXPECT_TRUE(verdict(0.5).ok()) << verdict(0.5).detail;
  const Certificate refused = verdict(0.6);
  EXPECT_EQ(refused.status, Status::kForbidden);
  EXPECT_NE(refused.detail.find("would enter zones.keep_out[0]"), std::string::npos)
      << refused.detail;
  EXPECT_NEAR(refused.pose.position.x(), 0.79, 0.05);
  // From within, out and not deeper.
  const auto from = [&](double x, double yaw) {
    return certifier.certify(belief, *model, Eigen::Vector3d(x, 0, yaw), u, forward(2, 0.4), kDt)
        .status;
  };
  EXPECT_EQ(from(1.3, 0.0), Status::kForbidden);
  EXPECT_EQ(from(1.3, M_PI), Status::kOk);
  Certifier without(CylinderShape{{0, 0, 0.3}, 0.2, 0.4}, certificate(keep_out()));
  without.set_zones(nullptr);
  EXPECT_TRUE(
      without.certify(belief, *model, Eigen::Vector3d(0.6, 0, 0), u, forward(2, 0.4), kDt).ok());
}

TEST(ZoneEnforcement, WhatIsCertifiedKeepsOutAtEveryInstant) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-1.0, 4.0), unit(-1.0, 1.0);
  const auto model = make_model("unicycle");
  const Belief belief = ObstacleWorld(0.1, 8.0).belief();
  Zones zones;
  zones.keep_out = {kAhead, {{0, 1.5}, {0.2, 1.5}, {0.1, 3.5}}};
  zones.bound = Polygon{{-1.5, -1.5}, {4.5, -1.5}, {4.5, 4}, {-1.5, 4}};
  const BoxShape box{{0.05, 0.0, 0.3}, {0.5, 0.3, 0.3}};
  const BodyOutline outline = body_outline(box);
  const auto map = map_of(zones);
  const Certifier certifier(box, certificate(map));
  int accepted = 0, refused = 0;
  for (int sample = 0; sample < 1200; ++sample) {
    Eigen::VectorXd x = Eigen::Vector3d(place(random), place(random), 3.0 * unit(random));
    const auto free = [&](const Pose& pose, double margin = 0.0) {
      for (int part = 0; part < 3; ++part) {
        if (map->gap(part, outline, pose) < margin) return false;
      }
      return true;
    };
    // Within its margin at the start it keeps none.
    if (!free(model->pose(x), certifier.options().margin)) continue;
    Eigen::MatrixXd inputs(2, 4);
    for (int n = 0; n < 4; ++n) inputs.col(n) << 0.3 + 0.3 * unit(random), unit(random);
    const Certificate verdict = certifier.certify_inputs(belief, *model, x, inputs, kDt);
    bool entered = false;
    Eigen::VectorXd next(3);
    for (int n = 0; n < 4; ++n) {
      for (int piece = 1; piece <= 200; ++piece) {
        model->step(x, inputs.col(n), kDt * piece / 200.0, next);
        entered = entered || !free(model->pose(next));
      }
      x = next;
    }
    if (verdict.ok()) {
      EXPECT_FALSE(entered);
      ++accepted;
    } else {
      EXPECT_EQ(verdict.status, Status::kForbidden);
      ++refused;
    }
  }
  EXPECT_GT(accepted, 50);
  EXPECT_GT(refused, 50);
}

TEST(ZoneEnforcement, NoCertificateForMoreThanTheSpeedOfAZone) {
  const Belief belief = ObstacleWorld().belief();
  for (const char* name : {"unicycle", "unicycle_accel"}) {
    const auto model = make_model(name);
    const Certifier certifier(CylinderShape{}, certificate(slow(0.2)));
    const bool accelerates = model->num_state_constraints() > 0;
    const auto status = [&](double x, double speed) {
      const Eigen::VectorXd state = model->state({{x, 0, 0}, 0.0}, {{speed, 0, 0}, 0.0});
      const Eigen::MatrixXd inputs = accelerates ? Eigen::MatrixXd(Eigen::MatrixXd::Zero(2, 2))
                                                 : Eigen::MatrixXd(forward(2, speed));
      return certifier
          .certify(belief, *model, state, model->input({{speed, 0, 0}, 0.0}), inputs, kDt)
          .status;
    };
    EXPECT_EQ(status(1.5, 0.2), Status::kOk) << name;
    EXPECT_EQ(status(1.5, 0.21), Status::kTooFast) << name;
    EXPECT_EQ(status(0.0, 0.5), Status::kOk) << name;
    EXPECT_EQ(status(0.85, 0.5), Status::kTooFast) << name << ": it would be in it at 0.5 m/s";
    EXPECT_EQ(status(0.7, 0.5), Status::kTooFast) << name << ": it would not have braked by then";
  }
}

TEST(ZoneEnforcement, TheGuardAsksForItself) {
  const auto model = make_model("unicycle");
  const CylinderShape body{{0, 0, 0.3}, 0.2, 0.4};
  Guard guard(model, body, certificate(nullptr));
  Belief belief = ObstacleWorld().belief();
  belief.set_stamps(10.0);
  belief.pose.position.x() = 0.6;
  Plan plan;
  plan.kind = PlanKind::kOptimised;
  plan.stamp = 10.0;
  plan.certified = true;
  plan.committed = 2;
  for (int k = 0; k < 2; ++k) {
    plan.inputs.push_back(Eigen::Vector2d(0.4, 0.0));
    plan.commands.push_back({{0.4, 0, 0}, 0.0});
  }
  const Twist before{{0.4, 0, 0}, 0.0};
  EXPECT_TRUE(guard.check(plan, 0, before, belief, 10.0).passed());
  guard.set_zones(keep_out());
  const GuardVerdict forbidden = guard.check(plan, 0, before, belief, 10.0);
  EXPECT_EQ(forbidden.reason, GuardReason::kForbidden);
  EXPECT_EQ(to_string(forbidden.reason), "forbidden");
  EXPECT_NEAR(forbidden.command.linear.x(), 0.2, 1e-12) << "it brakes";
  belief.pose.position.x() = 0.9;
  guard.set_zones(slow(0.1));
  EXPECT_EQ(guard.check(plan, 0, before, belief, 10.0).reason, GuardReason::kSlowZone);
  guard.set_zones(slow(0.5));
  EXPECT_TRUE(guard.check(plan, 0, before, belief, 10.0).passed());
}

class SlowInputs : public ::testing::TestWithParam<std::string> {};

// Whatever is asked for, what the motors get is slow enough where it has to be, and the certificate
// says so.
TEST_P(SlowInputs, AreMadeSlowEnoughForTheCertificate) {
  const auto model = make_model(GetParam());
  const InputLimits& limits = model->limits();
  const auto zones = slow(0.2);
  const Certifier certifier(CylinderShape{}, certificate(zones));
  const Belief belief = ObstacleWorld(0.1, 8.0).belief();
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int slowed = 0;
  for (int sample = 0; sample < 100; ++sample) {
    ProblemDefinition d;
    d.model = model;
    const Pose pose{{-0.5 + 1.2 * unit(random), 0.8 * unit(random), 0.0}, 0.8 * unit(random)};
    Twist twist;
    // No faster than a robot is that has minded the zone so far.
    twist.linear.x() = std::min(0.9 * model->max_speed(),
                                0.9 * zones->approach_speed(pose.position.head<2>(), 0.2, 0.05));
    d.x0 = model->state(pose, twist);
    d.u_previous = model->input(twist).cwiseMax(limits.lower).cwiseMin(limits.upper);
    d.terms = {{std::make_shared<ControlEffort>(Eigen::VectorXd::Zero(model->nu()), limits), 1.0}};
    if (limits.rate.array().isFinite().any()) {
      d.terms.push_back({std::make_shared<RateLimit>(limits, d.M), 1.0});
    }
    if (model->num_state_constraints() > 0) {
      d.terms.push_back({std::make_shared<SpeedLimit>(*model), 1.0});
    }
    const Problem free(d);
    d.zones = zones;
    const Problem problem(d);
    Eigen::VectorXd z(problem.num_variables());
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      z[i] = i % model->nu() == 0 ? problem.upper()[i] : 0.3 * unit(random);
    }
    const Eigen::VectorXd kept = admissible_inputs(problem, z);
    slowed += kept != admissible_inputs(free, z);
    EXPECT_EQ(admissible_inputs(problem, kept), kept);
    const TrajectoryBatch t = problem.rollout(kept);
    Eigen::MatrixXd inputs(model->nu(), d.N);
    for (int k = 0; k < d.N; ++k) {
      for (int j = 0; j < model->nu(); ++j) inputs(j, k) = t.u(k, j, 0);
    }
    const Certificate verdict = certifier.certify(belief, *model, d.x0, d.u_previous, inputs, kDt);
    EXPECT_TRUE(verdict.ok()) << sample << ": " << verdict.detail;
  }
  EXPECT_GT(slowed, 30);
}

INSTANTIATE_TEST_SUITE_P(Models, SlowInputs,
                         ::testing::Values("unicycle", "unicycle_accel", "holonomic"));

TEST(ZoneEnforcement, ForbiddenPartsAreObstaclesToTheClearanceField) {
  ObstacleWorld world;
  for (int j = -40; j < 40; ++j) world.occupy_column(-12, j);
  ClearanceField::Options options;
  const ClearanceField plain({0, 0, 0.3}, world.voxels, world.ground, options);
  options.zones = keep_out();
  const ClearanceField field({0, 0, 0.3}, world.voxels, world.ground, options);
  int nearer = 0;
  for (int n = 0; n < field.frame().size(); ++n) {
    const Cell c = field.frame().at(n);
    const double forbidden = options.zones->distance(field.frame().center(c));
    const double expected = std::min(plain.node(c.i, c.j), std::max(forbidden, -options.cutoff));
    ASSERT_EQ(field.node(c.i, c.j), expected);
    nearer += expected < plain.node(c.i, c.j);
  }
  EXPECT_GT(nearer, 300);
  // Along the middle of a side the field is the distance itself.
  EXPECT_NEAR(field.distance({0.63, 0.02, 0.3}), 0.37, 1e-9);
  EXPECT_NEAR(field.distance({1.21, 0.02, 0.3}), -0.21, 1e-9);
}

TEST(ZoneEnforcement, ForbiddenCellsAreImpassableAndSlowOnesDear) {
  std::mt19937_64 random(7);
  Zones zones;
  zones.keep_out = {{{-0.5, -0.43}, {1.0, 0.2}, {0.2, 1.3}}};
  zones.bound = Polygon{{-3, -3}, {3.03, -3}, {3.03, 3}, {-3, 3}};
  zones.slow = {{{{-2, -2}, {-1, -2}, {-1, 2}, {-2, 2}}, 0.25}};
  TraversabilityOptions options;
  options.zones = map_of(zones);
  GroundMap map(GridFrame{0.1, -16, -16, 32, 32});
  Traversability kept{options};
  for (int step = 0; step < 5; ++step) {
    test::scribble(map, 40, 50, -25 - 4 * step, random);
    kept.update(map);
    Traversability anew{options}, without{TraversabilityOptions{}};
    anew.update(map);
    without.update(map);
    int forbidden = 0, dear = 0;
    for (int n = 0; n < kept.frame().size(); ++n) {
      const Cell c = kept.frame().at(n);
      ASSERT_EQ(kept.factor(c), anew.factor(c));
      ASSERT_EQ(kept.clearance(c), anew.clearance(c));
      const Eigen::Vector2d p = kept.frame().center(c);
      const double room = std::max(0.0, options.zones->distance(p));
      ASSERT_NEAR(kept.clearance(c), std::min(without.clearance(c), room),
                  1e-9 + (room < without.clearance(c) && room > 0.0 ? 0.08 : 0.0))
          << p.transpose();
      const bool passable =
          without.passable(c) && room + options.lattice_slack >= options.hard_radius;
      if (std::abs(room + options.lattice_slack - options.hard_radius) > 0.03) {
        ASSERT_EQ(kept.passable(c), passable) << p.transpose();
      }
      forbidden += without.passable(c) && !kept.passable(c);
      if (kept.passable(c) && options.zones->speed_limit(p) < 1.0 && room > 1.0) {
        ASSERT_EQ(kept.factor(c), 4.0F * without.factor(c));
        ++dear;
      }
    }
    EXPECT_GT(forbidden, 5);
    EXPECT_GT(dear, 5);
  }
}

TEST(ZoneEnforcement, UnknownCellsMayBeTravelledAtAPrice) {
  std::mt19937_64 random(8);
  TraversabilityOptions options;
  options.unknown_travel = 3.0;
  GroundMap map(GridFrame{0.1, -16, -16, 32, 32});
  Traversability kept{options};
  for (int step = 0; step < 5; ++step) {
    test::scribble(map, 30, 40, -18 - 8 * step, random);
    kept.update(map);
    Traversability anew{options}, without{TraversabilityOptions{}};
    anew.update(map);
    without.update(map);
    const GridFrame& f = kept.frame();
    for (int n = 0; n < f.size(); ++n) {
      const Cell c = f.at(n);
      if (map.state(c) != CellState::kUnknown) {
        ASSERT_EQ(kept.factor(c), without.factor(c));
        continue;
      }
      const bool rim =
          c.i == f.i0 || c.j == f.j0 || c.i == f.i0 + f.width - 1 || c.j == f.j0 + f.height - 1;
      const double room = test::slow_distance(map, c, CellState::kOccupied, 12) + 0.02 + 1e-9;
      const float expected = rim || room < options.hard_radius
                                 ? 0.0F
                                 : (room < options.comfortable_radius ? 12.0F : 3.0F);
      ASSERT_EQ(kept.factor(c), expected) << c.i << ", " << c.j;
    }
  }
}

TEST(ZoneEnforcement, FrontiersThatDoNotCountAreNoTargets) {
  // A room that opens to the east, where the map ends.
  const GroundMap map = test::known_room(80, [](int j) { return j > 15 && j < 40; });
  const Pose pose{{3.0, 2.5, 0.0}, 0.0};
  FrontierPlannerOptions options;
  const auto target = [&] {
    FrontierPlanner frontier_planner(options);
    return frontier_planner.update(map, pose, 0.0)->target.has_value();
  };
  EXPECT_TRUE(target());
  options.area = Polygon{{0, 0}, {6, 0}, {6, 5}, {0, 5}};
  EXPECT_FALSE(target()) << "it lies outside the area";
  options.area = Polygon{{6, 0}, {9, 0}, {9, 5}, {6, 5}};
  EXPECT_TRUE(target()) << "the robot may come from outside of it";
  options.area.reset();
  Zones zones;
  zones.bound = Polygon{{0, 0}, {6.6, 0}, {6.6, 5}, {0, 5}};
  options.traversability.zones = map_of(zones);
  EXPECT_FALSE(target()) << "beyond the bound";
  zones.bound = Polygon{{0, 0}, {9, 0}, {9, 5}, {0, 5}};
  zones.keep_out = {{{4.5, 0}, {5.5, 0}, {5.5, 5}, {4.5, 5}}};
  options.traversability.zones = map_of(zones);
  // What is behind a keep-out may be looked at from before it, not from the other side.
  FrontierPlanner frontier_planner(options);
  const auto g = frontier_planner.update(map, pose, 0.0);
  ASSERT_TRUE(g->target);
  EXPECT_LT(g->target->viewpoint.x(), 4.5);
}

}  // namespace
}  // namespace prospect::zone_enforcement_test
