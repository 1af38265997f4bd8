// SPDX-License-Identifier: Apache-2.0
#include "perception/odometry/stereo_odometry.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "engine/support/cholesky.h"
#include "engine/support/eigenvalues.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/image_faults.h"
#include "tests/perception/rendered_room.h"

namespace prospect::stereo_odometry_test {
namespace {

using Eigen::Isometry3d;
using test::RenderedRoom;
using test::StereoFrame;

StereoCamera small_camera() {
  StereoCamera camera;
  camera.left = {330.0, 330.0, 240.0, 180.0, 480.0, 360.0};
  camera.baseline = 0.12;
  return camera;
}

constexpr double kPeriod = 0.1;

/// An arc through the room at 0.5 m/s and 0.17 rad/s.
Isometry3d arc(int k) {
  const double yaw = -0.3 + 0.017 * k;
  const double s = 0.05 * k;
  return RenderedRoom::looking(-1.6 + s * std::cos(-0.3 + 0.0085 * k),
                               -0.6 + s * std::sin(-0.3 + 0.0085 * k), 1.05, yaw);
}

struct Sequence {
  std::vector<StereoFrame> frames;
  std::vector<Isometry3d> T_WC;
};

const Sequence& moving() {
  static const Sequence sequence = [] {
    Sequence s;
    const RenderedRoom room;
    for (int k = 0; k < 40; ++k) {
      s.T_WC.push_back(arc(k));
      auto pair = room.render(small_camera(), arc(k), 2.0, k);
      s.frames.push_back({kPeriod * k, std::move(pair.left), std::move(pair.right)});
    }
    return s;
  }();
  return sequence;
}

double path_length(const std::vector<Isometry3d>& poses) {
  double length = 0.0;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    length += (poses[k].translation() - poses[k - 1].translation()).norm();
  }
  return length;
}

TEST(StereoOdometry, FollowsAnArc) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const Sequence& s = moving();
  StereoOdometry odometry(small_camera(), {}, s.T_WC[0]);
  int keyframes = 0;
  OdometryFrame last;
  double worst = 0.0, normalised = 0.0;
  for (std::size_t k = 0; k < s.frames.size(); ++k) {
    last = odometry.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
    EXPECT_EQ(last.state, Localization::kOk) << k << ": " << last.reason;
    keyframes += last.keyframe;
    const Isometry3d error = last.T_WC.inverse() * s.T_WC[k];  // T_CW_est T_WC_true
    worst = std::max(worst, error.translation().norm());
    if (k > 0) {
      const Eigen::Matrix<double, 6, 1> xi = log_se3(error);
      normalised += xi.dot(last.covariance.ldlt().solve(xi)) / 6.0 / (s.frames.size() - 1);
    }
  }
  const double length = path_length(s.T_WC);
  std::printf(
      "rendered arc: worst error %.1f mm over %.2f m, %d keyframes, normalised error %.2f, "
      "disparity offset %.3f +- %.3f px\n",
      1e3 * worst, length, keyframes, normalised, last.disparity_offset,
      last.disparity_offset_sigma);
  EXPECT_LT(worst, 0.008 * length);
  const Isometry3d error = s.T_WC.back().inverse() * last.T_WC;
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), 0.3 * M_PI / 180.0);
  EXPECT_LT(keyframes, 20);
  // One run, errors that follow each other: a wide band, but neither ten times too sure nor too
  // shy.
  EXPECT_GT(normalised, 0.02);
  EXPECT_LT(normalised, 6.0);
  EXPECT_NEAR(last.disparity_offset, 0.0, 4.0 * last.disparity_offset_sigma);

  const auto map = odometry.landmarks();
  EXPECT_GT(map->landmarks.size(), 100u);
  for (const Landmark& l : map->landmarks) {
    EXPECT_GT(l.survival, 0.0);
    EXPECT_LE(l.survival, 1.0);
    EXPECT_NEAR(l.creation_direction.norm(), 1.0, 1e-9);
  }
}

/// The pair with a thing before it, at a metre and of the texture of `board`, in columns `from` to
/// `to` of the left image, from a quarter of its height or the row `top` down.
StereoFrame covered(const StereoFrame& frame, const Image& board, int from, int to, int texture,
                    std::optional<int> top = {}) {
  StereoFrame out{frame.stamp, frame.left, frame.right};
  const int disparity =
      static_cast<int>(std::lround(small_camera().left.fx * small_camera().baseline));
  for (int v = top.value_or(board.height / 4); v < board.height; ++v) {
    for (int u = std::max(from, 0); u < std::min(to, board.width); ++u) {
      const std::uint8_t grey = board.at((u + texture) % board.width, v);
      out.left.at(u, v) = grey;
      if (u >= disparity) out.right.at(u - disparity, v) = grey;
    }
  }
  return out;
}

const Image& board() {
  static const Image image = RenderedRoom(110.0).render(
      small_camera().left, RenderedRoom::looking(1.0, 0.5, 1.3, 2.5), 0.0, 99);
  return image;
}

TEST(StereoOdometry, WhatIsCarriedInViewIsNotRest) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // More than half of the view rests in the image: an arm with a board, or a trolley.
  const Sequence& s = moving();
  StereoOdometry odometry(small_camera(), {}, s.T_WC[0]);
  double worst = 0.0, last = 0.0;
  for (std::size_t k = 0; k < s.frames.size(); ++k) {
    const StereoFrame seen = covered(s.frames[k], board(), 120, 480, 0);
    const auto frame = odometry.process(seen.stamp, seen.left.view(), seen.right.view());
    last = (frame.T_WC.translation() - s.T_WC[k].translation()).norm();
    const double claimed = std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace());
    worst = std::max(worst, last > 0.02 ? last / claimed : 0.0);
    if (k > 2) {
      EXPECT_NE(frame.state, Localization::kOk) << k;
    }
  }
  std::printf("board carried in view: off by %.3f m of %.2f m at the end, error over claim %.2f\n",
              last, path_length(s.T_WC), worst);
  EXPECT_LT(worst, 4.0);
}

TEST(StereoOdometry, APersonWhoPassesMovesNothing) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // A third of the view, at 1.5 m/s, before a robot that drives on.
  const Sequence& s = moving();
  StereoOdometry odometry(small_camera(), {}, s.T_WC[0]);
  double worst = 0.0;
  for (std::size_t k = 0; k < s.frames.size(); ++k) {
    const int at = 40 * (static_cast<int>(k) - 10) - 160;
    const StereoFrame seen = covered(s.frames[k], board(), at, at + 160, 4800 - at);
    const auto frame = odometry.process(seen.stamp, seen.left.view(), seen.right.view());
    EXPECT_NE(frame.state, Localization::kLost) << k;
    worst = std::max(worst, (frame.T_WC.translation() - s.T_WC[k].translation()).norm());
  }
  std::printf("person who passes: worst error %.1f mm\n", 1e3 * worst);
  EXPECT_LT(worst, 0.02);
}

TEST(StereoOdometry, WhatComesInsteadOfAllThatWasSeenMayMove) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // A board moves before two thirds of the view, and then before all of it: landmarks on it are
  // there already, and nothing tells it from a world. What the camera does by them is measured, and
  // not believed for as long as a loss makes a new map.
  const Sequence& s = moving();
  StereoOdometry undisturbed(small_camera(), {}, s.T_WC[0]);
  StereoOdometry odometry(small_camera(), {}, s.T_WC[0]);
  const int width = board().width;
  int frames = 0;
  double worst = 0.0, off = 0.0, claimed = 0.0, before = 0.0, grown = 0.0;
  for (std::size_t k = 0; k < s.frames.size(); ++k) {
    const StereoFrame& f = s.frames[k];
    const auto free = undisturbed.process(f.stamp, f.left.view(), f.right.view());
    EXPECT_EQ(free.reason.find("seen before"), std::string::npos) << k << ": " << free.reason;
    const int shown = k < 8 ? 0 : k < 13 ? 2 * width / 3 : width;
    const StereoFrame seen = covered(f, board(), 0, shown, 4800 - 12 * static_cast<int>(k), 0);
    const auto frame = odometry.process(f.stamp, seen.left.view(), seen.right.view());
    off = (frame.T_WC.translation() - s.T_WC[k].translation()).norm();
    claimed = std::sqrt(frame.covariance.topLeftCorner<3, 3>().trace());
    if (off > 0.05) worst = std::max(worst, off / claimed);
    if (shown < width) continue;
    // Since frame 10, the last whose landmarks were known: 2 s.
    const bool unknown = k <= 30;
    EXPECT_EQ(frame.reason.find("hardly anything seen before") != std::string::npos, unknown)
        << k << ": " << frame.reason;
    if (unknown) {
      EXPECT_NE(frame.state, Localization::kOk) << k;
      frames += 1;
      if (frames == 1) before = claimed;
      grown = claimed - before;
    }
  }
  std::printf(
      "a board before all of the view: %d frames not known, off by %.2f m, claimed %.2f, at most "
      "%.1f times\n",
      frames, off, claimed, worst);
  EXPECT_LT(worst, 4.0);
  // 0.6 m/s each way.
  EXPECT_NEAR(grown, std::sqrt(3.0) * 0.6 * kPeriod * (frames - 1), 0.05 * grown);
}

TEST(StereoOdometry, BeforeAnyMotionWasSeenItMayGoAnywhere) {
  const Sequence& s = moving();
  Image plain(static_cast<int>(small_camera().left.width),
              static_cast<int>(small_camera().left.height));
  // Lost at once: nothing is known of the velocity. Lost later: it went on as it did, or otherwise.
  for (const std::size_t seen : {std::size_t{1}, std::size_t{6}}) {
    StereoOdometry odometry(small_camera(), {}, s.T_WC[0]);
    OdometryFrame last;
    for (std::size_t k = 0; k < seen; ++k) {
      const StereoFrame& f = s.frames[k];
      last = odometry.process(f.stamp, f.left.view(), f.right.view());
    }
    const Eigen::Matrix<double, 6, 6> before = last.covariance;
    for (int k = 1; k <= 3; ++k) {
      const double since = kPeriod * k;
      // Not the same twice: that is a frozen image.
      std::fill(plain.pixels.begin(), plain.pixels.end(), static_cast<std::uint8_t>(100 + k));
      const auto lost = odometry.process(last.stamp + since, plain.view(), plain.view());
      ASSERT_EQ(lost.state, Localization::kLost);
      const double moved = (s.T_WC[seen].translation() - s.T_WC[seen - 1].translation()).norm();
      const double speed = seen == 1 ? 0.6 : 0.2 + moved / kPeriod;
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(std::sqrt(lost.covariance(axis, axis) - before(axis, axis)), speed * since,
                    seen == 1 ? 1e-9 : 0.1 * speed * since)
            << seen << " frames, axis " << axis;
      }
      if (seen == 1) {
        EXPECT_NEAR(std::sqrt(lost.covariance(4, 4) - before(4, 4)), 0.3 * since, 1e-9);
      }
    }
  }
}

TEST(StereoOdometry, AMotionAheadIsClaimedAsWhenItIsMade) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // Straight ahead, by a tenth of the distance of what is in view.
  const RenderedRoom room;
  const auto at = [](double x) { return RenderedRoom::looking(x, -0.6, 1.05, 0.1); };
  const double turned = std::cos(0.1);
  StereoOdometry odometry(small_camera(), {}, at(-1.5));
  EXPECT_FALSE(odometry.motion_ahead());
  const auto first = room.render(small_camera(), at(-1.5), 2.0, 900);
  odometry.process(0.0, first.left.view(), first.right.view());
  const std::optional<MotionAhead> ahead = odometry.motion_ahead();
  ASSERT_TRUE(ahead);
  const double way = ahead->T_CC.translation().z();
  EXPECT_GT(way, 0.05);
  EXPECT_LT(way, 1.0);
  constexpr int kFrames = 4;
  OdometryFrame last;
  for (int k = 1; k <= kFrames; ++k) {
    const auto pair =
        room.render(small_camera(), at(-1.5 + way * turned * k / kFrames), 2.0, 900 + k);
    last = odometry.process(kPeriod * k, pair.left.view(), pair.right.view());
    ASSERT_NE(last.state, Localization::kLost) << last.reason;
  }
  const auto made = odometry.covariance_since(kFrames);
  ASSERT_TRUE(made);
  std::printf(
      "a motion of %.2f m: along %.2f mm claimed ahead, %.2f then; across %.2f, %.2f; "
      "%d points ahead, %d then\n",
      way, 1e3 * std::sqrt(ahead->covariance(2, 2)), 1e3 * std::sqrt((*made)(2, 2)),
      1e3 * std::sqrt(ahead->covariance(0, 0)), 1e3 * std::sqrt((*made)(0, 0)), ahead->tracked,
      last.tracked);
  // What the calibration leaves is the same; how patches will be tracked is guessed.
  EXPECT_NEAR(ahead->covariance(2, 2) / (*made)(2, 2), 1.0, 0.2);
  for (int axis = 0; axis < 6; ++axis) {
    EXPECT_NEAR(std::log2(ahead->covariance(axis, axis) / (*made)(axis, axis)), 0.0, 4.0) << axis;
  }
  EXPECT_NEAR(ahead->tracked, last.tracked, 0.4 * ahead->tracked);
}

TEST(StereoOdometry, FollowsAHeadThatTurnsFast) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // Six degrees of freedom at 20 Hz, up to 3.7 rad/s, at full size; the first step is 10 degrees,
  // with nothing known of the motion.
  const StereoCamera camera;
  const RenderedRoom room;
  std::vector<double> plain, keyframes;
  std::unique_ptr<StereoOdometry> odometry;
  double length = 0.0, worst = 0.0;
  Isometry3d before = Isometry3d::Identity();
  for (int k = 0; k < 30; ++k) {
    const double t = 0.1 * k;
    Isometry3d T =
        RenderedRoom::looking(0.2 + 0.7 * std::sin(0.9 * t), 0.1 + 0.6 * std::sin(1.3 * t + 0.4),
                              1.2 + 0.3 * std::sin(1.1 * t), 0.9 * std::sin(1.5 * t) + 0.5 * t);
    T.linear() = T.linear() * Eigen::AngleAxisd(0.2 * std::sin(2.1 * t), Eigen::Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(0.2 * std::sin(1.7 * t + 1.0), Eigen::Vector3d::UnitX());
    if (k == 0) {
      odometry = std::make_unique<StereoOdometry>(camera, StereoOdometryOptions{}, T);
    } else {
      length += (T.translation() - before.translation()).norm();
    }
    before = T;
    const auto pair = room.render(camera, T, 2.0, k);
    const auto frame = odometry->process(0.05 * k, pair.left.view(), pair.right.view());
    EXPECT_EQ(frame.state, Localization::kOk) << k << ": " << frame.reason;
    worst = std::max(worst, (frame.T_WC.translation() - T.translation()).norm());
    (frame.keyframe ? keyframes : plain).push_back(frame.times.processor);
  }
  std::sort(plain.begin(), plain.end());
  std::sort(keyframes.begin(), keyframes.end());
  std::printf("640 x 480, fast turns: worst error %.1f mm over %.2f m", 1e3 * worst, length);
  if (!plain.empty()) {
    std::printf("; processor ms a frame: median %.1f, largest %.1f (%zu)", plain[plain.size() / 2],
                plain.back(), plain.size());
  }
  std::printf("; with a keyframe: median %.1f, largest %.1f (%zu)\n",
              keyframes[keyframes.size() / 2], keyframes.back(), keyframes.size());
  EXPECT_LT(worst, 0.005 * length);
}

TEST(StereoOdometry, SameFramesSameBits) {
  NOT_UNDER_SANITIZERS("the release build compares bits");
  const Sequence& s = moving();
  StereoOdometry first(small_camera()), second(small_camera());
  for (int k = 0; k < 15; ++k) {
    const auto a =
        first.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
    const auto b =
        second.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
    ASSERT_EQ(a.T_WC.matrix(), b.T_WC.matrix());
    ASSERT_EQ(a.covariance, b.covariance);
    ASSERT_EQ(a.tracked, b.tracked);
  }
}

TEST(StereoOdometry, ACalibrationSaidToBeExactClaimsLessAndMovesNoPose) {
  const Sequence& s = moving();
  // What motion says of the disparities' zero is weighed against the rest of the calibration.
  StereoOdometryOptions assumed;
  assumed.disparity_offset.prior_angle = 0.0;
  StereoOdometryOptions exact = assumed;
  exact.calibration = {0.0, 0.0, 0.0};
  StereoOdometry usual(small_camera(), assumed, s.T_WC[0]), sure(small_camera(), exact, s.T_WC[0]);
  OdometryFrame a, b;
  for (std::size_t k = 0; k <= 20; ++k) {
    const StereoFrame& f = s.frames[k];
    a = usual.process(f.stamp, f.left.view(), f.right.view());
    b = sure.process(f.stamp, f.left.view(), f.right.view());
    EXPECT_EQ(a.T_WC.matrix(), b.T_WC.matrix()) << k;
  }
  // The errors of a usual calibration are independent of all others: what they add is a covariance.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> added(
      Eigen::Matrix<double, 6, 6>(a.covariance - b.covariance));
  EXPECT_GT(added.eigenvalues()[0], -1e-6 * added.eigenvalues()[5]);
  // A principal point that is off by 0.5 px tilts the way of a camera that turns.
  std::printf("said to be exact: %.2f mm down, %.3f mrad about the axis; else %.2f and %.3f\n",
              1e3 * std::sqrt(b.covariance(1, 1)), 1e3 * std::sqrt(b.covariance(5, 5)),
              1e3 * std::sqrt(a.covariance(1, 1)), 1e3 * std::sqrt(a.covariance(5, 5)));
  EXPECT_LT(b.covariance(1, 1), 0.5 * a.covariance(1, 1));
  EXPECT_LT(b.covariance(5, 5), 0.5 * a.covariance(5, 5));
  // What is left is not too little: one run, so a wide band.
  const Eigen::Matrix<double, 6, 1> xi = log_se3(b.T_WC.inverse() * s.T_WC[20]);
  EXPECT_LT(xi.dot(b.covariance.ldlt().solve(xi)) / 6.0, 6.0);
}

TEST(StereoOdometry, MappingOnASecondThreadFollowsAsWell) {
  const Sequence& s = moving();
  StereoOdometryOptions options;
  options.background_mapping = true;
  StereoOdometry odometry(small_camera(), options, s.T_WC[0]);
  StereoOdometry one_thread(small_camera(), {}, s.T_WC[0]);
  int keyframes = 0, entered_later = 0;
  double worst = 0.0, ms = 0.0, ms_one_thread = 0.0;
  for (std::size_t k = 0; k < s.frames.size(); ++k) {
    const OdometryFrame frame =
        odometry.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
    EXPECT_NE(frame.state, Localization::kLost) << k << ": " << frame.reason;
    worst = std::max(worst, (frame.T_WC.translation() - s.T_WC[k].translation()).norm());
    EXPECT_FALSE(frame.covariance.hasNaN());
    keyframes += frame.keyframe;
    entered_later += frame.matched > 0 && k > 0 && !frame.keyframe;
    const OdometryFrame same =
        one_thread.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
    if (k > 0) ms = std::max(ms, frame.times.processor);
    if (k > 0) ms_one_thread = std::max(ms_one_thread, same.times.processor);
    // Nearer to the camera's own pace: landmarks come a frame or two late.
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf(
      "two threads: worst error %.1f mm, %d keyframes, landmarks entered later %d times; longest "
      "frame %.1f ms of the processor, on one thread %.1f ms\n",
      1e3 * worst, keyframes, entered_later, ms, ms_one_thread);
  EXPECT_LT(worst, 0.008 * path_length(s.T_WC));
  EXPECT_GT(keyframes, 2);
  EXPECT_GE(entered_later, 1);
  // A map that goes, or is carried elsewhere, while landmarks are on their way.
  for (int end = 3; end < 12; ++end) {
    StereoOdometry short_lived(small_camera(), options, s.T_WC[0]);
    for (int k = 0; k < end; ++k) {
      short_lived.process(s.frames[3 * k].stamp, s.frames[3 * k].left.view(),
                          s.frames[3 * k].right.view());
    }
    StereoOdometry moved = std::move(short_lived);
    moved.process(s.frames[3 * end].stamp, s.frames[3 * end].left.view(),
                  s.frames[3 * end].right.view());
  }
}

// Before tiles, each landmark has others like it beside it. A base that begins to turn within a
// frame shifts the image by one of them; where wheels tell, the right ones are found.
TEST(StereoOdometry, BeforeTilesAMeasuredMotionFindsTheRightOnes) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const RenderedRoom room(70.0, 0.16);
  double worst[2] = {0.0, 0.0};
  for (const bool told : {false, true}) {
    double x = 0.0, yaw = -0.5 * M_PI + 0.3;
    const auto pose = [&] { return RenderedRoom::looking(x, -1.21, 1.05, yaw); };
    Isometry3d last = pose();
    StereoOdometry odometry(small_camera(), {}, last);
    for (int k = 0; k < 16; ++k) {
      const auto pair = room.render(small_camera(), pose(), 2.0, k);
      // As by wheels: 1 % and 2 mrad off.
      Isometry3d motion = last.inverse() * pose();
      motion.translation() *= 1.01;
      motion.rotate(Eigen::AngleAxisd(0.002, Eigen::Vector3d::UnitY()));
      const auto frame = odometry.process(kPeriod * k, pair.left.view(), pair.right.view(),
                                          told ? std::optional<Isometry3d>(motion) : std::nullopt);
      if (told) {
        EXPECT_EQ(frame.state, Localization::kOk) << k << ": " << frame.reason;
      }
      if (frame.state != Localization::kLost) {
        last = pose();
        const Isometry3d error = frame.T_WC.inverse() * pose();
        worst[told] = std::max(
            {worst[told], error.translation().norm(), Eigen::AngleAxisd(error.linear()).angle()});
      }
      // At rest, then to and fro by about a tile, in view of the wall alone.
      if (k >= 3) yaw += k % 2 ? 0.12 : -0.12;
      x += 0.01;
    }
  }
  std::printf("off by %.4f m or rad at most, without the motion %.4f\n", worst[1], worst[0]);
  EXPECT_LT(worst[1], 0.005);
  EXPECT_GT(worst[0], 0.1);  // else these tiles are none
}

TEST(StereoOdometry, NothingDriftsAtRest) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const RenderedRoom room;
  StereoOdometry odometry(small_camera());
  double worst = 0.0;
  for (int k = 0; k < 20; ++k) {
    const auto pair = room.render(small_camera(), arc(10), 2.0, 100 + k);
    const auto frame = odometry.process(kPeriod * k, pair.left.view(), pair.right.view());
    EXPECT_EQ(frame.state, Localization::kOk) << frame.reason;
    EXPECT_EQ(frame.keyframe, k == 0);
    worst = std::max(worst, frame.T_WC.translation().norm());
  }
  EXPECT_LT(worst, 0.002);
}

TEST(StereoOdometry, AMiscalibratedDisparityIsFoundWhileMoving) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  // The right camera's principal point is half a pixel off: all disparities too small by 0.5 px.
  const RenderedRoom room;
  StereoCamera true_right = small_camera();
  true_right.left.cx += 0.5;
  const Sequence& s = moving();
  double error[2];
  for (const bool estimate : {false, true}) {
    StereoOdometryOptions options;
    if (!estimate) options.disparity_offset.prior_angle = 0.0;
    StereoOdometry odometry(small_camera(), options, s.T_WC[0]);
    OdometryFrame last;
    for (std::size_t k = 0; k < s.frames.size(); ++k) {
      Isometry3d T_right = s.T_WC[k];
      T_right.translation() += 0.12 * T_right.linear().col(0);
      static std::vector<Image> right;
      if (right.size() <= k) right.push_back(room.render(true_right.left, T_right, 2.0, 5000 + k));
      last = odometry.process(s.frames[k].stamp, s.frames[k].left.view(), right[k].view());
    }
    error[estimate] = (last.T_WC.translation() - s.T_WC.back().translation()).norm();
    if (estimate) {
      EXPECT_NEAR(last.disparity_offset, 0.5, 0.2);
    }
  }
  std::printf(
      "disparity 0.5 px off: end error %.1f mm without, %.1f mm with the offset estimated\n",
      1e3 * error[0], 1e3 * error[1]);
  EXPECT_LT(error[1], 0.5 * error[0]);
}

TEST(StereoOdometry, CamerasOutOfStepSayWhatDepthsMayBeOffBy) {
  // A turn of 0.4 rad/s at 0.5 m/s; the right image is taken tau later. Depths, and so the way, are
  // wrong by a share that a wrong focal length would explain as well.
  StereoCamera camera = small_camera();
  camera.left = {165.0, 165.0, 120.0, 90.0, 240.0, 180.0};
  const RenderedRoom room;
  const auto at = [](double t) {
    return RenderedRoom::looking(-1.6 + 0.5 * t, -0.6, 1.05, -0.3 + 0.4 * t);
  };
  for (const double tau : {0.0, 0.02}) {
    StereoOdometry odometry(camera, {}, at(0.0));
    OdometryFrame last;
    for (int k = 0; k <= 20; ++k) {
      const double t = kPeriod * k;
      Isometry3d T_right = at(t + tau);
      T_right.translation() += camera.baseline * T_right.linear().col(0);
      const Image left = room.render(camera.left, at(t), 2.0, 700 + k);
      const Image right = room.render(camera.left, T_right, 2.0, 800 + k);
      last = odometry.process(t, left.view(), right.view());
    }
    const double way = (at(2.0).translation() - at(0.0).translation()).norm();
    const double share = (last.T_WC.translation() - at(0.0).translation()).norm() / way - 1.0;
    std::printf(
        "right camera %.0f ms late: %.1f +- %.1f ms found, way off by %.1f %%, depths may be "
        "by %.1f %%\n",
        1e3 * tau, 1e3 * last.camera_time_offset, 1e3 * last.camera_time_offset_sigma,
        100.0 * share, 100.0 * last.camera_time_offset_depth);
    EXPECT_NEAR(last.camera_time_offset, tau, 0.005);
    EXPECT_LT(std::abs(share), 0.01 + 4.0 * last.camera_time_offset_depth);
    if (tau == 0.0) {
      EXPECT_LT(last.camera_time_offset_depth, 0.04);
    } else {
      EXPECT_GT(last.camera_time_offset_depth, 0.2);
    }
  }
}

TEST(StereoOdometry, RefusesBadCamerasAndOptions) {
  StereoCamera camera = small_camera();
  camera.baseline = -0.1;
  EXPECT_THROW(StereoOdometry{camera}, std::invalid_argument);
  StereoOdometryOptions options;
  options.pyramid_levels = 0;
  EXPECT_THROW(StereoOdometry(small_camera(), options), std::invalid_argument);
}

TEST(StereoOdometry, BlankFromTheStartIsLostUntilThereIsSomething) {
  StereoOdometry odometry(small_camera());
  const Image blank(480, 360, 100);
  for (int k = 0; k < 3; ++k) {
    const auto frame = odometry.process(kPeriod * k, blank.view(), blank.view());
    EXPECT_EQ(frame.state, Localization::kLost);
    EXPECT_FALSE(frame.reason.empty());
  }
  const auto& f = moving().frames[5];
  EXPECT_EQ(odometry.process(1.0, f.left.view(), f.right.view()).state, Localization::kOk);
}

TEST(StereoOdometry, FaultsAreNoticedAndOvercome) {
  const Sequence& s = moving();
  const int begin = 7, first = 15, recovery = 2;
  std::printf("%-20s %-9s %-48s %s\n", "fault", "state", "reason", "after it");
  for (const test::ImageFault& fault : test::image_faults()) {
    SCOPED_TRACE(fault.name);
    StereoOdometry odometry(small_camera(), {}, s.T_WC[begin]);
    test::FaultOutcome outcome(fault, first);
    Isometry3d before = s.T_WC[begin];
    for (int k = begin; k < first + fault.count + recovery + 4; ++k) {
      const bool faulty = outcome.faulty(k);
      if (faulty && !fault.apply) continue;
      const StereoFrame frame =
          faulty ? fault.apply(s.frames[k], s.frames[first - 1], k - first) : s.frames[k];
      const OdometryFrame out =
          odometry.process(frame.stamp, frame.left.view(), frame.right.view());
      ASSERT_TRUE(out.T_WC.matrix().allFinite());
      ASSERT_FALSE(out.covariance.hasNaN());
      // Where the pose is claimed, it is right: no jump, whatever happened.
      const double error = (out.T_WC.translation() - s.T_WC[k].translation()).norm();
      if (out.state != Localization::kLost && out.reason.find("frozen") == std::string::npos) {
        EXPECT_LT(error, 0.05) << k << " " << out.reason;
      }
      const double step = (out.T_WC.translation() - before.translation()).norm();
      EXPECT_LT(step, 0.06 * (fault.count + 2)) << k;
      before = out.T_WC;
      outcome.add(k, out);
      EXPECT_TRUE(out.state == Localization::kOk || !out.reason.empty());
    }
    outcome.expect(recovery);
  }
}

TEST(StereoOdometry, WhatBlurHidesIsFoundInASmallerImage) {
  const Sequence& s = moving();
  StereoOdometry odometry(small_camera(), {}, s.T_WC[5]);
  for (int k = 5; k < 26; ++k) {
    SCOPED_TRACE(k);
    const bool blurred = k >= 12 && k < 22;
    StereoFrame frame = s.frames[k];
    if (blurred) {
      frame.left = test::box_blur(frame.left, 7);
      frame.right = test::box_blur(frame.right, 7);
    }
    const auto out = odometry.process(frame.stamp, frame.left.view(), frame.right.view());
    EXPECT_EQ(out.state, blurred ? Localization::kDegraded : Localization::kOk) << out.reason;
    EXPECT_FALSE(out.restarted);
    EXPECT_FALSE(blurred && out.keyframe);
    const double off = (out.T_WC.translation() - s.T_WC[k].translation()).norm();
    EXPECT_LT(off, 0.05);
    EXPECT_LT(off, 1e-9 + 4.0 * std::sqrt(out.covariance.topLeftCorner<3, 3>().trace()));
  }
}

TEST(StereoOdometry, AfterASecondOfDarknessItGoesOnWhereTheRobotHasGone) {
  // 0.5 rad/s: the view has moved by 29 degrees when there is light again.
  const RenderedRoom room;
  const auto pose = [](int k) {
    return RenderedRoom::looking(-1.0 + 0.04 * k, -0.2, 1.05, -0.5 + 0.05 * k);
  };
  StereoOdometry odometry(small_camera(), {}, pose(0));
  for (int k = 0; k < 16; ++k) {
    SCOPED_TRACE(k);
    const bool dark = k >= 4 && k < 14;
    auto pair = room.render(small_camera(), pose(k), 2.0, k);
    if (dark) {
      pair.left = pair.right = Image(480, 360);
      pair.left.at(k, 0) = pair.right.at(k, 0) = 1;  // no picture is frozen
    }
    const auto frame = odometry.process(kPeriod * k, pair.left.view(), pair.right.view());
    EXPECT_FALSE(frame.restarted);
    EXPECT_EQ(frame.state == Localization::kLost, dark) << frame.reason;
    if (!dark) {
      EXPECT_LT((frame.T_WC.translation() - pose(k).translation()).norm(), 0.02);
    }
  }
}

TEST(StereoOdometry, LostForLongBeginsANewMapAndSaysSo) {
  const Sequence& s = moving();
  StereoOdometryOptions options;
  options.restart_after = 1.0;
  StereoOdometry odometry(small_camera(), options);
  for (int k = 0; k < 5; ++k) {
    odometry.process(s.frames[k].stamp, s.frames[k].left.view(), s.frames[k].right.view());
  }
  // The robot is carried to where it has never looked.
  const RenderedRoom room;
  bool restarted = false;
  double sigma_before = 0.0;
  for (int k = 5; k < 25 && !restarted; ++k) {
    const auto pair = room.render(
        small_camera(), RenderedRoom::looking(1.0, 1.5, 1.2, 2.6 + 0.002 * k), 2.0, 300 + k);
    const auto frame = odometry.process(kPeriod * k, pair.left.view(), pair.right.view());
    restarted = frame.restarted;
    if (!restarted) {
      EXPECT_EQ(frame.state, Localization::kLost);
      EXPECT_GT(frame.covariance(0, 0), sigma_before);
      // It went at 0.5 m/s when it was seen last, and may have gone on.
      EXPECT_GT(std::sqrt(frame.covariance(0, 0)), 0.5 * kPeriod * (k - 4)) << k;
      sigma_before = frame.covariance(0, 0);
    } else {
      EXPECT_EQ(frame.state, Localization::kDegraded);
      EXPECT_GE(frame.covariance(0, 0), sigma_before);
    }
  }
  EXPECT_TRUE(restarted);
}

}  // namespace
}  // namespace prospect::stereo_odometry_test
