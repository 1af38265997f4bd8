// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/trajectory_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"

namespace prospect::trajectory_error_test {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d pose(double x, double y, double yaw) {
  Isometry3d T = Isometry3d::Identity();
  T.linear() = AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  T.translation() << x, y, 0.0;
  return T;
}

TEST(TrajectoryError, AStraightPathWithAWrongScale) {
  // 21 poses 0.5 m apart, the estimate 2 % too long.
  std::vector<PosePair> pairs;
  for (int i = 0; i <= 20; ++i)
    pairs.push_back({0.1 * i, pose(0.51 * i, 0, 0), pose(0.5 * i, 0, 0)});
  EXPECT_NEAR(path_length(pairs), 10.0, 1e-12);
  const EndError end = end_error(pairs);
  EXPECT_NEAR(end.translation, 0.2, 1e-12);
  EXPECT_NEAR(end.share, 0.02, 1e-12);
  EXPECT_NEAR(end.rotation, 0.0, 1e-12);
  const RelativeError one = relative_error(pairs, 1.0);
  EXPECT_EQ(one.segments, 19);
  EXPECT_NEAR(one.translation, 0.02, 1e-12);
  EXPECT_EQ(relative_error(pairs, 10.0).segments, 1);
  EXPECT_EQ(relative_error(pairs, 10.1).segments, 0);
  // Errors grow as 0.01 i: rmse = 0.01 sqrt(mean i^2).
  const AbsoluteError ate = absolute_error(pairs, Alignment::kFirstPose);
  EXPECT_NEAR(ate.rmse, 0.01 * std::sqrt(2870.0 / 21.0), 1e-12);
  EXPECT_NEAR(ate.max, 0.2, 1e-12);
  EXPECT_NEAR(ate.median, 0.1, 1e-12);
  // The best fit is centred: what is left is 0.01 (i - 10).
  EXPECT_NEAR(absolute_error(pairs, Alignment::kBestFit).rmse, 0.01 * std::sqrt(770.0 / 21.0),
              1e-9);
}

TEST(TrajectoryError, AWrongScaleIsToldFromErrorsThatAreNone) {
  using Verdict = ScaleAgreement::Verdict;
  const auto drive = [](double scale, int poses, double step) {
    std::vector<PosePair> pairs;
    for (int i = 0; i < poses; ++i) {
      const double a = 0.05 * i, r = step / 0.05;
      const Isometry3d truth = pose(r * std::sin(a), r * (1 - std::cos(a)), a);
      Isometry3d estimate = truth;
      estimate.translation() *= scale;
      // A millimetre of noise, and a loss that puts the last third elsewhere.
      estimate.translation().y() += i % 2 == 0 ? 1e-3 : -1e-3;
      if (3 * i > 2 * poses) estimate.translation().x() += 0.7;
      pairs.push_back({0.1 * i, estimate, truth});
    }
    return pairs;
  };
  for (const double scale : {0.5, 0.9, 1.1, 1.5}) {
    const ScaleAgreement wrong = scale_of(drive(scale, 60, 0.05));
    EXPECT_EQ(wrong.verdict, Verdict::kDisagree) << scale;
    EXPECT_NEAR(wrong.ratio, scale, 0.01 * scale);
  }
  for (const double scale : {0.97, 1.0, 1.04}) {
    EXPECT_EQ(scale_of(drive(scale, 60, 0.05)).verdict, Verdict::kAgree) << scale;
  }
  // 0.3 m are too little to tell; so is a robot at rest whose truth trembles by three millimetres.
  EXPECT_EQ(scale_of(drive(1.5, 7, 0.05)).verdict, Verdict::kUnknown);
  std::vector<PosePair> rest;
  for (int i = 0; i < 500; ++i) {
    rest.push_back({0.1 * i, pose(0, 0, 0), pose(i % 2 == 0 ? 0.003 : 0.0, 0, 0)});
  }
  EXPECT_EQ(scale_of(rest).verdict, Verdict::kUnknown);
  EXPECT_EQ(scale_of({}).samples, 0);
}

TEST(TrajectoryError, ATurnedFrameIsNoErrorAndATurningEstimateIs) {
  std::vector<PosePair> turned, turning;
  const Isometry3d G = pose(3, -2, 0.7);
  for (int i = 0; i <= 20; ++i) {
    const Isometry3d truth = pose(0.5 * i, 0.02 * i * i, 0.03 * i);
    turned.push_back({0.1 * i, G * truth, truth});
    turning.push_back({0.1 * i, truth * pose(0, 0, 0.01 * i), truth});
  }
  EXPECT_NEAR(end_error(turned).translation, 0.0, 1e-12);
  EXPECT_NEAR(absolute_error(turned, Alignment::kFirstPose).rmse, 0.0, 1e-12);
  EXPECT_NEAR(absolute_error(turned, Alignment::kBestFit).rmse, 0.0, 1e-9);
  EXPECT_NEAR(relative_error(turned, 2.0).rotation, 0.0, 1e-7);
  EXPECT_NEAR(end_error(turning).rotation, 0.2, 1e-9);
  // 0.01 rad a step, and steps are 0.50 to 0.93 m long.
  EXPECT_LT(relative_error(turning, 2.0).rotation, 0.01 / 0.50);
  EXPECT_GT(relative_error(turning, 2.0).rotation, 0.01 / 0.93);
}

TEST(TrajectoryError, AssociatesByTimeAndInterpolates) {
  const Trajectory truth = {{1.0, pose(0, 0, 0)}, {1.2, pose(2, 0, 0.2)}, {3.0, pose(9, 0, 0)}};
  const Trajectory estimate = {{0.9, pose(0, 0, 0)},
                               {1.0, pose(0, 0, 0)},
                               {1.05, pose(1, 0, 0)},
                               {2.0, pose(0, 0, 0)},
                               {3.1, pose(0, 0, 0)}};
  const auto pairs = associate(estimate, truth);
  ASSERT_EQ(pairs.size(), 2u);  // before, in a gap of 1.8 s and after: none
  EXPECT_EQ(pairs[0].stamp, 1.0);
  EXPECT_NEAR(pairs[1].truth.translation().x(), 0.5, 1e-9);
  EXPECT_NEAR(AngleAxisd(pairs[1].truth.linear()).angle(), 0.05, 1e-9);
}

class TrajectoryFile : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("prospect_trajectory_" + std::to_string(::getpid()) + ".txt"))
                                 .string();
    std::ofstream(path) << text;
    return path;
  }
  std::string refusal(const std::string& text, bool tum) {
    const std::string path = write(text);
    try {
      std::vector<std::string> notes;
      if (tum) {
        read_tum_trajectory(path, notes);
      } else {
        read_kitti_poses(path, notes);
      }
    } catch (const InputError& error) {
      return std::string(error.what()).substr(path.size());
    }
    return "";
  }
};

TEST_F(TrajectoryFile, ReadsBackWhatItWrites) {
  const Trajectory written = {{0.0, pose(1, 2, 0.3)}, {0.1, pose(-4, 5.5, -2.0)}};
  std::vector<std::string> notes;
  const Trajectory tum = read_tum_trajectory(write("# a comment\n" + tum_text(written)), notes);
  const auto poses = read_kitti_poses(write(kitti_text(written)), notes);
  ASSERT_EQ(poses.size(), 2u);
  const Trajectory kitti = {{0.0, poses[0]}, {0.1, poses[1]}};
  EXPECT_TRUE(notes.empty());
  for (const Trajectory& read : {tum, kitti}) {
    ASSERT_EQ(read.size(), 2u);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(read[i].stamp, written[i].stamp, 1e-9);
      EXPECT_LE((read[i].T.matrix() - written[i].T.matrix()).norm(), 1e-7);
    }
  }
}

TEST_F(TrajectoryFile, RefusesWithOneLine) {
  using ::testing::HasSubstr;
  EXPECT_THAT(refusal("1 2 3\n", true), HasSubstr(":1: not a pose"));
  EXPECT_THAT(refusal("1 0 0 0 0 0 0 nan\n", true), HasSubstr(":1: not a pose"));
  EXPECT_THAT(refusal("1 0 0 0 0 0 0 2\n", true), HasSubstr(":1: not a pose"));
  EXPECT_THAT(refusal("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", true), HasSubstr(":2: the stamp"));
  EXPECT_THAT(refusal("# nothing\n", true), HasSubstr("no pose"));
  EXPECT_THAT(refusal("1 0 0 0 0 1 0 0 0 0 1\n", false), HasSubstr(":1: not a pose"));
  EXPECT_THAT(refusal("1 0 0 0 0 1 0 0 0 0 2 0\n", false), HasSubstr("expected finite"));
  std::vector<std::string> notes;
  EXPECT_THROW(read_tum_trajectory("/nowhere/at/all", notes), InputError);
}

TEST_F(TrajectoryFile, WhatIsNoPoseIsLeftOutAndCounted) {
  for (const char* bad : {"nan 0 0 0 0 0 1", "0 0 0 0 0 0 0", "-inf -inf 0 0 0 0 1"}) {
    std::vector<std::string> notes;
    const Trajectory read = read_tum_trajectory(
        write("1 0 0 0 0 0 0 1\n2 " + std::string(bad) + "\n3 5 0 0 0 0 0 1\n"), notes);
    ASSERT_EQ(read.size(), 2u) << bad;
    EXPECT_EQ(read[1].T.translation().x(), 5.0);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_THAT(notes[0], ::testing::HasSubstr("1 of 3 poses of "));
  }
  std::vector<std::string> notes;
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const auto kitti = read_kitti_poses(write(good + "nan 0 0 0 0 1 0 0 0 0 1 0\n" + good), notes);
  ASSERT_EQ(kitti.size(), 3u);  // the others keep their lines
  EXPECT_FALSE(is_known(kitti[1]));
  EXPECT_EQ(notes.size(), 1u);
  // Nothing is interpolated across a time at which the pose was said not to be known.
  const Trajectory gap = {{0.0, kitti[0]}, {0.1, kitti[1]}, {0.2, kitti[2]}};
  for (const double t : {0.05, 0.1, 0.15}) EXPECT_FALSE(pose_at(gap, t, 0.25)) << t;
  EXPECT_TRUE(pose_at(gap, 0.2, 0.25));
}

TEST(TrajectoryColumns, TheirNamesTellTheOrderOfQuaternions) {
  EXPECT_EQ(names_w_first("# timestamp tx ty tz qx qy qz qw"), false);
  EXPECT_EQ(names_w_first("#timestamp, p_RS_R_x [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []"),
            true);
  EXPECT_EQ(names_w_first("time,px,py,pz,q_w,q_x,q_y,q_z"), true);
  EXPECT_EQ(names_w_first("stamp;QX;QY;QZ;QW"), false);
  for (const char* nothing : {"", "# timestamp, p, q", "1 2 3 4", "# of frequency x, w"}) {
    EXPECT_EQ(names_w_first(nothing), std::nullopt) << nothing;
  }
}

TEST_F(TrajectoryFile, QuaternionsWithWFirst) {
  const Eigen::Isometry3d T = pose(1, 2, 0.3);
  const Eigen::Quaterniond q(T.linear());
  const auto line = [](double a, double b, double c, double d) {
    char text[200];
    std::snprintf(text, sizeof text, "1 1 2 0 %.12f %.12f %.12f %.12f\n", a, b, c, d);
    return std::string(text);
  };
  const std::string first = line(q.w(), q.x(), q.y(), q.z());
  std::vector<std::string> notes;
  const auto named = read_tum_trajectory(write("# time x y z qw qx qy qz\n" + first), notes);
  EXPECT_LT((named[0].T.linear() - T.linear()).norm(), 1e-9);
  EXPECT_EQ(notes.size(), 1u);
  const auto unnamed = read_tum_trajectory(write(first), notes);
  EXPECT_LT((with_w_first(unnamed[0].T).linear() - T.linear()).norm(), 1e-9);
}

TEST(TrajectoryError, PublishedEstimatesOfFreiburg1Xyz) {
  const std::string folder = std::string(PROSPECT_SHARED_DATA) + "/trajectories/evo_fr1_xyz/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  std::vector<std::string> notes;
  const Trajectory truth = read_tum_trajectory(folder + "freiburg1_xyz-groundtruth.txt", notes);
  const Trajectory estimate = read_tum_trajectory(folder + "freiburg1_xyz-rgbdslam.txt", notes);
  const auto pairs = associate(estimate, truth);
  EXPECT_GT(pairs.size(), 700u);
  // About a centimetre is what RGB-D SLAM reaches on this recording.
  const AbsoluteError ate = absolute_error(pairs, Alignment::kBestFit);
  std::printf("fr1/xyz, rgbdslam: ATE %.4f m rmse over %zu poses\n", ate.rmse, pairs.size());
  EXPECT_GT(ate.rmse, 0.012);
  EXPECT_LT(ate.rmse, 0.015);
  EXPECT_EQ(scale_of(pairs).verdict, ScaleAgreement::Verdict::kAgree);
  EXPECT_NEAR(scale_of(pairs).ratio, 1.0, 0.03);
}

}  // namespace
}  // namespace prospect::trajectory_error_test
