// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "engine/planner/planner.h"
#include "tests/engine/planning_scene.h"

namespace prospect::test {

/// A planner's specification for one way of planning.
struct NamedSpecification {
  std::string name;
  std::shared_ptr<const ProblemSpecification> specification;
  std::shared_ptr<const Problem>
      problem;  ///< as the planner has it: from evaluators of earlier steps
  std::vector<Seed> seeds;
};

/// The problem that a planner meets at its third step in the half-explored hall of PlanningScene.
inline NamedSpecification specification_of(const std::string& name, std::string_view model,
                                           const PlannerParameters& parameters, int landmarks = 120,
                                           Localization localization = Localization::kOk,
                                           const RobotShape& shape = CylinderShape{},
                                           const std::vector<DepthSensor>& more_depth = {},
                                           const std::vector<Mover>& movers = {}) {
  PlanningScene scene(model, parameters, landmarks);
  RobotDescription robot = scene.planner->robot();
  robot.shape = shape;
  robot.more_depth = more_depth;
  Planner planner(robot, parameters, std::make_shared<IdleSolver>());
  Belief belief = scene.belief;
  if (!movers.empty()) belief.movers = std::make_shared<const Movers>(Movers{0.0, movers});
  for (int step = 0; step < 3; ++step) {
    belief.stamp = 0.5 * step;
    belief.pose.position.x() = 0.07 * step;
    belief.pose.yaw = 0.4 + 0.1 * step;
    if (step == 2) belief.localization = localization;
    planner.plan(belief);
  }
  return {name, planner.specification(), planner.problem(), planner.seeds()};
}

/// Every motion model, and every term and option that a problem may or may not have.
inline std::vector<NamedSpecification> specifications_of_every_kind() {
  PlannerParameters small;  // so that the maps are larger than what a problem looks at
  small.N = 8;
  small.M = 4;
  small.committed = 0.5;
  small.visibility.r_max = 3.0;
  small.max_targets = 40;
  std::vector<NamedSpecification> all;
  for (const std::string& model : model_names()) {
    all.push_back(specification_of(model, model, small));
  }
  const auto with = [&](const std::string& name, auto change, auto... more) {
    PlannerParameters p = small;
    change(p);
    all.push_back(specification_of(name, "unicycle", p, more...));
  };
  with("heading alignment", [](auto& p) { p.weights.heading_alignment = 0.3; });
  with("chance", [](auto& p) { p.w_c = 0.4; });
  with("information", [](auto& p) { p.features.criterion = VisibilityCriterion::kInformation; });
  with("no prior", [](auto& p) { p.feature_prior = false; });
  with("unknown is free", [](auto& p) { p.unknown = UnknownPolicy::kFree; });
  with("unknown is blocked", [](auto& p) { p.unknown = UnknownPolicy::kBlocked; });
  with("zones", [](auto& p) {
    p.zones.bound = Polygon{{-2, -6}, {3, -6}, {3, 6}, {-2, 6}};
    p.zones.keep_out = {{{0.8, -0.6}, {1.4, -0.3}, {0.9, 0.5}}};
    p.zones.slow = {{{{-1, 0.3}, {1, 0.3}, {1, 2}, {-1, 2}}, 0.15}};
  });
  with("no targets", [](auto& p) { p.max_targets = 0; });
  with(
      "no landmarks", [](auto&) {}, 0);
  with("no weights", [](auto& p) {
    p.weights.control_effort = p.weights.input_rate = p.weights.obstacles =
        p.weights.visible_features = p.weights.exploration_gain = p.weights.cost_to_go = 0.0;
  });
  with(
      "recovery", [](auto&) {}, 120, Localization::kDegraded);
  with(
      "box", [](auto&) {}, 120, Localization::kOk, BoxShape{{0.05, 0, 0.3}, {0.5, 0.3, 0.4}});
  with(
      "spheres", [](auto&) {}, 120, Localization::kOk,
      SphereSetShape{{{{0.1, 0, 0.3}, 0.15}, {{-0.1, 0, 0.3}, 0.17}}});
  with(
      "hull", [](auto&) {}, 120, Localization::kOk,
      ConvexShape{{{0.2, 0, 0.15}, {-0.2, 0.15, 0.15}, {-0.2, -0.15, 0.15}, {0, 0, 0.5}}});
  with(
      "two depth sensors", [](auto&) {}, 120, Localization::kOk, CylinderShape{},
      std::vector<DepthSensor>{{RgbdFootprint{2.0 * M_PI, 0.0, 0.1, 6.0},
                                {CameraMount::forward_facing({-0.1, 0.0, 0.3}, M_PI)}}});
  with(
      "movers", [](auto&) {}, 120, Localization::kOk, CylinderShape{}, std::vector<DepthSensor>{},
      std::vector<Mover>{{{0.9, 0.2}, {-0.3, 0.4}, 0.3, 0.2}, {{0.5, -0.8}, {0, 0}, 0.2, 0.3}});
  return all;
}

}  // namespace prospect::test
