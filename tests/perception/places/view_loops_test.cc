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
