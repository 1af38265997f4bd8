// SPDX-License-Identifier: Apache-2.0
#include "perception/places/view_loops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "perception/odometry/se3.h"
#include "tests/perception/rendered_room.h"

namespace prospect::view_loops_test {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

StereoCamera camera() {
  StereoCamera camera;
  camera.left = {220.0, 220.0, 159.5, 119.5, 320.0, 240.0};
  return camera;
}

/// Round the room twice, looking ahead, by an odometry that turns a little too far each step.
struct Rounds {
  ViewLoops loops{camera()};
  std::vector<Eigen::Isometry3d> truth;

  explicit Rounds(int steps) {
    const test::RenderedRoom room;
    constexpr double kTurned = 0.005;  // [rad] a step
    Eigen::Isometry3d measured;
    Matrix6d noise = 1e-6 * Matrix6d::Identity();
    noise(4, 4) = 24.0 * kTurned * kTurned;  // about y, down: what adds up in a round
    for (int n = 0; n < steps; ++n) {
      const double angle = 2.0 * M_PI * n / 24;
      const Eigen::Isometry3d T = test::RenderedRoom::looking(
          1.2 * std::cos(angle) - 0.3, 1.2 * std::sin(angle), 1.05, angle + 0.5 * M_PI);
      if (n == 0) {
        measured = T;
      } else {
        Eigen::Matrix<double, 6, 1> off = Eigen::Matrix<double, 6, 1>::Zero();
        off[4] = kTurned;
        measured = measured * truth.back().inverse() * T * exp_se3(off);
      }
      const auto pair = room.render(camera(), T, 2.0, static_cast<std::uint64_t>(n));
      const int before = loops.views();
      loops.keyframe(measured, noise, pair.left.view(), pair.right.view());
      EXPECT_EQ(loops.views(), before + 1);
      truth.push_back(T);
    }
    loops.settle();
  }
  double error(int view) const {
    return (loops.pose(view).translation() - truth[static_cast<std::size_t>(view)].translation())
        .norm();
  }
  double drift(int view) const {
    return (loops.measured(view).translation() -
            truth[static_cast<std::size_t>(view)].translation())
        .norm();
  }
};

TEST(ViewLoops, ASecondRoundTakesBackTheDrift) {
  const Rounds rounds(42);
  ASSERT_GT(rounds.loops.used(), 3U);
  EXPECT_GT(rounds.drift(41), 0.15);
  EXPECT_LT(rounds.error(41), 0.25 * rounds.drift(41));
  for (std::size_t n = 0; n < rounds.loops.loops().size(); ++n) {
    if (rounds.loops.state(n) != LoopState::kUsed) continue;
    const ViewLoops::Loop& loop = rounds.loops.loops()[n];
    const Eigen::Isometry3d off = loop.alignment.measured.T.inverse() *
                                  rounds.truth[static_cast<std::size_t>(loop.older)].inverse() *
                                  rounds.truth[static_cast<std::size_t>(loop.newer)];
    EXPECT_LT(off.translation().norm(), 0.1) << loop.older << ' ' << loop.newer;
  }
  // Where the odometry goes on is corrected alike.
  const Eigen::Isometry3d next = rounds.loops.corrected(rounds.loops.measured(41));
  EXPECT_TRUE(next.isApprox(rounds.loops.pose(41)));
}

/// Round the room twice by an exact odometry that is lost in between: it goes on in a new map, a
/// quarter turn and a metre off, which it says itself to be off by half a metre and as many
/// radians.
TEST(ViewLoops, AMapThatBeganAnewIsJoined) {
  const test::RenderedRoom room;
  ViewLoops loops{camera()};
  Eigen::Isometry3d off = Eigen::Isometry3d::Identity();
  off.linear() = Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitZ()).matrix();
  off.translation() << 0.8, -0.6, 0.0;
  std::vector<Eigen::Isometry3d> truth;
  for (int n = 0; n < 46; ++n) {
    const double angle = 2.0 * M_PI * n / 24;
    truth.push_back(test::RenderedRoom::looking(1.2 * std::cos(angle) - 0.3, 1.2 * std::sin(angle),
                                                1.05, angle + 0.5 * M_PI));
    const auto pair = room.render(camera(), truth.back(), 2.0, static_cast<std::uint64_t>(n));
    OdometryFrame frame;
    frame.T_WC = n < 24 ? truth.back() : off * truth.back();
    frame.covariance_since_keyframe = 1e-5 * Matrix6d::Identity();
    frame.restarted = n == 24;
    if (frame.restarted) frame.covariance = 0.25 * Matrix6d::Identity();
    loops.keyframe(frame, pair.left.view(), pair.right.view());
  }
  loops.settle();
  ASSERT_EQ(loops.views(), 46);
  EXPECT_GE(loops.used(), 2U);
  EXPECT_GT((loops.measured(40).translation() - truth[40].translation()).norm(), 0.9);
  for (int k = 30; k < 46; ++k) {
    const Eigen::Isometry3d left = truth[static_cast<std::size_t>(k)].inverse() * loops.pose(k);
    EXPECT_LT(left.translation().norm(), 0.15) << k;
    EXPECT_LT(Eigen::AngleAxisd(left.linear()).angle(), 0.06) << k;
  }
}

TEST(ViewLoops, NothingIsMovedWithoutALoop) {
  const Rounds rounds(15);
  EXPECT_TRUE(rounds.loops.loops().empty());
  for (int k = 0; k < 15; ++k) EXPECT_TRUE(rounds.loops.pose(k).isApprox(rounds.loops.measured(k)));
}

TEST(ViewLoops, BlankImagesAndAbsurdCovariancesAreBorne) {
  ViewLoops loops(camera());
  const Image blank(320, 240, 90);
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  EXPECT_TRUE(loops.corrected(T).isApprox(T));
  for (int n = 0; n < 30; ++n) {
    loops.keyframe(T, n % 2 ? Matrix6d::Zero().eval() : Matrix6d::Constant(1e30).eval(),
                   blank.view(), blank.view());
    T.translation().x() += 0.5;
  }
  EXPECT_EQ(loops.views(), 30);
  EXPECT_TRUE(loops.loops().empty());
  EXPECT_TRUE(loops.corrected(T).matrix().allFinite());
}

}  // namespace
}  // namespace prospect::view_loops_test
