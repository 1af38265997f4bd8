// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/stereo_depth_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "adapters/formats/datasets/depth_dataset.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/missions/recordings/map_run.h"
#include "tests/images/image_file.h"
#include "tests/perception/rendered_room.h"

namespace prospect::stereo_depth_source_test {
namespace {

namespace fs = std::filesystem;
using test::RenderedRoom;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kFrames = 6;

StereoCamera camera() {
  StereoCamera c;
  c.left = {220.0, 220.0, 160.0, 120.0, 320.0, 240.0};
  c.baseline = 0.12;
  return c;
}

/// Towards the pillar, pitched down.
Eigen::Isometry3d pose(int k) {
  Eigen::Isometry3d T = RenderedRoom::looking(0.5 + 0.15 * k, -0.4 + 0.02 * k, 0.9, 0.02 * k);
  T.rotate(Eigen::AngleAxisd(-0.35, Eigen::Vector3d::UnitX()));
  return T;
}

/// A walk through the rendered room in KITTI's layout, written anew for each test.
class StereoWalk : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (fs::temp_directory_path() / ("prospect stereo map " + std::to_string(::getpid())))
                  .string();
    fs::remove_all(folder_);
    fs::create_directories(folder_ + "/image_0");
    fs::create_directories(folder_ + "/image_1");
    write_calibration(camera().baseline);
    std::ofstream times(folder_ + "/times.txt");
    Trajectory truth;
    static const auto pairs = [] {
      std::vector<RenderedRoom::Pair> made;
      for (int k = 0; k < kFrames; ++k) {
        made.push_back(RenderedRoom().render(camera(), pose(k), 2.0, k));
      }
      return made;
    }();
    for (int k = 0; k < kFrames; ++k) {
      test::write_image(image(0, k), pairs[static_cast<std::size_t>(k)].left);
      test::write_image(image(1, k), pairs[static_cast<std::size_t>(k)].right);
      times << 0.1 * k << '\n';
      truth.push_back({0.1 * k, pose(k)});
    }
    std::ofstream(folder_ + "/poses.txt") << kitti_text(truth);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write_calibration(double baseline) const {
    std::ofstream(folder_ + "/calib.txt")
        << "P0: 220 0 160 0 0 220 120 0 0 0 1 0\n"
        << "P1: 220 0 160 " << -220.0 * baseline << " 0 220 120 0 0 0 1 0\n";
  }
  std::string image(int side, int k) const {
    char name[32];
    std::snprintf(name, sizeof name, "/image_%d/%06d.png", side, k);
    return folder_ + name;
  }
  DepthDataset open() const { return DepthDataset::open(open_stereo_depth(folder_), {}); }

  std::string folder_;
};

TEST_F(StereoWalk, IsARecordingOfDepthImages) {
  const DepthDataset dataset = open();
  EXPECT_EQ(dataset.size(), kFrames);
  EXPECT_EQ(dataset.camera().fx, 220.0);
  ASSERT_TRUE(dataset.stereo());
  EXPECT_NEAR(dataset.stereo()->noise, 0.4 / 26.4, 1e-12);
  EXPECT_NEAR(sharp_range(*dataset.stereo(), 0.1), std::sqrt(0.05 * 26.4 / 0.4), 1e-12);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("poses by the recording, of 6 of 6 frames")));
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("the metre is that of the calibration")));
  EXPECT_FALSE(dataset.depth_scale_doubtful());
  ASSERT_TRUE(dataset.has_poses());
  EXPECT_TRUE(dataset.pose(3).isApprox(pose(3), 1e-6));
  const DepthImage image = dataset.read(3);
  int right = 0, valid = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u) {
      const double z = image.at(u, v);
      if (!std::isfinite(z)) continue;
      const double truth = RenderedRoom().depth(camera().left, pose(3), u, v);
      right += std::abs(z - truth) < 3.0 * dataset.stereo()->noise * truth * truth;
      ++valid;
    }
  }
  EXPECT_GT(valid, 0.7 * 320 * 240);
  EXPECT_GT(right, 0.95 * valid);
}

TEST_F(StereoWalk, IsMapped) {
  const DepthDataset dataset = open();
  MapRunOptions options;
  options.mapper.map.resolution = 0.1;
  set_stereo_accuracy(*dataset.stereo(), sharp_range(*dataset.stereo(), 0.1), options.mapper);
  const MapRun run = run_mapping(dataset, options);
  ASSERT_TRUE(run.maps.ground) << run.no_ground;
  EXPECT_NEAR(summarize(run).height_median, 0.9 - 0.013, 0.02);
  // The pillar's faces, and the floor: within a cell of where they are, of the recording's world.
  const Eigen::Isometry3d T_DW = run.T_WD.inverse();
  const GroundMap& map = *run.maps.ground;
  int occupied = 0, free = 0;
  for (int n = 0; n < map.frame().size(); ++n) {
    const Cell c = map.frame().at(n);
    const Eigen::Vector2d at = map.frame().center(c);
    const Eigen::Vector3d p = T_DW * Eigen::Vector3d(at.x(), at.y(), 0.0);
    const double inside = std::min({p.x() - 2.53, 3.17 - p.x(), p.y() + 0.71, 0.11 - p.y()});
    if (map.state(c) == CellState::kOccupied) {
      ++occupied;
      EXPECT_GT(inside, -0.15) << p.transpose();
    } else if (map.state(c) == CellState::kFree) {
      ++free;
      EXPECT_LT(inside, 0.1) << p.transpose();
    }
  }
  EXPECT_GE(occupied, 6);
  EXPECT_GT(free, 100);
}

TEST_F(StereoWalk, WithoutPosesTheOdometryGivesThem) {
  fs::remove(folder_ + "/poses.txt");
  // A frame that shows nothing has no pose.
  for (const int side : {0, 1}) test::write_image(image(side, 3), Image(320, 240, 100));
  const DepthDataset dataset = open();
  EXPECT_EQ(dataset.size() + dataset.without_pose(), kFrames);
  EXPECT_GE(dataset.size(), 4);
  EXPECT_GE(dataset.without_pose(), 1);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("poses by the visual odometry")));
  const int last = dataset.size() - 1;
  EXPECT_NEAR(dataset.stamp(last), 0.5, 1e-9);
  const Eigen::Isometry3d moved = pose(0).inverse() * pose(5);
  const Eigen::Isometry3d found = dataset.pose(0).inverse() * dataset.pose(last);
  EXPECT_LT((moved.translation() - found.translation()).norm(), 0.01);
  // None has a pose where nothing is seen at all.
  for (int k = 0; k < kFrames; ++k) {
    for (const int side : {0, 1}) test::write_image(image(side, k), Image(320, 240, 100));
  }
  try {
    open_stereo_depth(folder_);
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("none of 6 frames has a pose by the visual odometry"));
  }
}

TEST_F(StereoWalk, PosesContradictAWrongBaseline) {
  write_calibration(0.18);
  const DepthDataset dataset = open();
  EXPECT_TRUE(dataset.depth_scale_doubtful());
  EXPECT_THAT(dataset.notes().back(), HasSubstr("the baseline, the focal length or the poses"));
}

TEST_F(StereoWalk, IsMappedWhereThereIsNothingBetter) {
  EXPECT_TRUE(is_used_for_stereo_depth(folder_, {}));
  Found found = Found::kUnknown;
  EXPECT_THAT(inspection_text(inspect_path(folder_, {}, {}, found)),
              HasSubstr("for `prospect odometry` and `prospect map`"));
  fs::create_directories(folder_ + "/depth");
  test::write_image(folder_ + "/depth/000.png", Image(320, 240, 100));
  EXPECT_FALSE(is_used_for_stereo_depth(folder_, {}));
  EXPECT_FALSE(is_used_for_stereo_depth(folder_ + "/image_0", {}));
}

}  // namespace
}  // namespace prospect::stereo_depth_source_test
