// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/config/configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "models/knobs.h"

namespace prospect::configuration_test {
namespace {

using ::testing::HasSubstr;

Configuration read(const std::string& text) { return configuration_from_text(text, "f.yaml"); }

/// All problems, one a line; "" if there is none.
std::string problems(const std::string& text) {
  try {
    read(text);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Configuration, OfNothingIsTheDefaults) {
  const Configuration c = read("");
  EXPECT_EQ(c.solver, "nlopt");
  EXPECT_EQ(c.robot.model->name(), "unicycle");
  EXPECT_EQ(c.planner.N, PlannerParameters().N);
  EXPECT_EQ(c.planner.weights.visible_features, PlannerParameters().weights.visible_features);
  EXPECT_EQ(c.planner.d_safe, PlannerParameters().d_safe);
  EXPECT_EQ(c.planner.frontier_planner.frontiers.min_length, FrontierOptions().min_length);
  EXPECT_EQ(c.mission.time_limit, MissionOptions().time_limit);
  EXPECT_TRUE(std::holds_alternative<CylinderShape>(c.robot.shape));
}

TEST(Configuration, EveryShapeOfRobot) {
  const Configuration cylinder =
      read("robot: {shape: {type: cylinder, radius: 0.25, height: 0.6, center: [0.1, 0, 0.35]}}");
  const auto& c = std::get<CylinderShape>(cylinder.robot.shape);
  EXPECT_EQ(c.radius, 0.25);
  EXPECT_EQ(c.height, 0.6);
  EXPECT_EQ(c.center, Eigen::Vector3d(0.1, 0.0, 0.35));

  const Configuration box =
      read("robot: {shape: {type: box, size: [0.5, 0.3, 0.4], center: [0.05, 0, 0.25]}}");
  const auto& b = std::get<BoxShape>(box.robot.shape);
  EXPECT_EQ(b.size, Eigen::Vector3d(0.5, 0.3, 0.4));
  EXPECT_EQ(b.center, Eigen::Vector3d(0.05, 0.0, 0.25));

  const Configuration spheres = read(
      "robot: {shape: {type: spheres, spheres: [{center: [0.1, 0, 0.3], radius: 0.2},"
      " {center: [-0.1, 0, 0.3], radius: 0.15}]}}");
  const auto& s = std::get<SphereSetShape>(spheres.robot.shape);
  ASSERT_EQ(s.spheres.size(), 2u);
  EXPECT_EQ(s.spheres[1].center, Eigen::Vector3d(-0.1, 0.0, 0.3));
  EXPECT_EQ(s.spheres[1].radius, 0.15);

  const Configuration convex = read(
      "robot: {shape: {type: convex, vertices: [0.2, 0, 0.1, -0.2, 0.1, 0.1, -0.2, -0.1, 0.1,"
      " 0, 0, 0.5]}}");
  const auto& v = std::get<ConvexShape>(convex.robot.shape);
  ASSERT_EQ(v.vertices.size(), 4u);
  EXPECT_EQ(v.vertices[3], Eigen::Vector3d(0.0, 0.0, 0.5));
}

TEST(Configuration, EveryMotionModelWithItsParameters) {
  for (const char* name : {"unicycle", "unicycle_accel", "holonomic", "multirotor"}) {
    EXPECT_EQ(read(std::string("robot: {model: ") + name + "}").robot.model->name(), name);
  }
  const Configuration c = read("robot: {model: unicycle, motion: {v_max: 0.9, omega_max: 0.5}}");
  EXPECT_EQ(c.robot.model->max_speed(), 0.9);
  EXPECT_EQ(c.robot.model->max_yaw_rate(), 0.5);
  EXPECT_THAT(problems("robot: {model: unicycle, motion: {vz_max: 1}}"),
              HasSubstr("f.yaml:1: unknown key 'robot.motion.vz_max'"));
}

TEST(Configuration, TheSimulatedBodyStandsWhereThePlannedOneDoes) {
  const Configuration c = read("robot: {model: holonomic, motion: {fixed_z: 0.8}}");
  EXPECT_EQ(c.robot.base_height(), 0.8);
  EXPECT_EQ(c.simulator.base_height, 0.8);
}

TEST(Configuration, PartsOfThePredictionCanBeLeftOut) {
  EXPECT_TRUE(read("").planner.feature_occlusion);
  EXPECT_TRUE(read("").planner.feature_covariance);
  EXPECT_FALSE(read("planner: {visibility: {feature_occlusion: false}}").planner.feature_occlusion);
  EXPECT_FALSE(
      read("planner: {visibility: {feature_covariance: false}}").planner.feature_covariance);
}

TEST(Configuration, UtilityAndOrderOfFrontiersAndTheEndOfAMission) {
  const Configuration c = read(
      "planner: {frontiers: {depth: 1.5, opening: 0.3, patience: 10, commitment: 0.5, "
      "narrow_factor: 50}}\nmission: {end: {least_area: 0.5, least_rate: 0.1}}");
  const FrontierPlannerOptions& g = c.planner.frontier_planner;
  EXPECT_EQ(g.utility.depth, 1.5);
  EXPECT_EQ(g.utility.opening, 0.3);
  EXPECT_EQ(g.order.patience, 10.0);
  EXPECT_EQ(g.commitment, 0.5);
  EXPECT_EQ(g.traversability.narrow_factor, 50.0);
  EXPECT_EQ(g.least_area, 0.5);
  EXPECT_EQ(g.least_rate, 0.1);
  EXPECT_THAT(problems("mission: {end: {least_rate: -1}}"),
              HasSubstr("f.yaml:1: mission.end.least_rate"));
}

TEST(Configuration, AnglesAreInDegrees) {
  const Configuration c = read(
      "robot: {depth: {horizontal_fov: 90, mount: {position: [0.1, 0, 0.5], yaw: 90, pitch: 30}}}");
  EXPECT_NEAR(c.robot.depth.horizontal_fov, M_PI / 2.0, 1e-12);
  // The optical axis is C's z.
  const Eigen::Vector3d axis = c.robot.depth_mount.T_BC.linear().col(2);
  EXPECT_NEAR(axis.x(), 0.0, 1e-12);
  EXPECT_NEAR(axis.y(), std::cos(M_PI / 6.0), 1e-12);
  EXPECT_NEAR(axis.z(), -0.5, 1e-12);
  EXPECT_EQ(c.robot.depth_mount.T_BC.translation(), Eigen::Vector3d(0.1, 0.0, 0.5));
}

/// Of both, to the bit.
void expect_same_cameras(const Configuration& a, const Configuration& b) {
  const StereoCamera &p = a.robot.stereo, &q = b.robot.stereo;
  EXPECT_EQ(p.left.fx, q.left.fx);
  EXPECT_EQ(p.left.cx, q.left.cx);
  EXPECT_EQ(p.left.cy, q.left.cy);
  EXPECT_EQ(p.baseline, q.baseline);
  EXPECT_EQ(a.robot.depth.horizontal_fov, b.robot.depth.horizontal_fov);
  EXPECT_EQ(a.robot.stereo_mount.T_BC.matrix(), b.robot.stereo_mount.T_BC.matrix());
  EXPECT_EQ(a.robot.depth_mount.T_BC.matrix(), b.robot.depth_mount.T_BC.matrix());
  EXPECT_EQ(a.simulator.features.stereo.left.cx, b.simulator.features.stereo.left.cx);
  EXPECT_EQ(a.simulator.stereo_mount.T_BC.matrix(), b.simulator.stereo_mount.T_BC.matrix());
  EXPECT_EQ(a.simulator.depth.footprint.horizontal_fov, b.simulator.depth.footprint.horizontal_fov);
}

// What a base tells of its cameras stands above the file, and the entries say so.
TEST(Configuration, TheCamerasAreAsTheyAreTold) {
  Configuration c =
      read("robot: {stereo: {baseline: 0.2, mount: {yaw: 5}}, depth: {vertical_fov: 44.7}}");
  RobotDescription told = c.robot;
  told.stereo.left.cx = 319.5;
  told.stereo.left.fx = 451.23456789012345;
  told.depth.horizontal_fov = 1.0768;
  told.depth_mount = {CameraMount::forward_facing({0.1, 0.0, 0.4}, 0.3, 0.2, -0.1)};
  const double fov = c.robot.depth.vertical_fov;
  set_cameras(c, told, "the cameras");
  EXPECT_EQ(c.robot.stereo.left.cx, 319.5);
  EXPECT_EQ(c.robot.stereo.left.fx, 451.23456789012345);
  EXPECT_EQ(c.robot.stereo.baseline, 0.2);
  EXPECT_EQ(c.robot.depth.vertical_fov, fov);
  EXPECT_EQ(c.robot.stereo_mount.T_BC.matrix(),
            CameraMount::forward_facing({0.0, 0.0, 0.45}, 5.0 * kRadiansPerDegree).matrix());
  EXPECT_NEAR(c.robot.depth.horizontal_fov, 1.0768, 1e-15);
  EXPECT_LT((c.robot.depth_mount.T_BC.matrix() - told.depth_mount.T_BC.matrix()).norm(), 1e-14);
  EXPECT_EQ(c.simulator.features.stereo.left.cx, 319.5);
  EXPECT_EQ(c.simulator.depth.footprint.horizontal_fov, c.robot.depth.horizontal_fov);
  expect_same_cameras(c, read(effective_yaml(c.entries)));

  const std::string before = effective_yaml(c.entries);
  told = c.robot;
  told.stereo.baseline = 12.0;
  try {
    set_cameras(c, told, "the cameras");
    ADD_FAILURE() << "no error";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the cameras: robot.stereo: baseline is 12"));
    EXPECT_THAT(error.what(), HasSubstr("expected a number from 0.001 to 10 m"));
  }
  EXPECT_EQ(effective_yaml(c.entries), before);
  EXPECT_EQ(c.robot.stereo.baseline, 0.2);
}

TEST(Configuration, SensorsSeeUpToAllRound) {
  const Configuration c =
      read("robot: {depth: {horizontal_fov: 360, vertical_fov: 0, max_range: 12}}");
  EXPECT_NEAR(c.robot.depth.horizontal_fov, 2.0 * M_PI, 1e-12);
  EXPECT_EQ(c.robot.depth.vertical_fov, 0.0);
  // The simulated one has its rays as near to each other as by default, in one layer.
  EXPECT_EQ(c.simulator.depth.columns, 412);
  EXPECT_EQ(c.simulator.depth.rows, 1);
  EXPECT_EQ(read("").simulator.depth.columns, 80);
  EXPECT_EQ(read("").simulator.depth.rows, 60);
  EXPECT_EQ(read("robot: {depth: {horizontal_fov: 1}}").simulator.depth.columns, 1);
  EXPECT_THAT(problems("robot: {depth: {horizontal_fov: 361}}"),
              HasSubstr("f.yaml:1: robot.depth.horizontal_fov"));
  EXPECT_THAT(problems("robot: {depth: {vertical_fov: 181}}"),
              HasSubstr("f.yaml:1: robot.depth.vertical_fov"));
}

// A lidar, a camera that looks back, and one of the defaults.
TEST(Configuration, TakesSeveralDepthSensors) {
  const std::string text =
      "robot: {depth: {horizontal_fov: 360, vertical_fov: 0, mount: {position: [0, 0, 0.3]}},"
      " more_depth: [{max_range: 3, mount: {position: [-0.1, 0, 0.4], yaw: 180}}, {}]}";
  const Configuration c = read(text);
  ASSERT_EQ(c.robot.more_depth.size(), 2u);
  EXPECT_EQ(c.robot.more_depth[0].footprint.max_range, 3.0);
  EXPECT_NEAR(c.robot.more_depth[0].mount.T_BC.linear().col(2).x(), -1.0, 1e-12);
  EXPECT_EQ(c.robot.more_depth[1].footprint.max_range, RgbdFootprint().max_range);
  EXPECT_LT(c.robot.more_depth[1].footprint.horizontal_fov, 1.3) << "not those of the first";
  EXPECT_EQ(c.simulator.more_depth.size(), 2u);
  const Configuration again = read(effective_yaml(c.entries));
  ASSERT_EQ(again.robot.more_depth.size(), 2u);
  EXPECT_EQ(again.robot.more_depth[0].mount.T_BC.matrix(),
            c.robot.more_depth[0].mount.T_BC.matrix());
  EXPECT_EQ(read("").robot.more_depth.size(), 0u);
  EXPECT_THAT(effective_yaml(read("").entries), ::testing::Not(HasSubstr("more_depth")));

  // What topics tell of it is in effect, and noted.
  Configuration told = c;
  RobotDescription seen = c.robot;
  seen.more_depth[0].footprint.horizontal_fov = 1.1;
  seen.more_depth[0].mount.T_BC = CameraMount::forward_facing({-0.2, 0.0, 0.4}, 3.0);
  set_cameras(told, seen, "the cameras");
  EXPECT_NEAR(told.robot.more_depth[0].footprint.horizontal_fov, 1.1, 1e-12);
  EXPECT_NEAR(read(effective_yaml(told.entries)).robot.more_depth[0].mount.T_BC.translation().x(),
              -0.2, 1e-12);
  EXPECT_EQ(told.simulator.more_depth[0].footprint.horizontal_fov,
            told.robot.more_depth[0].footprint.horizontal_fov);

  EXPECT_THAT(problems("robot: {more_depth: [{}, {max_range: -1}]}"),
              HasSubstr("f.yaml:1: robot.more_depth[1].max_range"));
  EXPECT_THAT(
      problems("robot: {more_depth: [{}, {vertical_fov: 0, mount: {position: [0, 0, 1]}}]}"),
      HasSubstr("robot.more_depth: sensor 2: its rays run 1.000 to 1.000 m"));
  std::string many = "robot: {more_depth: [{}";
  for (int n = 1; n < 16; ++n) many += ", {}";
  EXPECT_THAT(problems(many + "]}"), HasSubstr("16 sensors; expected up to 15"));
}

// Whatever is asked for is in effect, and what is in effect reads back as itself.
TEST(Configuration, HowTheWorldIsRead) {
  const Configuration c = read(
      "world: {floor: -2.5, resolution: 0.2, unknown: free, ground: 4, up: x, start: [1, -2, 90]}");
  EXPECT_EQ(c.world.floor, -2.5);
  EXPECT_EQ(c.world.voxel_size, 0.2);
  EXPECT_TRUE(c.world.unknown_is_free);
  EXPECT_EQ(c.world.ground_margin, 4.0);
  EXPECT_EQ(c.world.up, UpAxis::kX);
  ASSERT_TRUE(c.world.start.has_value());
  EXPECT_EQ(c.world.start->position, Eigen::Vector3d(1.0, -2.0, 0.0));
  EXPECT_NEAR(c.world.start->yaw, M_PI / 2.0, 1e-15);
  const Configuration again = read(effective_yaml(c.entries));
  EXPECT_EQ(effective_yaml(again.entries), effective_yaml(c.entries));
  EXPECT_EQ(again.world.floor, c.world.floor);
  EXPECT_EQ(again.world.start->yaw, c.world.start->yaw);

  const Configuration none = read("world: {floor: lowest, resolution: 0, start: []}");
  EXPECT_FALSE(none.world.floor.has_value());
  EXPECT_EQ(none.world.voxel_size, 0.0);
  EXPECT_FALSE(none.world.unknown_is_free);
  EXPECT_FALSE(none.world.start.has_value());

  EXPECT_THAT(problems("world: {floor: ground}"), HasSubstr("is 'ground'; expected lowest or"));
  EXPECT_THAT(problems("world: {floor: 1e9}"), HasSubstr("world.floor: is '1e9'; expected"));
  EXPECT_THAT(problems("world: {floor: nan}"), HasSubstr("world.floor: is 'nan'; expected"));
  EXPECT_THAT(problems("world: {resolution: 0.001}"), HasSubstr("expected a number"));
  EXPECT_THAT(problems("world: {start: [1, 2]}"), HasSubstr("2 numbers; expected x, y and yaw"));
  EXPECT_THAT(problems("world: {unknown: blocked}"), HasSubstr("world.unknown"));
}

TEST(Configuration, WhatIsInEffectReadsBackAsItself) {
  for (const char* text :
       {"", "robot: {model: multirotor}",
        "robot: {shape: {type: spheres, spheres: [{center: [0, 0, 0.3], radius: 0.2}]}}",
        "robot: {shape: {type: convex, vertices: [0.2, 0, 0.1, -0.2, 0.1, 0.1, -0.2, -0.1, 0.1, 0, "
        "0, 0.5]}}",
        "planner: {solver: ipopt, N: 12, M: 4, weights: {w_l: 0.25, w_h: 0.1}, unknown: free}\n"
        "simulator: {odometry: {perfect: true}}\nmission: {time_limit: 77.5}"}) {
    SCOPED_TRACE(text);
    const std::string effective = effective_yaml(read(text).entries);
    EXPECT_EQ(effective_yaml(read(effective).entries), effective);
  }
  const Configuration c = read(
      effective_yaml(read("planner: {solver: ipopt, N: 12, M: 4, weights: {w_l: 0.25}}").entries));
  EXPECT_EQ(c.solver, "ipopt");
  EXPECT_EQ(c.planner.N, 12);
  EXPECT_EQ(c.planner.M, 4);
  EXPECT_EQ(c.planner.weights.visible_features, 0.25);
}

TEST(Configuration, EveryProblemIsNamedWithItsLineAndWhatWasExpected) {
  const std::string all = problems(
      "planner:\n  N: 4\n  M: 9\n  weights:\n    w_e: .nan\n    w_u: -1\n    wl: 2\n"
      "  solver: nlop\nrobot:\n  depth: {min_range: 5, max_range: 2}\n");
  EXPECT_THAT(all, HasSubstr("f.yaml:3: planner.M: more knots than stages; expected at most N"));
  EXPECT_THAT(all, HasSubstr("f.yaml:5: planner.weights.w_e: is '.nan'; expected a number"));
  EXPECT_THAT(all, HasSubstr("f.yaml:6: planner.weights.w_u: is '-1'; expected a number"));
  EXPECT_THAT(all, HasSubstr("f.yaml:7: unknown key 'planner.weights.wl' (did you mean 'w_l'?)"));
  EXPECT_THAT(all, HasSubstr("f.yaml:8: planner.solver: unknown solver 'nlop' (did you mean "
                             "'nlopt'?); expected one of: "));
  EXPECT_THAT(all, HasSubstr("max_range <= min_range; expected more"));
}

TEST(Configuration, UnusableShapesAreRefusedOnce) {
  const auto refused = [](const std::string& shape, const std::string& why) {
    const std::string all = problems("robot: {shape: {" + shape + "}}");
    EXPECT_THAT(all, HasSubstr("f.yaml:1: robot.shape")) << shape;
    EXPECT_THAT(all, HasSubstr(why)) << shape;
    EXPECT_EQ(all.find('\n'), std::string::npos) << all;
  };
  refused("type: spheres, spheres: []", "no spheres; expected at least one");
  refused("type: spheres, spheres: [{center: [0, 0, 0.3]}]", "radius");
  refused("type: convex", "vertices");
  refused("type: convex, vertices: [0, 0, 0, 1, 0, 0, 0, 1, 0]", "9 numbers; expected 3 a vertex");
  refused("type: convex, vertices: [0, 0, 0.1, 1, 0, 0.1, 0, 1, 0.1, 1, 1, 0.1]", "expected");
  refused("type: box, size: [0.1, 0.1]", "expected");
  refused("type: cylinder, radius: 0", "expected");
  refused("type: egg", "expected one of: cylinder, box, spheres, convex");
}

TEST(Configuration, TasksAndZones) {
  const Configuration c = read(
      "task: {kind: go, goal: [2, -1.5, 90], position_tolerance: 0.1}\n"
      "zones:\n"
      "  bound: [-5, -5, 5, -5, 5, 5, -5, 5]\n"
      "  keep_out: [{area: [0, 0, 1, 0, 1, 1]}, {area: [3, 3, 4, 3, 4, 4]}]\n"
      "  slow: [{area: [-2, -2, -1, -2, -1, -1], max_speed: 0.2}]\n"
      "mission: {return_when_done: true, until: {coverage: 0.9}}\n"
      "simulator: {map: known.bt}\n");
  EXPECT_EQ(c.planner.task.kind, TaskKind::kGoTo);
  EXPECT_EQ(c.planner.task.goal.position, Eigen::Vector2d(2, -1.5));
  EXPECT_NEAR(c.planner.task.goal.yaw.value(), M_PI / 2, 1e-12);
  EXPECT_EQ(c.planner.task.goal.position_tolerance, 0.1);
  ASSERT_TRUE(c.planner.zones.bound);
  EXPECT_EQ(c.planner.zones.bound->size(), 4u);
  ASSERT_EQ(c.planner.zones.keep_out.size(), 2u);
  EXPECT_EQ(c.planner.zones.keep_out[1][2], Eigen::Vector2d(4, 4));
  ASSERT_EQ(c.planner.zones.slow.size(), 1u);
  EXPECT_EQ(c.planner.zones.slow[0].max_speed, 0.2);
  EXPECT_TRUE(c.mission.return_when_done);
  EXPECT_EQ(c.until_coverage, 0.9);
  EXPECT_EQ(c.map, "known.bt");
  // What is in effect reads back as itself.
  const std::string text = effective_yaml(c.entries);
  const Configuration again = read(text);
  EXPECT_EQ(effective_yaml(again.entries), text);
  EXPECT_EQ(again.planner.zones.keep_out, c.planner.zones.keep_out);
  EXPECT_EQ(again.planner.task.goal.yaw, c.planner.task.goal.yaw);

  const Configuration none = read("");
  EXPECT_EQ(none.planner.task.kind, TaskKind::kExplore);
  EXPECT_FALSE(none.planner.task.area);
  EXPECT_TRUE(none.planner.zones.empty());
  EXPECT_FALSE(none.mission.return_when_done);
  EXPECT_EQ(none.map, "");
  EXPECT_TRUE(read("task: {area: [0, 0, 1, 0, 1, 1]}").planner.task.area);
}

TEST(Configuration, WrongTasksAndZonesAreALineEach) {
  const std::vector<std::pair<std::string, std::string>> table = {
      {"task: {kind: fly}", "expected one of"},
      {"task: {kind: go}", "f.yaml:1: task.goal: 0 numbers; expected x, y"},
      {"task: {kind: go, goal: [1, 2, 3, 4]}", "4 numbers; expected x, y"},
      {"task: {area: [0, 0, 1, 0, 1]}", "5 numbers; expected x and y of each corner"},
      {"task: {area: [0, 0, 2, 2, 2, 0, 0, 2]}", "sides 1 and 3 meet"},
      {"zones: {bound: [0, 0, 1, 1]}", "zones.bound: 2 corners; expected 3"},
      {"zones: {keep_out: [{area: [0, 0, 1, 0]}]}", "zones.keep_out[0].area: 2 corners"},
      {"zones: {slow: [{area: [0, 0, 1, 0, 1, 1], max_speed: 0}]}", "max_speed"},
      {"zones: {slow: [{area: [0, 0, 1, 0, 1, 1]}]}", "max_speed"},
      {"task: {kind: go, goal: [0.5, 0.5]}\nzones: {keep_out: [{area: [0, 0, 1, 0, 1, 1, 0, 1]}]}",
       "f.yaml:1: task.goal: is in zones.keep_out[0]; expected at least"},
      {"mission: {until: {coverage: 1.5}}", "until.coverage"},
  };
  for (const auto& [text, expected] : table) {
    const std::string said = problems(text);
    EXPECT_THAT(said, HasSubstr(expected)) << text;
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST(Configuration, SettingsStandAboveTheFileAndAreCheckedAsItIs) {
  const auto read = [](const std::vector<YamlSetting>& settings) {
    return read_configuration("", {}, settings);
  };
  const Configuration c =
      read({"planner.weights.w_l=0", "planner.N=12", "planner.N=14",
            "robot.depth={max_range: 6, horizontal_fov: 90}", "task.kind=go", "task.goal=[3, 1]"});
  EXPECT_EQ(c.planner.weights.visible_features, 0.0);
  EXPECT_EQ(c.planner.N, 14);
  EXPECT_EQ(c.robot.depth.max_range, 6.0);
  EXPECT_EQ(c.planner.task.goal.position, Eigen::Vector2d(3.0, 1.0));
  EXPECT_EQ(effective_yaml(read({}).entries), effective_yaml(read_configuration("").entries));

  // ~ takes back what the file says; what the environment says is below it.
  const auto steps = [](const std::vector<YamlSetting>& settings) {
    return configuration_from_text("planner: {N: 12, M: 3}", "f.yaml", {}, settings).planner;
  };
  EXPECT_EQ(steps({"planner.N=~"}).N, PlannerParameters().N);
  EXPECT_EQ(steps({"planner.N=~"}).M, 3);
  EXPECT_EQ(steps({"planner=~"}).M, PlannerParameters().M);
  YamlSetting below("planner.N=15", "THE_ENVIRONMENT");
  below.unless_told = true;
  EXPECT_EQ(steps({below}).N, 12);
  EXPECT_EQ(steps({below, "planner.N=16"}).N, 16);
  EXPECT_EQ(read({below}).planner.N, 15);
  EXPECT_EQ(read({below, "planner.N=16"}).planner.N, 16);

  const auto problem = [&](const std::string& setting) -> std::string {
    try {
      read({setting});
    } catch (const InputError& e) {
      return e.what();
    }
    return "none";
  };
  EXPECT_THAT(problem("planner.weights.w_l=-1"),
              HasSubstr("--set planner.weights.w_l=-1: planner.weights.w_l"));
  EXPECT_THAT(problem("planner.weights.w_k=1"), HasSubstr("--set planner.weights.w_k=1: unknown"));
  EXPECT_THAT(problem("planner.weights.w_k=1"), HasSubstr("did you mean"));
  EXPECT_THAT(problem("planner.N.x=1"), HasSubstr("--set planner.N.x=1"));
  for (const char* wrong :
       {"planner.N", "=3", "planner..N=3", "planner.N=[1", "planner.N=1\nx: 2", "planner.N=*a"}) {
    EXPECT_THAT(problem(wrong), HasSubstr("--set ")) << wrong;
    EXPECT_THAT(problem(wrong), HasSubstr("expected")) << wrong;
  }
}

Registries with_a_term() {
  Registries registries;
  TermEntry entry{"my_term", "one of mine"};
  entry.options = {{"radius", 0.5, 0.1, 2.0, "m", "of something"}};
  entry.make = [](const TermOptions&, const TermContext&) { return nullptr; };
  registries.terms.add(entry);
  return registries;
}

std::string term_problems(const std::string& text) {
  try {
    configuration_from_text(text, "f.yaml", with_a_term());
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Configuration, ATermByName) {
  const Configuration c = configuration_from_text(
      "planner: {terms: {my_term: {weight: 0.5, radius: 1.5}}}", "f.yaml", with_a_term());
  ASSERT_EQ(c.planner.terms.size(), 1U);
  EXPECT_EQ(c.planner.terms[0].entry->name, "my_term");
  EXPECT_EQ(c.planner.terms[0].weight, 0.5);
  EXPECT_EQ(c.planner.terms[0].options.at("radius"), 1.5);
  const Configuration defaults =
      configuration_from_text("planner: {terms: {my_term: {}}}", "f.yaml", with_a_term());
  EXPECT_EQ(defaults.planner.terms[0].weight, 1.0);
  EXPECT_EQ(defaults.planner.terms[0].options.at("radius"), 0.5);
  EXPECT_TRUE(
      configuration_from_text("planner: {terms: {my_term: {weight: 0}}}", "f.yaml", with_a_term())
          .planner.terms.empty());
}

TEST(Configuration, ABuiltInTermHasOneWeight) {
  const std::string text = "planner: {terms: {cost_to_go: {weight: 2.5}, obstacles: {weight: 0}}}";
  const Configuration c = read(text);
  EXPECT_EQ(c.planner.weights.cost_to_go, 2.5);
  EXPECT_EQ(c.planner.terms_left_out, std::vector<std::string>{"obstacles"});
  // What is written of it is read as the same again.
  const Configuration again = read(effective_yaml(c.entries));
  EXPECT_EQ(again.planner.weights.cost_to_go, 2.5);
  EXPECT_EQ(again.planner.terms_left_out, c.planner.terms_left_out);
  for (const ConfigEntry& entry : c.entries) EXPECT_NE(entry.path, "planner.weights.w_T");

  EXPECT_EQ(read("planner: {weights: {w_T: 0}}").planner.terms_left_out.size(), 0U)
      << "a weight of zero there costs nothing and is told";
  const std::string both =
      problems("planner:\n  weights: {w_T: 1}\n  terms:\n    cost_to_go: {weight: 2}\n");
  EXPECT_THAT(both, HasSubstr("f.yaml:4: planner.terms.cost_to_go.weight: planner.weights.w_T and "
                              "planner.terms.cost_to_go.weight are both set"));
  EXPECT_THAT(problems("planner: {terms: {clearance: {weight: 0.5}}}"),
              HasSubstr("weight is 0.5; expected 1, or 0 to leave it out"));
  EXPECT_THAT(problems("planner: {terms: {cost_to_go: {}}}"), HasSubstr("missing"));
}

TEST(Configuration, RefusesATermThatCannotBeHad) {
  EXPECT_THAT(term_problems("planner: {terms: {my_tern: {weight: 1, radius: 3}}}"),
              HasSubstr("unknown term 'my_tern' (did you mean 'my_term'?); expected one of: "));
  EXPECT_THAT(term_problems("planner: {terms: {my_term: {raduis: 1}}}"),
              HasSubstr("'planner.terms.my_term.raduis' (did you mean 'radius'?)"));
  EXPECT_THAT(term_problems("planner: {terms: {my_term: {radius: 3}}}"),
              HasSubstr("planner.terms.my_term.radius"));
  EXPECT_THAT(term_problems("planner: {terms: {my_term: {weight: 1e7}}}"),
              HasSubstr("planner.terms.my_term.weight"));
  EXPECT_THAT(problems("planner: {terms: {my_term: {weight: 1}}}"),
              HasSubstr("unknown term 'my_term'"))
      << "without what brings it";
}

}  // namespace
}  // namespace prospect::configuration_test
