// SPDX-License-Identifier: Apache-2.0
// What moves in view, or is carried in it, against an IMU: from images to the pose.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "perception/pipeline/perception_pipeline.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/rendered_room.h"

namespace prospect::imu_gate_test {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::RenderedRoom;

constexpr double kPeriod = 0.1, kHeight = 1.05, kRate = 200.0;
constexpr int kFrames = 40;

StereoCamera stereo_camera() {
  StereoCamera camera;
  camera.left = {220.0, 220.0, 159.5, 119.5, 320.0, 240.0};
  camera.baseline = 0.12;
  return camera;
}

struct Place {
  double x = -1.6, y = -0.6, yaw = -0.3;
};
/// Stands for a second, then turns about itself, at most at 0.35 rad/s.
Place turning(double t) {
  Place p;
  p.yaw += t < 1.0 ? 0.0 : 0.35 * (1.0 - std::cos(t - 1.0));
  return p;
}
Place standing(double) { return {}; }

/// The whole view is that of a board at 1.2 m, of the texture from column `texture` on, with noise.
void cover(RenderedRoom::Pair& pair, const Image& board, int texture, std::mt19937& random) {
  const auto& camera = stereo_camera();
  const int disparity = static_cast<int>(std::lround(camera.left.fx * camera.baseline / 1.2));
  for (int v = 0; v < board.height; ++v) {
    for (int u = 0; u < board.width; ++u) {
      const auto seen = [&](int from) {
        const int grey = board.at((u + from) % board.width, v) + static_cast<int>(random() % 7) - 3;
        return static_cast<std::uint8_t>(std::clamp(grey, 0, 255));
      };
      pair.left.at(u, v) = seen(texture);
      pair.right.at(u, v) = seen(texture + disparity);
    }
  }
}

struct Outcome {
  int ok_and_wrong = 0, ok = 0, not_ok = 0;
  double worst = 0.0, worst_ratio = 0.0;
  std::string reason;
  std::vector<double> bits;
};

struct Case {
  std::function<Place(double)> path;
  bool board = false;  ///< it is all that the cameras see
  int board_pace = 0;  ///< [px a frame] to the right, from frame 12 on
  bool imu = true;
  std::function<void(ImuSample&)> fault{};
};

Outcome drive(const Case& c) {
  static const RenderedRoom room;
  static const Image board = RenderedRoom(110.0).render(
      stereo_camera().left, RenderedRoom::looking(1.0, 0.5, 1.3, 2.5), 0.0, 99);
  PerceptionOptions options;
  options.wheels = false;
  const Place start = c.path(0.0);
  options.start.position = {start.x, start.y, 0.0};
  options.start.yaw = start.yaw;
  options.stereo_mount = {CameraMount::forward_facing({0.0, 0.0, kHeight}, 0.0, 0.0)};
  PerceptionPipeline perception(stereo_camera(), options);
  std::mt19937 random(7), image_noise(11);
  std::normal_distribution<double> normal;
  const auto drawn = [&] {
    const double x = normal(random), y = normal(random), z = normal(random);
    return Vector3d(x, y, z);
  };
  Outcome outcome;
  int samples = 0;
  for (int k = 0; k < kFrames; ++k) {
    const double stamp = kPeriod * k;
    for (; samples / kRate <= stamp + 1e-9; ++samples) {
      const double t = samples / kRate, h = 1e-3;
      ImuSample s;
      s.stamp = t;
      s.angular_velocity = Vector3d(0.0, 0.0, (c.path(t + h).yaw - c.path(t - h).yaw) / (2.0 * h)) +
                           Vector3d(0.01, -0.02, 0.015) + 0.005 * drawn();
      s.linear_acceleration = Vector3d(0.08, -0.05, 9.85) + 0.05 * drawn();  // nobody moves away
      if (c.fault) c.fault(s);
      if (c.imu) perception.imu(s);
    }
    const Place p = c.path(stamp);
    const Isometry3d T_WC = RenderedRoom::looking(p.x, p.y, kHeight, p.yaw);
    RenderedRoom::Pair pair =
        room.render(stereo_camera(), T_WC, 2.0, static_cast<std::uint64_t>(k));
    if (c.board) cover(pair, board, 3200 - c.board_pace * std::max(0, k - 12), image_noise);
    perception.stereo({stamp, stamp, pair.left.view(), pair.right.view()});
    const OdometryFrame& frame = perception.frame();
    const Isometry3d off = T_WC.inverse() * frame.T_WC;
    const double turn = Eigen::AngleAxisd(off.linear()).angle(), way = off.translation().norm();
    const double claimed_turn = std::sqrt(frame.covariance.bottomRightCorner<3, 3>().trace()),
                 claimed_way = std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace());
    const bool wrong =
        (turn > 0.05 && turn > 4.0 * claimed_turn) || (way > 0.05 && way > 4.0 * claimed_way);
    const bool ok = frame.state == Localization::kOk;
    outcome.ok_and_wrong += ok && wrong;
    (ok ? outcome.ok : outcome.not_ok) += 1;
    outcome.worst = std::max({outcome.worst, turn, way});
    if (!frame.reason.empty()) outcome.reason = frame.reason;
    for (int i = 0; i < 12; ++i) outcome.bits.push_back(frame.T_WC.matrix()(i % 3, i / 3));
    for (int i = 0; i < 6; ++i) outcome.bits.push_back(frame.covariance(i, i));
  }
  return outcome;
}

void say(const char* name, const Outcome& o) {
  std::printf("%s: %d ok, %d not, %d ok and wrong; off by %.3f m or rad; %s\n", name, o.ok,
              o.not_ok, o.ok_and_wrong, o.worst, o.reason.c_str());
}

TEST(ImuGate, ARobotThatTurnsIsFollowedAsWithoutIt) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const Outcome with = drive({.path = turning}), without = drive({.path = turning, .imu = false});
  say("with an IMU", with);
  EXPECT_EQ(with.not_ok, without.not_ok);
  EXPECT_LT(with.worst, without.worst + 0.005);
  EXPECT_EQ(with.ok_and_wrong, 0);
  EXPECT_EQ(drive({.path = turning}).bits, with.bits);  // same calls, same bits
}

TEST(ImuGate, ABoardThatIsCarriedWhileTheGyroTurnsIsNotRest) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const Outcome with = drive({.path = turning, .board = true}),
                without = drive({.path = turning, .board = true, .imu = false});
  say("carried, with an IMU", with);
  say("carried, without", without);
  EXPECT_GT(without.ok_and_wrong, 10);  // nothing in the images says so
  EXPECT_EQ(with.ok_and_wrong, 0);
}

TEST(ImuGate, ABoardThatCrossesWhileTheGyroRestsIsNotTheWorld) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // At 0.4 m/s: it would turn nothing, but the accelerometer would have felt the start.
  const Outcome with = drive({.path = standing, .board = true, .board_pace = 7}),
                without = drive({.path = standing, .board = true, .board_pace = 7, .imu = false});
  say("crossing, with an IMU", with);
  say("crossing, without", without);
  EXPECT_GT(without.ok_and_wrong, 10);
  EXPECT_EQ(with.ok_and_wrong, 0);
}

TEST(ImuGate, AnImuThatIsAtFaultHarmsNothing) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const Outcome without = drive({.path = turning, .imu = false});
  const std::function<void(ImuSample&)> nan = [](ImuSample& s) {
    s.angular_velocity.x() = std::numeric_limits<double>::quiet_NaN();
  };
  const std::function<void(ImuSample&)> frozen = [](ImuSample& s) {
    if (s.stamp > 0.5) {
      s.angular_velocity = {0.01, 0.02, 0.03};
      s.linear_acceleration = {0.0, 0.1, 9.8};
    }
  };
  EXPECT_EQ(drive({.path = turning, .fault = nan}).bits, without.bits);
  const Outcome hung = drive({.path = turning, .fault = frozen});
  EXPECT_LE(hung.not_ok, without.not_ok + 1);
  EXPECT_LT(hung.worst, without.worst + 0.005);
  const Outcome axes = drive({.path = turning, .fault = [](ImuSample& s) {
                                std::swap(s.angular_velocity.x(), s.angular_velocity.z());
                              }});
  say("wrong axes", axes);
  EXPECT_EQ(axes.ok_and_wrong, 0);
  EXPECT_LE(axes.not_ok, without.not_ok + 8);
  EXPECT_LT(axes.worst, without.worst + 0.005);
}

TEST(ImuGate, InputsAreCountedAsThoseOfOtherSources) {
  PerceptionOptions options;
  options.wheels = false;
  PerceptionPipeline perception(stereo_camera(), options);
  ImuSample s;
  s.linear_acceleration = {0.0, 0.0, 9.8};
  const auto at = [&](double stamp, double w) {
    s.stamp = stamp;
    s.angular_velocity.z() = w;
    return perception.imu(s).state;
  };
  EXPECT_EQ(at(10.0, 0.1), InputState::kTaken);
  EXPECT_EQ(at(10.0, 0.2), InputState::kLate);
  EXPECT_EQ(at(10.1, 0.1), InputState::kRefused);  // it hangs
  EXPECT_EQ(at(10.2, std::nan("")), InputState::kRefused);
  EXPECT_EQ(at(std::nan(""), 0.3), InputState::kRefused);
  EXPECT_EQ(at(1e5, 0.3), InputState::kRefused);  // of another clock
  EXPECT_EQ(at(10.3, 0.3), InputState::kTaken);
  const InputCount& count = perception.input(InputSource::kImu);
  EXPECT_EQ(count.taken, 2U);
  EXPECT_EQ(count.late, 1U);
  EXPECT_EQ(count.refused, 4U);
  PerceptionPipeline outside{PerceptionOptions()};
  EXPECT_NE(outside.imu(s).reason, "");
}

}  // namespace
}  // namespace prospect::imu_gate_test
