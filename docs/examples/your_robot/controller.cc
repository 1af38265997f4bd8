// SPDX-License-Identifier: Apache-2.0
// A robot of one's own: a 2-D lidar, a localization that needs no camera, an OctoMap that grows
// while the robot drives. Prospect plans and watches behind five calls.
#include <octomap/OcTree.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <thread>

#include "engine/maps/map_projection.h"
#include "engine/planner/planner.h"
#include "models/make_model.h"
#include "pretend_robot.h"
#include "runtime/driver.h"
#include "solvers/registry.h"

prospect::RobotDescription my_robot() {
  prospect::RobotDescription robot;
  // How it moves: a base with two driven wheels that may also reverse slowly.
  robot.model = prospect::make_model("unicycle", {{"v_min", -0.1},       // [m/s]
                                                  {"v_max", 0.5},        // [m/s]
                                                  {"omega_max", 1.0},    // [rad/s]
                                                  {"a_max", 0.8},        // [m/s^2]
                                                  {"alpha_max", 2.5}});  // [rad/s^2]
  // Its body in frame B: x forward, y left, z up; B's origin is on the floor, between the wheels.
  robot.shape = prospect::CylinderShape{.center = {0, 0, 0.25}, .radius = 0.2, .height = 0.4};
  // What sees new space: a lidar of one layer, all round, 0.3 m above the floor.
  robot.depth.horizontal_fov = 2.0 * M_PI;
  robot.depth.vertical_fov = 0.0;
  robot.depth.min_range = 0.1;
  robot.depth.max_range = 5.0;
  robot.depth_mount.T_BC = prospect::CameraMount::forward_facing({0.0, 0.0, 0.3});
  return robot;
}

// Enters a turn of the lidar into the map. A ray without an echo clears as far as the range.
void add_scan(const std::vector<double>& ranges, const prospect::Pose& pose,
              const prospect::RobotDescription& robot, octomap::OcTree& tree) {
  const double height = robot.base_height() + robot.depth_mount.T_BC.translation().z();
  const octomap::point3d origin(static_cast<float>(pose.position.x()),
                                static_cast<float>(pose.position.y()), static_cast<float>(height));
  octomap::Pointcloud points;
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const double angle = pose.yaw + 2.0 * M_PI * static_cast<double>(i) / 720.0;
    const double range = std::min(ranges[i], 2.0 * robot.depth.max_range);
    points.push_back(origin.x() + static_cast<float>(range * std::cos(angle)),
                     origin.y() + static_cast<float>(range * std::sin(angle)), origin.z());
  }
  tree.insertPointCloud(points, origin, robot.depth.max_range);
}

// What is known: the pose, the velocity, and the maps, made from a copy of the tree, so that the
// tree may grow while the planner works.
std::shared_ptr<const prospect::Belief> belief_at(double stamp, const PretendRobot& base,
                                                  const prospect::RobotDescription& robot,
                                                  const octomap::OcTree& tree) {
  auto belief = std::make_shared<prospect::Belief>();
  belief->localization_source = prospect::LocalizationSource::kExternal;  // features cost nothing
  belief->set_stamps(stamp);
  belief->pose = base.pose();
  belief->twist = base.velocity();
  const double top = robot.slice().z_max + 0.1;
  const prospect::BeliefMaps maps =
      prospect::belief_maps(std::make_shared<octomap::OcTree>(tree), height_slice(robot), 0.0, top);
  belief->octree = maps.octree, belief->voxels = maps.voxels, belief->ground = maps.ground;
  return belief;
}

// Whoever watches the mission: on the planner's thread, after each step.
class Printed final : public prospect::MissionObserver {
  void on_step(const prospect::MissionStep& step) override {
    std::printf("%5.2f s: knows %.1f m2; %s\n", step.time, step.global_plan->explored_area,
                step.plan->why.c_str());
  }
};

int main() {
  const prospect::RobotDescription robot = my_robot();
  prospect::PlannerParameters parameters;
  parameters.dt = 0.25;         // a stage [s]: how long a command is held
  parameters.N = 20;            // stages: a plan looks 5 s ahead
  parameters.committed = 0.75;  // certified [s]: three stages, so the next plan may be two late
  parameters.weights.visible_features = 0.0;  // no camera, so no features to keep in view
  parameters.map_resolution = 0.1;  // of the maps to come [m]: what does not fit is refused now
  prospect::Planner planner(robot, parameters, prospect::make_solver("nlopt"));
  prospect::Guard::Options limits;
  limits.max_landmarks_age = std::numeric_limits<double>::infinity();  // there are none
  const prospect::Guard guard = planner.make_guard(limits);

  const prospect::SteadyClock clock;
  PretendRobot base;
  Printed printed;
  prospect::MissionOptions mission;
  mission.time_limit = 25.0;  // [s]
  mission.observers = {&printed};
  const prospect::PreflightResult checked{.checks = {}, .yaw_checked = true};  // pretended
  prospect::Driver driver(
      {.clock = clock, .guard = guard, .model = robot.model, .dead_man = PretendRobot::kDeadMan},
      planner, checked, {}, mission);

  std::jthread planning([&](const std::stop_token& stop) {
    while (driver.advance(stop)) {
    }
  });
  octomap::OcTree tree(0.1);
  bool touched = false;
  const double start = clock.now();
  for (int tick = 0; !driver.at_rest(); ++tick) {
    if (tick % 4 == 0) {  // five times a second
      const double now = clock.now();
      add_scan(base.scan(base.pose(), robot.depth.max_range), base.pose(), robot, tree);
      driver.observe(belief_at(now, base, robot, tree));
    }
    const prospect::CommandStep step = driver.command({true, clock.now(), base.velocity(), {}, {}});
    base.drive(step.stop ? prospect::Twist() : step.command, step.expires);
    touched = touched || base.touches(0.2);
    clock.wait_until(start + 0.05 * (tick + 1), {});
  }
  planning.join();

  const prospect::MissionResult result = driver.finish();
  for (const prospect::Event& event : driver.events().since(0).events) {
    std::printf("%s\n", to_text(event).c_str());
  }
  std::printf("%s late plans: %d; commands replaced by the guard: %d; %s a wall\n",
              result.detail.c_str(), driver.status().late_plans, result.guard_stops,
              touched ? "touched" : "did not touch");
  return touched ? 1 : 0;
}
