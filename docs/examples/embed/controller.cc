// A robot controller with Prospect inside. The robot has its own localization and its own OctoMap;
// it hands both over at each step, and gets back the velocity to drive next and the reason for it.
#include <octomap/OcTree.h>

#include <cmath>
#include <cstdio>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "engine/safety/guard.h"
#include "models/unicycle.h"
#include "solvers/registry.h"

// What is there: a room of 9 x 4 m with a box in the way.
bool occupied(double x, double y) {
  const bool wall = x < -0.95 || x > 7.95 || y < -1.95 || y > 1.95;
  return wall || (x > 1.5 && x < 2.0 && y > -0.3 && y < 0.5);
}

// What a lidar adds to the robot's map, where a real one would enter its own scans.
void look_around(const prospect::Pose& pose, double range, octomap::OcTree& tree) {
  for (double angle = 0.0; angle < 2.0 * M_PI; angle += 0.01) {
    bool hit = false;
    for (double d = 0.0; d < range && !hit; d += 0.05) {
      const octomap::OcTreeKey at = tree.coordToKey(pose.position.x() + d * std::cos(angle),
                                                    pose.position.y() + d * std::sin(angle), 0.0);
      const octomap::point3d center = tree.keyToCoord(at);
      hit = occupied(center.x(), center.y());
      for (float z = 0.05F; z < 0.9F; z += 0.1F) {
        tree.updateNode(center.x(), center.y(), z, hit);
      }
    }
  }
}

int main() {
  // The robot: how it moves, its body, what its sensor sees. The rest are the defaults.
  prospect::RobotDescription robot;
  robot.model = std::make_shared<prospect::Unicycle>();
  robot.shape = prospect::CylinderShape{.center = {0, 0, 0.3}, .radius = 0.18, .height = 0.4};
  robot.depth.horizontal_fov = 2.0 * M_PI;  // all round
  robot.depth.max_range = 3.0;
  prospect::Planner planner(robot, prospect::PlannerParameters(), prospect::make_solver("nlopt"));
  const prospect::Guard guard = planner.make_guard();

  // What it knows. Its localization is its own: no visual features are needed, and none cost
  // anything. A robot with visual odometry passes its landmarks instead.
  prospect::Belief belief;
  belief.localization_source = prospect::LocalizationSource::kExternal;
  belief.command = prospect::Twist();  // in force: nothing yet
  octomap::OcTree tree(0.1);

  // The control loop; here the robot does exactly as it is told.
  for (int step = 0; step < 40; ++step) {
    // The maps that planning needs are derived from a copy of the tree as it is now, between the
    // floor and the top of the body.
    look_around(belief.pose, robot.depth.max_range, tree);
    const prospect::BeliefMaps maps = prospect::belief_maps(std::make_shared<octomap::OcTree>(tree),
                                                            height_slice(robot), 0.0, 1.0);
    belief.octree = maps.octree, belief.voxels = maps.voxels, belief.ground = maps.ground;

    const prospect::Plan plan = planner.plan(belief);  // never throws, always executable
    const prospect::GuardVerdict verdict =
        guard.check(plan, 0, *belief.command, belief, belief.stamp);  // nothing passes unchecked
    const prospect::Twist& v = verdict.command;
    std::printf(
        "%5.2f s: knows %.1f m2; %.3f m/s, %+.3f rad/s, because: %s plan from '%s', %s; "
        "guard %s\n",
        belief.stamp, planner.global_plan()->explored_area, v.linear.x(), v.yaw_rate,
        to_string(plan.kind).data(), plan.seed.c_str(), plan.certificate.c_str(),
        to_string(verdict.reason).data());
    if (plan.kind == prospect::PlanKind::kStoppingTail) {
      std::printf("    a stop: %s\n", plan.detail.c_str());
    }
    for (const prospect::TermValue& term : plan.explanation.terms) {
      if (!term.constraint && step % 10 == 0) {
        std::printf("    %-18s %+.3f\n", term.name.c_str(), term.weighted);
      }
    }
    if (plan.mode.kind == prospect::ModeKind::kDone) break;
    Eigen::VectorXd next(robot.model->nx());
    robot.model->step(robot.model->state(belief.pose, v), robot.model->input(v), plan.dt, next);
    belief.pose = robot.model->pose(next);
    belief.twist = v;
    belief.command = v;
    belief.set_stamps(belief.stamp + plan.dt);
  }
}
