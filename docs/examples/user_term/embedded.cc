// SPDX-License-Identifier: Apache-2.0
// The term in a planner of one's own program: a robot before a gap with a person beyond plans with
// the term and without it, and keeps farther away with it.
#include <octomap/OcTree.h>

#include <cstdio>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/planner/set_term.h"
#include "keep_distance.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

// An empty hall of 6 x 6 m that the robot knows up to x = 2.5 m.
prospect::Belief hall(const prospect::RobotDescription& robot) {
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  for (float x = -2.95F; x < 2.5F; x += 0.1F) {
    for (float y = -2.95F; y < 3.0F; y += 0.1F) {
      const bool wall = x < -2.9F || y < -2.9F || y > 2.9F;
      for (float z = 0.05F; z < 0.9F; z += 0.1F) tree->updateNode(x, y, z, wall);
    }
  }
  const prospect::BeliefMaps maps = prospect::belief_maps(tree, height_slice(robot), 0.0, 1.0);
  prospect::Belief belief;
  belief.octree = maps.octree, belief.voxels = maps.voxels, belief.ground = maps.ground;
  belief.localization_source = prospect::LocalizationSource::kExternal;
  belief.command = prospect::Twist();
  return belief;
}

int main() {
  prospect::RobotDescription robot;
  robot.model = std::make_shared<prospect::Unicycle>();
  const prospect::Belief belief = hall(robot);

  prospect::TermEntry entry{"keep_distance", "closeness to a point, such as a person"};
  entry.options.assign(std::begin(kKeepDistanceOptions), std::end(kKeepDistanceOptions));
  entry.make = [](const prospect::TermOptions& options, const prospect::TermContext& context) {
    return std::shared_ptr<const prospect::Term>(make_keep_distance(options, context));
  };
  prospect::TermRegistry registry;
  registry.add(entry);

  double nearest[2];
  for (const bool with : {false, true}) {
    prospect::PlannerParameters parameters;
    const Eigen::Vector2d person(0.9, 0.1);
    if (with) {
      set_term(parameters,
               registry.use("keep_distance", 5.0, {{"x", person.x()}, {"y", person.y()}}));
    }
    prospect::Planner planner(robot, parameters, prospect::make_solver("nlopt"));
    const prospect::Plan plan = planner.plan(belief);
    nearest[with] = 1e9;
    for (const Eigen::VectorXd& x : plan.states) {
      nearest[with] =
          std::min(nearest[with], (robot.model->pose(x).position.head<2>() - person).norm());
    }
    for (const prospect::TermValue& term : plan.explanation.terms) {
      if (!term.constraint) std::printf("    %-18s %+.3f\n", term.name.c_str(), term.weighted);
    }
    std::printf("%s the term: comes to %.2f m from the person; %s\n", with ? "with" : "without",
                nearest[with], plan.detail.c_str());
  }
  return nearest[true] > nearest[false] + 0.05 ? 0 : 1;
}
