// From images to motion, without the truth in between: rendered stereo pairs through visual
// odometry, rendered depth through mapping, both as a belief, and the planner on it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <random>

#include "engine/guard.h"
#include "engine/mission.h"
#include "engine/planner.h"
#include "models/unicycle.h"
#include "perception/belief_builder.h"
#include "perception/depth_mapper.h"
#include "solvers/registry.h"
#include "tests/perception/rendered_room.h"

namespace prospect {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::RenderedRoom;

Isometry3d pose_matrix(const Pose& pose) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = Eigen::AngleAxisd(pose.yaw, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() = pose.position;
  return T;
}

double free_area(const GroundMap& ground) {
  int free = 0;
  for (int i = 0; i < ground.frame().size(); ++i) {
    free += ground.state(ground.frame().at(i)) == CellState::kFree;
  }
  return free * ground.frame().resolution * ground.frame().resolution;
}

/// A robot that knows nothing but its start and what its cameras see of the rendered room.
class SeeingRobot final : public Robot {
 public:
  static constexpr double kPeriod = 0.125;  // [s] of the stereo pair; depth every other time

  SeeingRobot(const RobotDescription& robot, const Pose& start)
      : robot_(robot),
        truth_(start),
        odometry_(robot.stereo, {}, pose_matrix(start) * robot.stereo_mount.T_BC),
        mapper_(depth_camera(), mapping()),
        builder_(robot.stereo_mount.T_BC) {
    mapper_.map().clear_cylinder(start.position, 0.45, 0.6);
    see();
  }

  static PinholeCamera depth_camera() { return {165.0, 165.0, 120.0, 90.0, 240.0, 180.0}; }

  std::shared_ptr<const Belief> sense() override { return belief_; }
  double time() const override { return time_; }
  void apply(const Twist& command, double duration) override {
    for (double left = duration; left > 1e-9; left -= kPeriod) {
      Eigen::VectorXd next(robot_.model->nx());
      robot_.model->step(robot_.model->state(truth_, command), robot_.model->input(command),
                         std::min(kPeriod, left), next);
      const Pose moved = robot_.model->pose(next);
      way += (moved.position - truth_.position).norm();
      turned += std::abs(moved.yaw - truth_.yaw);
      truth_ = moved;
      time_ += std::min(kPeriod, left);
      see();
    }
  }

  /// Between the robot's axis and the nearest wall or the pillar [m].
  double nearest() const {
    const double x = truth_.position.x(), y = truth_.position.y();
    const double dx = std::max({2.53 - x, x - 3.17, 0.0}),
                 dy = std::max({-0.71 - y, y - 0.11, 0.0});
    return std::min({x + 3.03, 5.07 - x, y + 2.51, 2.77 - y, std::hypot(dx, dy)});
  }
  double error() const { return (belief_->pose.position - truth_.position).norm(); }

  double way = 0.0, turned = 0.0, worst_error = 0.0, least_distance = 1e9;
  int frames = 0, not_ok = 0, rejected = 0;

 private:
  static DepthMapperOptions mapping() {
    DepthMapperOptions options;
    options.map.slice = {0.1, 0.5};
    return options;
  }

  void see() {
    const Isometry3d T_WB = pose_matrix(truth_);
    const auto pair =
        room_.render(robot_.stereo, T_WB * robot_.stereo_mount.T_BC, 2.0, 900 + frames);
    const OdometryFrame frame = odometry_.process(time_, pair.left.view(), pair.right.view());
    not_ok += frame.state != Localization::kOk;
    if (frames % 2 == 0) {
      const PinholeCamera camera = depth_camera();
      DepthImage depth(240, 180);
      for (int v = 0; v < depth.height; ++v) {
        for (int u = 0; u < depth.width; ++u) {
          const double z = room_.depth(camera, T_WB * robot_.depth_mount.T_BC, u, v);
          depth.at(u, v) = static_cast<float>(z + 0.002 * z * z * normal_(generator_));
        }
      }
      const Isometry3d T_WB_seen = frame.T_WC * robot_.stereo_mount.T_BC.inverse();
      rejected += mapper_.process(time_, depth, T_WB_seen * robot_.depth_mount.T_BC).state ==
                  Mapping::kRejected;
    }
    ++frames;
    belief_ = builder_.build(frame, mapper_.map().snapshot(), odometry_.landmarks());
    worst_error = std::max(worst_error, error());
    least_distance = std::min(least_distance, nearest());
  }

  RobotDescription robot_;
  RenderedRoom room_;
  Pose truth_;
  double time_ = 0.0;
  StereoOdometry odometry_;
  DepthMapper mapper_;
  BeliefBuilder builder_;
  std::shared_ptr<const Belief> belief_;
  std::mt19937_64 generator_{3};
  std::normal_distribution<double> normal_;
};

TEST(VisionToPlan, ARobotExploresByWhatItsCamerasSee) {
  RobotDescription robot;
  robot.model = std::make_shared<Unicycle>();
  robot.shape = CylinderShape{.center = {0, 0, 0.3}, .radius = 0.2, .height = 0.4};
  robot.stereo.left = {220.0, 220.0, 160.0, 120.0, 320.0, 240.0};
  robot.stereo.baseline = 0.12;
  robot.stereo_mount.T_BC = CameraMount::forward_facing({0.1, 0.0, 0.7});
  robot.depth_mount.T_BC = CameraMount::forward_facing({0.1, 0.0, 0.6}, 0.0, 0.25);
  const PinholeCamera depth = SeeingRobot::depth_camera();
  robot.depth = {depth.horizontal_fov(), depth.vertical_fov(), 0.3, 4.0};

  SeeingRobot seeing(robot, {{-1.6, 0.6, 0.0}, -0.2});
  const PlannerParameters parameters;
  Planner planner(robot, parameters, make_solver("nlopt"));
  const Guard guard(robot.model, robot.shape,
                    {.margin = parameters.guard_margin(), .slice = {0.1, 0.5}});
  int optimised = 0;
  double predicted = 0.0, tracked = 0.0;
  const double known_before = free_area(*seeing.sense()->ground);
  const MissionResult mission =
      run_mission(seeing, planner, guard, {.time_limit = 14.0}, [&](const MissionStep& step) {
        optimised += step.plan->kind == PlanKind::kOptimised && step.plan->certified;
        if (!step.plan->visible.empty()) {
          predicted += step.plan->visible.front();
          tracked += step.belief->tracked_features;
        }
      });
  const double known = free_area(*seeing.sense()->ground);
  std::printf(
      "%.1f s, %.2f m and %.1f rad by sight (%s): pose off by %.1f mm at most, %d of %d frames not "
      "ok, "
      "%d of %d plans optimised and certified, %.1f m2 known free of %.1f at the start, predicted "
      "over tracked features %.2f\n",
      mission.duration, seeing.way, seeing.turned, to_string(mission.end).data(),
      1e3 * seeing.worst_error, seeing.not_ok, seeing.frames, optimised, mission.steps, known,
      known_before, predicted / std::max(1.0, tracked));
  EXPECT_GT(seeing.way, 2.0);
  EXPECT_LT(seeing.worst_error, 0.03);
  EXPECT_GT(seeing.least_distance, 0.2) << "the body's radius";
  EXPECT_EQ(seeing.not_ok, 0);
  EXPECT_EQ(seeing.rejected, 0);
  EXPECT_GT(optimised, mission.steps / 2);
  EXPECT_GT(known, known_before + 8.0);
}

}  // namespace
}  // namespace prospect
