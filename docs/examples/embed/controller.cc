// A robot controller with Prospect inside. The robot has its own localization and its own OctoMap;
// it hands both over, and gets back the velocity to drive next and the reason for it.
#include <octomap/OcTree.h>

#include <cstdio>

#include "engine/guard.h"
#include "engine/map_projection.h"
#include "engine/planner.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

// What the robot has seen so far, where a real one would pass its own tree: a room that is 6 m
// deep, of which the first 3 m are known, with a box in the way.
std::shared_ptr<const octomap::OcTree> map_so_far() {
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  for (float x = -0.95F; x < 3.0F; x += 0.1F) {
    for (float y = -1.95F; y < 2.0F; y += 0.1F) {
      const bool wall = x < -0.9F || y < -1.9F || y > 1.9F;
      const bool box = x > 1.5F && x < 2.0F && y > -0.3F && y < 0.5F;
      for (float z = 0.05F; z < 1.0F; z += 0.1F) tree->updateNode(x, y, z, wall || box);
    }
  }
  return tree;
}

int main() {
  // The robot: how it moves, its body, where its cameras sit. The defaults are a small base.
  prospect::RobotDescription robot;
  robot.model = std::make_shared<prospect::Unicycle>();
  robot.shape = prospect::CylinderShape{.center = {0, 0, 0.3}, .radius = 0.18, .height = 0.4};
  prospect::Planner planner(robot, prospect::PlannerParameters(), prospect::make_solver("nlopt"));
  const prospect::Guard guard = planner.make_guard();

  // What it knows: the maps that planning needs are derived from the octree, at the heights that
  // the body sweeps. A robot with visual odometry also passes its landmarks.
  prospect::Belief belief;
  const prospect::BeliefMaps maps =
      prospect::belief_maps(map_so_far(), height_slice(robot), 0.0, 1.0);
  belief.octree = maps.octree, belief.voxels = maps.voxels, belief.ground = maps.ground;
  belief.landmarks = std::make_shared<prospect::LandmarkMap>();

  belief.command = prospect::Twist();  // in force: nothing yet
  belief.set_stamps(0.0);              // what each source is of; the guard refuses what is old

  // The control loop; here the robot does exactly as it is told.
  for (int step = 0; step < 5; ++step) {
    const prospect::Plan plan = planner.plan(belief);  // never throws, always executable
    const prospect::GuardVerdict verdict =
        guard.check(plan, 0, *belief.command, belief, belief.stamp);  // nothing passes unchecked
    const prospect::Twist& v = verdict.command;
    std::printf("%.2f s: %.3f m/s, %+.3f rad/s, because: %s plan from '%s', %s; guard %s\n",
                belief.stamp, v.linear.x(), v.yaw_rate, to_string(plan.kind).data(),
                plan.seed.c_str(), plan.certificate.c_str(), to_string(verdict.reason).data());
    for (const prospect::TermValue& term : plan.explanation.terms) {
      if (!term.constraint) std::printf("    %-18s %+.3f\n", term.name.c_str(), term.weighted);
    }
    Eigen::VectorXd next(robot.model->nx());
    robot.model->step(robot.model->state(belief.pose, v), robot.model->input(v), plan.dt, next);
    belief.pose = robot.model->pose(next);
    belief.twist = v;
    belief.command = v;
    belief.set_stamps(belief.stamp + plan.dt);
  }
}
