// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/perception_pipeline.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "models/body_transform.h"
#include "tests/perception/depth_scene.h"

namespace prospect::perception_pipeline_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kBegin = 1000.0;  // [s], of a clock that began long ago
constexpr double kSpeed = 0.3, kTurn = 0.5;

/// On a circle, from kBegin on.
Pose truth(double stamp) {
  const double a = kTurn * (stamp - kBegin), r = kSpeed / kTurn;
  return {{r * std::sin(a), r * (1.0 - std::cos(a)), 0.0}, a};
}

/// An odometry that knows the truth, and tracks one landmark for each frame so far.
class KnowingOdometry final : public Odometry {
 public:
  explicit KnowingOdometry(const CameraMount& mount) : mount_(mount) {}
  OdometryFrame process(double stamp, const ImageView&, const ImageView&,
                        const std::optional<Isometry3d>& motion) override {
    OdometryFrame frame;
    frame.stamp = stamp;
    frame.state = state;
    frame.T_WC = body_transform(truth(stamp)) * mount_.T_BC;
    frame.covariance = frame.covariance_since_keyframe =
        1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
    frame.keyframe = frames_++ % 5 == 0;
    frame.tracked = 50;
    told_motion = motion.has_value();
    return frame;
  }
  std::shared_ptr<const LandmarkMap> landmarks(double) const override {
    auto map = std::make_shared<LandmarkMap>();
    for (int i = 0; i < frames_; ++i) {
      Landmark l;
      l.id = static_cast<std::uint64_t>(i + 1);
      l.position = {3.0, 0.5 * i, 1.0};
      map->landmarks.push_back(l);
    }
    return map;
  }
  const std::vector<LandmarkSighting>& sightings() const override { return none_; }
  const std::vector<std::uint64_t>& given_up() const override { return gone_; }
  std::optional<Eigen::Matrix<double, 6, 6>> covariance_since(int) const override {
    return 1e-6 * Eigen::Matrix<double, 6, 6>::Identity();
  }

  bool told_motion = false;
  Localization state = Localization::kOk;

 private:
  CameraMount mount_;
  int frames_ = 0;
  std::vector<LandmarkSighting> none_;
  std::vector<std::uint64_t> gone_;
};

const DepthCameraOnBody kDepthCamera{{131.0, 131.0, 79.5, 59.5, 160.0, 120.0},
                                     {CameraMount::forward_facing({0.1, 0.0, 0.5}, 0.0, 0.3)}};

PerceptionOptions options_with(bool wheels, bool depth) {
  PerceptionOptions options;
  options.wheels = wheels;
  if (depth) options.depth_camera = kDepthCamera;
  return options;
}

PerceptionPipeline pipeline_with(const PerceptionOptions& options) {
  return {std::make_unique<KnowingOdometry>(options.stereo_mount), StereoCamera(), options};
}

DepthImage depth_at(double stamp) {
  return test::DepthScene().render(kDepthCamera.camera,
                                   body_transform(truth(stamp)) * kDepthCamera.mount.T_BC);
}

StampedPair pair_at(double stamp) { return {stamp, stamp, {}, {}}; }

WheelSample wheels_at(double stamp) {
  WheelSample sample;
  sample.stamp = stamp;
  sample.velocity.x() = kSpeed;
  sample.yaw_rate = kTurn;
  return sample;
}

double yaw_of(const Isometry3d& T) { return std::atan2(T.linear()(1, 2), T.linear()(0, 2)); }

/// A lidar 0.35 m above the floor in a room of 4 m, in B; the robot stands in its middle. No two n
/// see the same to the bit.
DepthScan lidar(int n = 0) {
  DepthScan scan;
  scan.origin = {0.0, 0.0, 0.35};
  for (int i = 0; i < 360; ++i) {
    const double a = i * M_PI / 180.0;
    const double range = (2.0 + 1e-4 * n) / std::max(std::abs(std::cos(a)), std::abs(std::sin(a)));
    scan.hits.emplace_back(range * std::cos(a), range * std::sin(a), 0.35);
  }
  return scan;
}

TEST(PerceptionPipeline, MakesABeliefOfAllSources) {
  PerceptionPipeline perception = pipeline_with(options_with(true, true));
  EXPECT_EQ(perception.belief()->localization, Localization::kLost) << "nothing is measured";
  EXPECT_EQ(perception.map_state(), MapState::kNoneYet);
  double now = kBegin;
  for (int k = 0; k <= 10; ++k) {
    now = kBegin + 0.1 * k;
    EXPECT_EQ(perception.wheels(wheels_at(now)).state, InputState::kTaken);
    EXPECT_EQ(perception.stereo(pair_at(now)).state, InputState::kTaken);
    if (k % 2 == 1) continue;
    const InputResult entered = perception.depth(now, depth_at(now));
    EXPECT_EQ(entered.state, InputState::kTaken) << entered.reason;
  }
  EXPECT_TRUE(static_cast<const KnowingOdometry&>(perception.odometry()).told_motion);
  EXPECT_EQ(perception.map_state(), MapState::kMapped);
  EXPECT_EQ(perception.complaint(), "");
  EXPECT_EQ(perception.input(InputSource::kDepth).taken, 6U);
  const std::shared_ptr<const Belief> belief = perception.belief(now + 0.05);
  EXPECT_EQ(belief->localization, Localization::kOk);
  EXPECT_EQ(belief->stamp, now + 0.05);
  EXPECT_EQ(belief->stamps.pose, now);
  EXPECT_EQ(belief->stamps.landmarks, now);
  EXPECT_EQ(belief->stamps.map, now);
  EXPECT_EQ(belief->stamps.ranges, now);
  // The robot goes on as the wheels have told.
  EXPECT_LT((belief->pose.position - truth(now + 0.05).position).norm(), 0.005);
  EXPECT_NEAR(belief->pose.yaw, truth(now + 0.05).yaw, 0.005);
  EXPECT_NEAR(belief->twist.yaw_rate, kTurn, 0.01);
  EXPECT_EQ(belief->landmarks->landmarks.size(), 11U);
  EXPECT_GT(belief->ground->free_cells(), 200);
  EXPECT_GT(belief->covariance(0, 0), 0.0);
  // Motions over 5 to 10 frames, 1 mm each.
  ASSERT_TRUE(belief->landmarks->odometry_noise);
  EXPECT_GT(belief->landmarks->odometry_noise->position_per_metre, 0.0);
  EXPECT_LT(belief->landmarks->odometry_noise->position_per_metre, 0.005);
  // Without news the maps are the same objects.
  const std::shared_ptr<const Belief> again = perception.belief();
  EXPECT_EQ(again->octree, belief->octree);
  EXPECT_EQ(again->voxels, belief->voxels);
  EXPECT_EQ(again->ground, belief->ground);
}

TEST(PerceptionPipeline, TheOrderInWhichSourcesComeDoesNotMatter) {
  // At k / 10 a pair; at even k a depth image, which comes with it, before it, or after the pair
  // that follows.
  const auto drive = [](bool wheels, int late) {
    PerceptionPipeline perception = pipeline_with(options_with(wheels, true));
    const auto depth = [&](int k) {
      const double stamp = kBegin + 0.1 * k;
      return perception.depth(stamp, depth_at(stamp)).state;
    };
    for (int k = 0; k <= 8; ++k) {
      const double now = kBegin + 0.1 * k;
      if (late < 0 && k > 0 && k % 2 == 0) {
        EXPECT_EQ(depth(k), InputState::kWaiting);
      }
      if (wheels) perception.wheels(wheels_at(now));
      perception.stereo(pair_at(now));
      const bool with_pair = late == 0 || k == 0 || k == 8;
      if (late > 0 && k > 1 && k % 2 == 1) {
        EXPECT_EQ(depth(k - 1), InputState::kTaken);
      }
      if (late >= 0 && with_pair && k % 2 == 0) {
        EXPECT_EQ(depth(k), InputState::kTaken);
      }
      if (late < 0 && k == 0) {
        EXPECT_EQ(depth(k), InputState::kTaken);
      }
    }
    EXPECT_EQ(perception.input(InputSource::kDepth).taken, 5U);
    EXPECT_EQ(perception.input(InputSource::kDepth).waiting, 0U);
    return perception.belief();
  };
  for (const bool wheels : {true, false}) {
    const auto at_once = drive(wheels, 0);
    EXPECT_GT(at_once->ground->free_cells(), 200);
    for (const int late : {-1, 1}) {
      const auto other = drive(wheels, late);
      EXPECT_EQ(other->voxels->data(), at_once->voxels->data()) << wheels << late;
      EXPECT_EQ(other->pose.position, at_once->pose.position);
      EXPECT_EQ(other->stamps.map, at_once->stamps.map);
    }
  }
}

TEST(PerceptionPipeline, DepthBetweenPairsIsEnteredWhereTheRobotWasThen) {
  for (const bool wheels : {true, false}) {
    PerceptionPipeline perception = pipeline_with(options_with(wheels, true));
    perception.stereo(pair_at(kBegin));
    if (wheels) perception.wheels(wheels_at(kBegin));
    const double between = kBegin + 0.17;
    EXPECT_EQ(perception.depth(between, depth_at(between)).state, InputState::kWaiting);
    EXPECT_EQ(perception.input(InputSource::kDepth).waiting, 1U);
    EXPECT_EQ(perception.belief()->stamps.ranges, between);
    EXPECT_EQ(perception.belief()->stamps.map, 0.0);
    for (const double stamp : {kBegin + 0.1, kBegin + 0.2, kBegin + 0.3}) {
      if (wheels) perception.wheels(wheels_at(stamp));
      perception.stereo(pair_at(stamp));
    }
    EXPECT_EQ(perception.input(InputSource::kDepth).waiting, 0U);
    EXPECT_EQ(perception.mapped().stamp, between);
    EXPECT_NEAR(yaw_of(perception.mapped().T_WC), truth(between).yaw, 0.002);
    // One that is later than the pairs after it.
    const double late = kBegin + 0.24;
    EXPECT_EQ(perception.depth(late, depth_at(late)).state, InputState::kTaken);
    EXPECT_NEAR(yaw_of(perception.mapped().T_WC), truth(late).yaw, 0.002);
  }
}

TEST(PerceptionPipeline, WheelsMayComeAfterThePair) {
  PerceptionPipeline perception = pipeline_with(options_with(true, false));
  for (int k = 0; k <= 10; ++k) {
    perception.stereo(pair_at(kBegin + 0.1 * k));
    EXPECT_EQ(perception.wheels(wheels_at(kBegin + 0.1 * k)).state, InputState::kTaken);
  }
  const auto belief = perception.belief();
  EXPECT_EQ(belief->localization, Localization::kOk);
  EXPECT_LT((belief->pose.position - truth(kBegin + 1.0).position).norm(), 0.01);
}

TEST(PerceptionPipeline, WhatCannotBeUsedIsLeftOutAndSaid) {
  PerceptionPipeline perception = pipeline_with(options_with(true, true));
  const double now = kBegin + 1.0;
  perception.wheels(wheels_at(now));
  perception.stereo(pair_at(now));
  perception.depth(now, depth_at(now));
  perception.scan(now, lidar());
  const auto before = perception.belief();
  StampedPair apart = pair_at(now + 0.1);
  apart.right_stamp += 0.033;
  StampedPair unknown = pair_at(now + 0.11);
  unknown.right_stamp = kNaN;
  WheelSample impossible = wheels_at(now + 0.1);
  impossible.velocity.x() = kNaN;
  DepthScan empty = lidar();
  empty.origin.x() = kNaN;
  struct Row {
    InputSource source;
    std::function<InputResult()> call;
    InputState state;
    const char* reason;
  };
  using enum InputSource;
  using enum InputState;
  const Row rows[] = {
      {kStereo, [&] { return perception.stereo(pair_at(now)); }, kLate, "not after the one before"},
      {kStereo, [&] { return perception.stereo(pair_at(now - 2.0)); }, kLate, "not after"},
      {kStereo, [&] { return perception.stereo(pair_at(kNaN)); }, kRefused, "not a number"},
      {kStereo, [&] { return perception.stereo(apart); }, kRefused,
       "left and right image are 0.0330 s apart; expected at most 0.005 s"},
      {kStereo, [&] { return perception.stereo(unknown); }, kRefused, "apart"},
      {kWheels, [&] { return perception.wheels(wheels_at(now - 0.01)); }, kLate, "not after"},
      {kWheels, [&] { return perception.wheels(impossible); }, kRefused, "not possible"},
      {kDepth, [&] { return perception.depth(now, depth_at(now)); }, kLate, "not after"},
      {kDepth, [&] { return perception.depth(now + 0.01, DepthImage(3, 2, 1.0F)); }, kRefused,
       "the image has the wrong size"},
      {kScan, [&] { return perception.scan(now - 0.5, lidar()); }, kLate, "not after"},
      {kScan, [&] { return perception.scan(now + 0.01, empty); }, kRefused, "no ray is finite"},
      {kScan, [&] { return perception.scan(now + 7200.0, lidar()); }, kRefused,
       "ahead of the newest"},
  };
  for (const Row& row : rows) {
    const InputCount count = perception.input(row.source);
    const InputResult result = row.call();
    EXPECT_EQ(to_string(result.state), to_string(row.state)) << row.reason;
    EXPECT_NE(result.reason.find(row.reason), std::string::npos) << result.reason;
    EXPECT_EQ(perception.input(row.source).reason, result.reason);
    EXPECT_EQ(perception.input(row.source).taken, count.taken);
    EXPECT_EQ(perception.input(row.source).late + perception.input(row.source).refused,
              count.late + count.refused + 1);
  }
  const auto after = perception.belief(now);
  EXPECT_EQ(after->pose.position, before->pose.position);
  // Wheels that say what cannot be are not trusted.
  EXPECT_EQ(before->localization, Localization::kOk);
  EXPECT_EQ(after->localization, Localization::kDegraded);
  EXPECT_EQ(after->voxels, before->voxels);
  EXPECT_EQ(after->stamps.map, before->stamps.map);
  // At a degraded pose nothing is mapped; with the next pair that agrees it is again.
  EXPECT_EQ(perception.scan(now + 0.015, lidar()).reason, "the pose is degraded");
  perception.wheels(wheels_at(now + 0.12));
  perception.stereo(pair_at(now + 0.12));
  EXPECT_EQ(perception.belief()->localization, Localization::kOk);
  // A part of a scan.
  DepthScan scan = lidar();
  scan.hits[7].z() = kNaN;
  const InputResult partly = perception.scan(now + 0.12, scan);
  EXPECT_EQ(partly.state, kTaken);
  EXPECT_EQ(partly.reason, "1 of 360 rays are not finite: left out");
}

TEST(PerceptionPipeline, SourcesThatTheOptionsDoNotNameAreRefused) {
  PerceptionPipeline perception = pipeline_with(options_with(false, false));
  EXPECT_EQ(perception.wheels(wheels_at(kBegin)).state, InputState::kRefused);
  EXPECT_EQ(perception.depth(kBegin, depth_at(kBegin)).state, InputState::kRefused);
  EXPECT_EQ(perception.input(InputSource::kDepth).refused, 1U);
}

TEST(PerceptionPipeline, StereoAloneLocalizesAndSaysThatNothingIsMapped) {
  PerceptionPipeline perception = pipeline_with(options_with(false, false));
  for (int k = 0; k <= 3; ++k) perception.stereo(pair_at(kBegin + 0.1 * k));
  EXPECT_EQ(perception.map_state(), MapState::kNoSource);
  EXPECT_NE(to_string(perception.map_state()).find("expected depth images or scans"),
            std::string_view::npos);
  auto belief = perception.belief();
  EXPECT_EQ(belief->localization, Localization::kOk);
  EXPECT_LT((belief->pose.position - truth(kBegin + 0.3).position).norm(), 1e-9);
  EXPECT_EQ(belief->landmarks->landmarks.size(), 4U);
  EXPECT_EQ(belief->ground->free_cells() + belief->ground->occupied_cells(), 0);
  EXPECT_EQ(belief->stamps.map, 0.0);
  EXPECT_EQ(belief->stamps.ranges, 0.0);
  // A lidar maps.
  const double now = kBegin + 0.3;
  EXPECT_EQ(perception.scan(now, lidar()).state, InputState::kTaken);
  EXPECT_EQ(perception.map_state(), MapState::kMapped);
  belief = perception.belief();
  EXPECT_EQ(belief->stamps.map, now);
  EXPECT_EQ(belief->stamps.ranges, now);
  const auto state = [&](const Vector3d& in_B) {
    const Eigen::Vector3i v = belief->voxels->voxel(body_transform(truth(now)) * in_B);
    return belief->voxels->state(v.x(), v.y(), v.z());
  };
  EXPECT_EQ(state({2.017, 0.0, 0.35}), CellState::kOccupied);
  EXPECT_EQ(state({0.0, -2.017, 0.35}), CellState::kOccupied);
  EXPECT_EQ(state({1.5, 0.3, 0.35}), CellState::kFree);
  EXPECT_EQ(state({2.5, 0.0, 0.35}), CellState::kUnknown);
}

TEST(PerceptionPipeline, WhatWaitsInVainIsCounted) {
  PerceptionOptions options = options_with(false, true);
  options.most_waiting = 2;
  PerceptionPipeline perception = pipeline_with(options);
  perception.stereo(pair_at(kBegin));
  const DepthImage image = depth_at(kBegin);
  for (int k = 1; k <= 4; ++k) {
    EXPECT_EQ(perception.depth(kBegin + 0.1 * k, image).state, InputState::kWaiting);
  }
  const InputCount& count = perception.input(InputSource::kDepth);
  EXPECT_EQ(count.waiting, 2U);
  EXPECT_EQ(count.late, 2U);
  EXPECT_EQ(count.reason, "no pose of its time came while it waited");
  perception.stereo(pair_at(kBegin + 0.35));
  EXPECT_EQ(count.waiting, 1U);
  EXPECT_EQ(count.taken, 1U);
}

TEST(PerceptionPipeline, DepthAtADegradedOrLostPoseIsNotMapped) {
  auto odometry = std::make_unique<KnowingOdometry>(CameraMount());
  KnowingOdometry& knowing = *odometry;
  PerceptionPipeline perception(std::move(odometry), StereoCamera(), options_with(false, true));
  double now = kBegin;
  perception.stereo(pair_at(now));
  EXPECT_EQ(perception.depth(now, depth_at(now)).state, InputState::kTaken);
  const auto before = perception.belief();
  for (const Localization state : {Localization::kDegraded, Localization::kLost}) {
    knowing.state = state;
    now += 0.1;
    perception.stereo(pair_at(now));
    const InputResult depth = perception.depth(now, depth_at(now));
    EXPECT_EQ(depth.state, InputState::kRefused);
    EXPECT_EQ(depth.reason, "the pose is " + std::string(to_string(state)));
    const InputResult scan = perception.scan(now, lidar());
    EXPECT_EQ(scan.state, InputState::kRefused);
    EXPECT_EQ(scan.reason, "the pose is " + std::string(to_string(state)));
    EXPECT_EQ(perception.belief()->voxels, before->voxels);
    // Mapping goes on: a guard that took the map for stale would stop the search.
    EXPECT_EQ(perception.belief()->stamps.map, now);
    EXPECT_EQ(perception.belief()->stamps.ranges, now);
  }
  // One that is late has the worse of the poses about it.
  knowing.state = Localization::kOk;
  perception.stereo(pair_at(now + 0.1));
  EXPECT_EQ(perception.depth(now + 0.05, depth_at(now + 0.05)).reason, "the pose is lost");
  EXPECT_EQ(perception.depth(now + 0.1, depth_at(now + 0.1)).state, InputState::kTaken);
}

/// A body that rises and tilts.
Isometry3d in_space(double stamp) {
  const double t = stamp - kBegin;
  Isometry3d T = Isometry3d::Identity();
  T.translation() << 0.2 * t, 0.0, 0.1 * t;
  T.linear() = (Eigen::AngleAxisd(0.3 * t, Vector3d::UnitZ()) *
                Eigen::AngleAxisd(-0.1 * t, Vector3d::UnitY()))
                   .toRotationMatrix();
  return T;
}

TEST(PerceptionPipeline, ABodyThatIsFreeInSpaceByPosesFromOutside) {
  PerceptionOptions options = options_with(false, true);
  options.start_in_space = in_space(kBegin);
  const auto drive = [&](bool late) {
    PerceptionPipeline perception(options);
    EXPECT_EQ(perception.belief()->localization, Localization::kLost);
    const auto depth = [&](double stamp) {
      const DepthImage image =
          test::DepthScene().render(kDepthCamera.camera, in_space(stamp) * kDepthCamera.mount.T_BC);
      return perception.depth(stamp, image).state;
    };
    // Poses at 10 Hz, depth at 4 Hz.
    for (int k = 0; k <= 10; ++k) {
      const double now = kBegin + 0.1 * k;
      if (!late && k % 5 == 3) {
        EXPECT_EQ(depth(now - 0.05), InputState::kWaiting);
      }
      EXPECT_EQ(perception.external_pose({.stamp = now, .T_WB = in_space(now)}).state,
                InputState::kTaken);
      if (k >= 9) perception.belief();  // of two poses, for the velocity
      if (late && k % 5 == 3) {
        EXPECT_EQ(depth(now - 0.05), InputState::kTaken);
      }
      if (k % 5 == 0) {
        EXPECT_EQ(depth(now), InputState::kTaken);
      }
      if (k % 5 == 3) {
        const Isometry3d T_WC = in_space(now - 0.05) * kDepthCamera.mount.T_BC;
        EXPECT_LT((perception.mapped().T_WC.matrix() - T_WC.matrix()).norm(), 2e-3);
      }
    }
    EXPECT_EQ(perception.input(InputSource::kDepth).taken, 5U);
    EXPECT_EQ(perception.pose_in_space(0.0).matrix(), in_space(kBegin + 1.0).matrix());
    return perception.belief();
  };
  const auto belief = drive(false);
  EXPECT_EQ(belief->voxels->data(), drive(true)->voxels->data());
  EXPECT_EQ(belief->localization, Localization::kOk);
  EXPECT_EQ(belief->localization_source, LocalizationSource::kExternal);
  EXPECT_EQ(belief->landmarks, nullptr);
  EXPECT_EQ(belief->stamp, kBegin + 1.0);
  EXPECT_EQ(belief->stamps.map, kBegin + 1.0);
  EXPECT_NEAR(belief->pose.yaw, 0.3, 1e-12);
  EXPECT_NEAR(belief->pose.position.z(), 0.1, 1e-12);
  EXPECT_NEAR(belief->twist.yaw_rate, 0.3, 1e-6);
  EXPECT_GT(belief->ground->free_cells(), 200);
}

// Two lidars at two places and a camera, of the same stamps, each with its own origin and reach.
TEST(PerceptionPipeline, MapsWithSeveralDepthSensorsEachFromWhereItIs) {
  PerceptionOptions options = options_with(false, false);
  options.more_depth_cameras[2] = kDepthCamera;
  options.more_depth_cameras[2].range = DepthRange{0.3, 1.0};
  const auto drive = [&](const std::vector<int>& sensors) {
    PerceptionPipeline perception(options);
    for (int k = 0; k <= 10; ++k) {
      const double now = kBegin + 0.1 * k;
      perception.external_pose({.stamp = now, .T_WB = body_transform(truth(now))});
      for (const int sensor : sensors) {
        if (sensor == 2) {
          EXPECT_EQ(perception.depth(now, depth_at(now), 2).state, InputState::kTaken);
          continue;
        }
        // A short wall in front of each of the lidars, which stand 0.3 m apart.
        DepthScan scan;
        scan.origin = {sensor == 0 ? 0.15 : -0.15, 0.0, 0.35};
        for (int i = -5; i <= 5; ++i) {
          // Never the same twice, as of a lidar that hangs.
          const double range = 1.0 + 1e-4 * k;
          scan.hits.push_back(scan.origin + Vector3d(sensor == 0 ? range : -range, 0.02 * i, 0.0));
        }
        EXPECT_EQ(perception.scan(now, scan, sensor).state, InputState::kTaken) << sensor;
      }
    }
    return perception.belief();
  };
  const auto known = [](const Belief& belief) {
    return belief.ground->free_cells() + belief.ground->occupied_cells();
  };
  const auto all = drive({0, 1, 2});
  EXPECT_GT(known(*all), known(*drive({0})) + 5);
  EXPECT_GT(known(*all), known(*drive({0, 1})));
  EXPECT_LT(known(*drive({2})), known(*drive({0, 1, 2})));
  EXPECT_EQ(all->stamps.ranges, kBegin + 1.0);
  // The camera's reach is its own: nothing is learned beyond it.
  const int near = known(*drive({2}));
  options.more_depth_cameras[2].range = DepthRange{0.3, 4.0};
  EXPECT_GT(known(*drive({2})), 1.5 * near);
  // One that stops makes all ranges old.
  PerceptionPipeline perception(options);
  for (int k = 0; k <= 5; ++k) {
    perception.external_pose(
        {.stamp = kBegin + 0.1 * k, .T_WB = body_transform(truth(kBegin + 0.1 * k))});
    perception.scan(kBegin + 0.1 * k, lidar(k), 0);
    if (k <= 2) perception.scan(kBegin + 0.1 * k, lidar(k), 1);
  }
  EXPECT_EQ(perception.belief()->stamps.ranges, kBegin + 0.2);
  EXPECT_EQ(perception.scan(kBegin + 0.5, lidar(9), 1).state, InputState::kTaken);
  EXPECT_EQ(perception.belief()->stamps.ranges, kBegin + 0.5);
  EXPECT_EQ(perception.scan(kBegin + 0.5, lidar(), 1).state, InputState::kLate);
  EXPECT_EQ(perception.scan(kBegin + 0.6, lidar(), 16).reason, "of sensor 16; expected 0 to 15");
  EXPECT_EQ(perception.depth(kBegin + 0.6, depth_at(kBegin), 1).state, InputState::kRefused);
}

TEST(PerceptionPipeline, PosesComeFromOneSource) {
  PerceptionPipeline own = pipeline_with(options_with(false, false));
  EXPECT_EQ(own.external_pose({.stamp = kBegin}).reason, "the odometry gives the poses");
  PerceptionPipeline given(options_with(false, false));
  EXPECT_EQ(given.stereo(pair_at(kBegin)).reason, "there is no odometry: poses come from outside");
  ExternalPose pose{.stamp = kBegin};
  pose.T_WB.linear() *= 2.0;
  EXPECT_EQ(given.external_pose(pose).reason, "the pose is no rotation and translation");
  pose = {.stamp = kBegin + 1.0, .T_WB = body_transform(truth(kBegin + 1.0))};
  pose.covariance(0, 0) = 0.25;
  EXPECT_EQ(given.external_pose(pose).state, InputState::kTaken);
  EXPECT_EQ(given.external_pose(pose).state, InputState::kLate);
  EXPECT_EQ(given.belief()->covariance(0, 0), 0.25);
  EXPECT_EQ(given.belief()->pose.position, truth(kBegin + 1.0).position);
}

TEST(PerceptionPipeline, OfAPoseFromOutsideTheCovarianceSaysHowSureItIs) {
  struct Case {
    double x, yaw;  // variances
    Localization state;
  };
  for (const Case& c :
       {Case{0.0, 0.0, Localization::kOk}, Case{0.2, 0.04, Localization::kOk},
        Case{0.2, 0.06, Localization::kDegraded}, Case{0.0, 0.3, Localization::kDegraded},
        Case{1.1, 0.0, Localization::kLost}, Case{-0.1, 0.0, Localization::kLost},
        Case{kNaN, 0.0, Localization::kLost}}) {
    PerceptionPipeline perception(options_with(false, false));
    ExternalPose pose{.stamp = kBegin};
    pose.covariance(0, 0) = c.x;
    pose.covariance(2, 2) = 100.0;  // it stands on the floor
    pose.covariance(3, 3) = c.yaw;
    perception.external_pose(pose);
    EXPECT_EQ(perception.belief()->localization, c.state) << c.x << " " << c.yaw;
    EXPECT_EQ(perception.belief()->covariance(2, 2), 0.0);
    const bool mapped = perception.scan(kBegin + 0.01, lidar()).state == InputState::kTaken;
    EXPECT_EQ(mapped, c.state == Localization::kOk);
  }
}

TEST(PerceptionPipeline, WhatWasMappedBeforeAPoseJumpedMayBeOffByTheJump) {
  PerceptionPipeline perception(options_with(false, false));
  const auto tell = [&](double after, double x, const PoseJumps& jumps = {}) {
    ExternalPose pose{.stamp = kBegin + after};
    pose.T_WB.translation().x() = x;
    pose.covariance(0, 0) = pose.covariance(1, 1) = 0.01;
    pose.jumps = jumps;
    EXPECT_EQ(perception.external_pose(pose).state, InputState::kTaken);
  };
  tell(0.0, 0.0);
  perception.belief();
  tell(0.1, 0.05);
  EXPECT_NEAR(perception.belief()->twist.linear.x(), 0.5, 1e-9);
  const PoseJumps jumped{1, 0.8, 0.1};
  tell(0.2, 0.85, jumped);
  const auto belief = perception.belief();
  EXPECT_EQ(belief->twist.linear.norm(), 0.0) << "it is no motion";
  EXPECT_NEAR(belief->covariance(0, 0), 0.01 + 0.64, 1e-12);
  EXPECT_NEAR(belief->covariance(1, 1), 0.01 + 0.64, 1e-12);
  EXPECT_NEAR(belief->covariance(3, 3), 0.01, 1e-12);
  EXPECT_EQ(belief->localization, Localization::kOk) << "what it says of itself counts";
  // Nobody knows where the robot was between the two.
  EXPECT_EQ(perception.scan(kBegin + 0.15, lidar()).state, InputState::kLate);
  tell(0.3, 0.9, jumped);
  EXPECT_EQ(perception.scan(kBegin + 0.25, lidar()).state, InputState::kTaken);
  EXPECT_NEAR(perception.mapped().T_WC.translation().x(), 0.875, 1e-9);
  EXPECT_NEAR(perception.belief()->covariance(0, 0), 0.65, 1e-12);
}

// SLAM corrects its map by 3 m and 30 degrees while the robot drives on.
TEST(PerceptionPipeline, WhenTheMapIsCorrectedTheRobotGoesOnInW) {
  const Isometry3d T_OW = body_transform({{-4.0, 2.0, 0.0}, 0.7});  // the odometry's own frame
  const auto drive = [&](const std::vector<Isometry3d>& maps) {
    PerceptionPipeline perception(options_with(false, false));
    for (std::size_t k = 0; k < maps.size(); ++k) {
      const double stamp = kBegin + 0.2 * static_cast<double>(k);
      ExternalPose pose{.stamp = stamp, .T_WB = maps[k] * body_transform(truth(stamp))};
      pose.T_OB = T_OW * body_transform(truth(stamp));
      pose.covariance.diagonal() << 0.04, 0.01, 0.0, 0.01;
      for (std::size_t m = 1; m <= k; ++m) {
        pose.corrections += maps[m].matrix() != maps[m - 1].matrix();
      }
      EXPECT_EQ(perception.external_pose(pose).state, InputState::kTaken);
      perception.scan(stamp, lidar());
    }
    return perception.belief();
  };
  const Isometry3d I = Isometry3d::Identity(), T = body_transform({{3.0, 0.0, 0.0}, M_PI / 6});
  const auto plain = drive({I, I, I, I, I}), corrected = drive({I, I, T, T, I});
  EXPECT_EQ(plain->map_frame, nullptr);
  EXPECT_EQ(plain->voxels->data(), corrected->voxels->data()) << "nothing that was drawn moves";
  EXPECT_LT((plain->pose.position - corrected->pose.position).norm(), 1e-9);
  EXPECT_LT((plain->twist.linear - corrected->twist.linear).norm(), 1e-6) << "it is no motion";
  EXPECT_LT((plain->covariance - corrected->covariance).norm(), 1e-12);
  EXPECT_EQ(corrected->map_frame->taken, 2);
  EXPECT_LT(corrected->map_frame->origin.position.norm(), 1e-9) << "there and back";

  const auto there = drive({I, I, T});
  EXPECT_LT((there->map_frame->origin.position - T.translation()).norm(), 1e-9);
  EXPECT_NEAR(there->map_frame->origin.yaw, M_PI / 6, 1e-9);
  EXPECT_NEAR(there->map_frame->newest->turn, M_PI / 6, 1e-9);
  // Its covariance is told in the map.
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(-M_PI / 6).toRotationMatrix();
  const Eigen::Matrix2d P = R * Eigen::Vector2d(0.04, 0.01).asDiagonal() * R.transpose();
  EXPECT_LT((there->covariance.topLeftCorner<2, 2>() - P).norm(), 1e-12);
}

TEST(PerceptionPipeline, ACorrectionThatCannotBeIsRefusedAndSaid) {
  PerceptionPipeline perception(options_with(false, false));
  const auto tell = [&](double after, double x, int corrections, bool odometry = true) {
    ExternalPose pose{.stamp = kBegin + after};
    pose.T_WB.translation().x() = x;
    if (odometry) pose.T_OB = Isometry3d::Identity();
    pose.corrections = corrections;
    return perception.external_pose(pose);
  };
  EXPECT_EQ(tell(0.0, 0.0, 0).state, InputState::kTaken);
  const InputResult far = tell(0.1, 5000.0, 1);
  EXPECT_EQ(far.state, InputState::kRefused);
  EXPECT_NE(far.reason.find("expected at most 100 m"), std::string::npos) << far.reason;
  EXPECT_EQ(perception.belief()->stamps.pose, kBegin) << "it gets old, and the guard stops";
  EXPECT_EQ(perception.belief()->map_frame->refused, 1);
  EXPECT_EQ(tell(0.2, 2.0, 2, false).state, InputState::kRefused) << "nobody says how it went on";
  EXPECT_EQ(tell(0.3, 2.0, 2).state, InputState::kTaken);
  EXPECT_EQ(perception.belief()->pose.position.x(), 0.0);
  EXPECT_EQ(perception.belief()->map_frame->taken, 1);

  // Of who keeps the map beside a robot that localizes itself.
  PerceptionPipeline own = pipeline_with(options_with(false, false));
  Correction correction;
  correction.stamp = kBegin;
  correction.T_new_old.translation().x() = 0.5;
  EXPECT_EQ(own.correct(correction).state, InputState::kTaken);
  correction.stamp = kNaN;
  EXPECT_EQ(own.correct(correction).state, InputState::kRefused);
  EXPECT_EQ(own.belief()->map_frame->origin.position.x(), 0.5);
}

TEST(PerceptionPipeline, WheelsAloneLocalizeAndTheirErrorGrowsWithTheWay) {
  PerceptionPipeline perception(options_with(true, true));
  EXPECT_EQ(perception.belief()->localization, Localization::kLost) << "nothing is heard";
  EXPECT_EQ(perception.stereo(pair_at(kBegin)).reason, "there is no odometry: wheels tell poses");
  EXPECT_EQ(perception.external_pose({.stamp = kBegin}).reason, "the wheels give the poses");
  double sigma = 0.0;
  for (int k = 0; k <= 100; ++k) {
    const double now = kBegin + 0.05 * k;
    EXPECT_EQ(perception.wheels(wheels_at(now)).state, InputState::kTaken);
    if (k % 10 != 5) continue;
    // Between two samples, and entered where the body was then.
    EXPECT_EQ(perception.depth(now - 0.02, depth_at(now - 0.02)).state, InputState::kTaken);
    const Isometry3d T_WC = body_transform(truth(now - 0.02)) * kDepthCamera.mount.T_BC;
    EXPECT_LT((perception.mapped().T_WC.matrix() - T_WC.matrix()).norm(), 5e-3);
    const auto belief = perception.belief(now);
    EXPECT_EQ(belief->localization, Localization::kOk);
    EXPECT_EQ(belief->localization_source, LocalizationSource::kExternal);
    EXPECT_EQ(belief->landmarks, nullptr);
    EXPECT_LT((belief->pose.position - truth(now).position).norm(), 1e-9);
    EXPECT_EQ(belief->stamps.pose, now);
    EXPECT_NEAR(belief->twist.linear.x(), kSpeed, 1e-12);
    EXPECT_GT(belief->covariance(0, 0) + belief->covariance(1, 1), sigma);
    sigma = belief->covariance(0, 0) + belief->covariance(1, 1);
  }
  const auto silent = perception.belief(kBegin + 5.0 + 0.5);
  EXPECT_EQ(silent->localization, Localization::kLost);
  EXPECT_EQ(silent->stamps.pose, kBegin + 5.0) << "its age stops the robot";
  EXPECT_GT(perception.belief()->ground->free_cells(), 200);
}

// A picture for people is no localization.
TEST(PerceptionPipeline, WithoutAnOdometryThereAreNoSightings) {
  PerceptionPipeline perception(options_with(false, false));
  EXPECT_EQ(perception.stereo(pair_at(kBegin)).state, InputState::kRefused);
  EXPECT_TRUE(perception.sightings().empty());
}

TEST(PerceptionPipeline, RefusesOptionsOutOfRange) {
  const auto refused = [](const std::function<void(PerceptionOptions&)>& spoil) {
    PerceptionOptions options = options_with(true, true);
    spoil(options);
    EXPECT_THROW(PerceptionPipeline(StereoCamera(), options), std::invalid_argument);
  };
  refused([](PerceptionOptions& o) { o.start.yaw = kNaN; });
  refused([](PerceptionOptions& o) { o.same_time = -1.0; });
  refused([](PerceptionOptions& o) { o.max_age = 0.0; });
  refused([](PerceptionOptions& o) { o.max_age = 2.0 * o.wheel_fusion.max_wait; });
  refused([](PerceptionOptions& o) { o.max_ahead = kNaN; });
  refused([](PerceptionOptions& o) { o.max_leap = 0.0; });
  refused([](PerceptionOptions& o) { o.start_in_space = Isometry3d::Identity(); });  // wheels
  refused([](PerceptionOptions& o) {
    o.wheels = false;
    o.start_in_space = Isometry3d::Identity();
    o.start_in_space->linear() *= 2.0;
  });
  refused([](PerceptionOptions& o) { o.most_waiting = -1; });
  refused([](PerceptionOptions& o) { o.stereo_mount.T_BC.linear() *= 2.0; });
  refused([](PerceptionOptions& o) { o.depth_camera->mount.T_BC.linear() *= 2.0; });
  refused([](PerceptionOptions& o) { o.depth_camera->camera.fx = 0.0; });
  EXPECT_THROW(PerceptionPipeline(nullptr, StereoCamera(), PerceptionOptions()),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::perception_pipeline_test
