// SPDX-License-Identifier: Apache-2.0
#include "models/robot_description.h"

#include <gtest/gtest.h>

#include <memory>

#include "engine/maps/map_projection.h"
#include "engine/planner/frontier_planner_options.h"
#include "engine/planner/planner.h"
#include "models/make_model.h"
#include "tests/engine/planning_scene.h"
#include "tests/engine/room_belief.h"

namespace prospect::robot_description_test {
namespace {

RobotDescription raised(const std::string& model, double fixed_z) {
  RobotDescription robot;
  robot.model = make_model(model, {{"fixed_z", fixed_z}});
  robot.shape = BoxShape{{0.0, 0.0, 0.25}, {0.3, 0.3, 0.3}};  // 0.1 to 0.4 m above B's origin
  return robot;
}

TEST(RobotDescription, TheSliceIsTheBodyRaisedToWhereItsOriginStands) {
  for (const std::string model : {"unicycle", "unicycle_accel", "holonomic"}) {
    for (const double z : {0.0, 0.8, -0.05}) {
      const RobotDescription robot = raised(model, z);
      EXPECT_EQ(robot.base_height(), z);
      EXPECT_NEAR(robot.slice().z_min, z + 0.1, 1e-12);
      EXPECT_NEAR(robot.slice().z_max, z + 0.4, 1e-12);
      const HeightSlice height = height_slice(robot);
      EXPECT_EQ(height.z_min, robot.slice().z_min);
      EXPECT_EQ(height.z_max, robot.slice().z_max);
      EXPECT_NEAR(height.sight.value(), z + 0.45, 1e-12);
    }
  }
  RobotDescription flying;
  flying.model = make_model("multirotor");
  EXPECT_NEAR(flying.slice().z_min, 0.1, 1e-12);
  EXPECT_EQ(flying.base_height(), 0.0);
}

// Frontiers are looked at by what lies about the first sensor's axis without a gap.
TEST(RobotDescription, FrontiersAreLookedAtByTheSensorsThatJoinTheFirst) {
  constexpr double kDegree = M_PI / 180.0;
  const auto sensor = [&](double fov, double yaw, double range = 4.0) {
    return DepthSensor{RgbdFootprint{fov * kDegree, 0.9, 0.3, range},
                       {CameraMount::forward_facing({0.0, 0.0, 0.45}, yaw * kDegree)}};
  };
  struct Row {
    std::vector<DepthSensor> sensors;  // the first one, then the others
    double field;                      // [deg]
  };
  const Row rows[] = {
      {{sensor(70, 0)}, 70},
      {{sensor(70, 0), sensor(70, 180)}, 70},
      {{sensor(70, 180), sensor(70, 0)}, 70},
      {{sensor(70, 0), sensor(70, 60)}, 70},
      {{sensor(70, 0), sensor(70, 60), sensor(70, -60)}, 190},
      {{sensor(70, 90), sensor(70, 150), sensor(70, 30)}, 190},
      {{sensor(70, 0), sensor(70, 120), sensor(70, -120), sensor(70, 60), sensor(70, -60)}, 310},
      {{sensor(120, 0), sensor(125, 120), sensor(125, -120)}, 360},
      {{sensor(70, 0), sensor(360, 0)}, 360},
      {{sensor(70, 0), sensor(360, 0, 3.0)}, 70},
      {{sensor(360, 0), sensor(70, 0, 9.0)}, 360}};
  int n = 0;
  for (const Row& row : rows) {
    RobotDescription robot = raised("unicycle", 0.0);
    robot.depth = row.sensors.front().footprint;
    robot.depth_mount = row.sensors.front().mount;
    robot.more_depth.assign(row.sensors.begin() + 1, row.sensors.end());
    const FrontierPlannerOptions options = frontier_planner_options_for(robot, PlannerParameters());
    EXPECT_NEAR(options.utility.sensor_fov, row.field * kDegree, 1e-9) << n;
    EXPECT_EQ(options.frontiers.sensor_range, robot.depth.max_range) << n++;
  }
}

// The planner certified 0.9 to 1.3 m for a body that its guard and the simulator had at 0.1 to 0.5.
TEST(RobotDescription, PlannerAndGuardAskForTheSameSlice) {
  const RobotDescription robot = raised("unicycle", 0.8);
  Planner planner(robot, PlannerParameters(), std::make_shared<test::IdleSolver>());
  const auto belief_with = [&](double low, double high) {
    auto tree = std::make_shared<octomap::OcTree>(0.1);
    for (int i = -10; i < 30; ++i) {
      for (int j = -10; j < 10; ++j) {
        for (int k = 0; k < 15; ++k) {
          const double z = 0.1 * (k + 0.5);
          const bool bar = i == 4 && z > low && z < high;
          tree->updateNode(
              octomap::point3d(0.1F * (i + 0.5F), 0.1F * (j + 0.5F), static_cast<float>(z)), bar);
        }
      }
    }
    const BeliefMaps maps = belief_maps(tree, height_slice(robot), 0.0, 1.5);
    Belief belief;
    belief.octree = maps.octree;
    belief.voxels = maps.voxels;
    belief.ground = maps.ground;
    belief.landmarks = std::make_shared<const LandmarkMap>();
    belief.pose.position.z() = 0.8;
    return belief;
  };
  const Guard guard = planner.make_guard();
  const auto verdict = [&](const Belief& belief) {
    Plan plan;
    plan.kind = PlanKind::kOptimised;
    plan.certified = true;
    plan.committed = 2;
    Twist before;
    before.linear.x() = 0.5;
    for (int k = 0; k < 2; ++k) {
      plan.inputs.push_back(Eigen::Vector2d(0.5, 0.0));
      plan.commands.push_back(before);
    }
    return guard.check(plan, 0, before, belief, 0.0);
  };
  const Belief at_body = belief_with(1.0, 1.1), below = belief_with(0.2, 0.5);
  EXPECT_EQ(verdict(at_body).reason, GuardReason::kMap);
  EXPECT_TRUE(verdict(below).passed()) << verdict(below).detail;
  planner.plan(below);
  ASSERT_NE(planner.specification(), nullptr);
  EXPECT_EQ(planner.specification()->clearance_field.slice.z_min, robot.slice().z_min);
  EXPECT_EQ(planner.specification()->clearance_field.slice.z_max, robot.slice().z_max);
}

}  // namespace
}  // namespace prospect::robot_description_test
