// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/map_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "tests/perception/depth_faults.h"
#include "tests/perception/depth_recording.h"

namespace prospect::map_run_test {
namespace {

namespace fs = std::filesystem;
using test::DepthRecording;
using ::testing::HasSubstr;

constexpr double kDegree = M_PI / 180.0;

MapRunOptions fine() {
  MapRunOptions options;
  options.mapper.map.resolution = 0.05;
  return options;
}

class MapRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (fs::temp_directory_path() / ("prospect map " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  DepthRecording recording_;
  std::string folder_;
};

TEST_F(MapRecording, IsLevelledAndMapped) {
  recording_.write_seven_scenes(folder_);
  const DepthDataset dataset = DepthDataset::open(folder_);
  const MapRun run = run_mapping(dataset, fine());
  const MapSummary s = summarize(run);
  EXPECT_EQ(s.frames, 12);
  EXPECT_EQ(s.ok, 12);
  EXPECT_EQ(s.ground, 12);
  EXPECT_NEAR(s.height_median, 0.62, 0.003);
  EXPECT_LT(s.height_error, 0.005);
  EXPECT_LT(s.tilt_spread, 0.2 * kDegree);
  // W: floor at 0, the first camera above the origin, looking along +x.
  const Eigen::Isometry3d T_WC = run.T_WD * dataset.pose(0);
  EXPECT_NEAR(T_WC.translation().x(), 0.0, 1e-9);
  EXPECT_NEAR(T_WC.translation().y(), 0.0, 1e-9);
  EXPECT_NEAR(T_WC.translation().z(), 0.62, 0.003);
  EXPECT_NEAR(T_WC.linear()(1, 2), 0.0, 1e-9);
  EXPECT_GT(T_WC.linear()(0, 2), 0.9);
  EXPECT_NEAR(-T_WC.linear()(2, 2), std::sin(18.0 * kDegree), 0.003);
  // No cell of the floor is an obstacle, and walls are thin.
  EXPECT_GT(s.free_cells, 1500);
  EXPECT_EQ(s.low_cells, 0);
  EXPECT_GT(s.walls.cells, 20);
  EXPECT_LE(s.walls.median, 0.15 + 1e-9);
  // Occupied cells of the ground map lie on walls or boxes of the scene.
  const Eigen::Isometry3d T_SW = recording_.T_DW.inverse() * run.T_WD.inverse();
  const GroundMap& ground = *run.maps.ground;
  const GridFrame f = ground.frame();
  for (int n = 0; n < f.size(); ++n) {
    if (ground.state(f.at(n)) != CellState::kOccupied) continue;
    const Eigen::Vector2d c = f.center(f.at(n));
    const Eigen::Vector3d p = T_SW * Eigen::Vector3d(c.x(), c.y(), 0.3);
    double d =
        std::min({p.x() - recording_.scene.room.low.x(), recording_.scene.room.high.x() - p.x(),
                  p.y() - recording_.scene.room.low.y(), recording_.scene.room.high.y() - p.y()});
    for (const auto& box : recording_.scene.boxes) {
      d = std::min(d, (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).head<2>().norm());
    }
    EXPECT_LT(d, 0.18) << p.transpose();
  }
}

TEST_F(MapRecording, TheSameGivesTheSame) {
  recording_.write_tum(folder_);
  const DepthDataset dataset = DepthDataset::open(folder_);
  const MapRun a = run_mapping(dataset, fine()), b = run_mapping(dataset, fine());
  EXPECT_EQ(ground_csv(a), ground_csv(b));
  EXPECT_EQ(a.maps.voxels->data(), b.maps.voxels->data());
  EXPECT_EQ(summarize(a).ok, 12);
  // A part of it.
  const MapRun part = run_mapping(dataset, fine(), 4, 5);
  EXPECT_EQ(part.frames.size(), 5U);
  EXPECT_EQ(part.frames[0].mapped.stamp, dataset.stamp(4));
  EXPECT_TRUE(run_mapping(dataset, fine(), 12).frames.empty());
}

// Every other image as that of a second camera of the rig, whatever its stamps.
TEST_F(MapRecording, ImagesOfSeveralCamerasEnterOneMap) {
  recording_.write_seven_scenes(folder_);
  const MapSummary whole = summarize(run_mapping(DepthDataset::open(folder_), fine()));
  Eigen::Isometry3d T_FC = Eigen::Isometry3d::Identity();
  T_FC.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitY()).toRotationMatrix();
  T_FC.translation() = Eigen::Vector3d(0.1, -0.2, 0.05);
  for (const bool together : {false, true}) {
    DepthSource source = open_depth_source(folder_);
    DepthSource first = source;
    MoreDepthImages second;
    second.camera = *source.camera;
    second.camera.width = second.camera.height = 0.0;
    second.T_FC = T_FC;
    std::vector<std::size_t> of_first, of_second;
    first.poses.clear();
    first.images.stamps.clear();
    first.images.names.clear();
    for (std::size_t i = 0; i < source.images.size(); ++i) {
      const bool other = i % 2 == 1;
      ImageStream& images = other ? second.images : first.images;
      images.stamps.push_back(source.images.stamps[i - (other && together ? 1 : 0)]);
      images.names.push_back(source.images.names[i]);
      (other ? of_second : of_first).push_back(i);
      if (other) {
        // At the same instant the rig has one place: both images are of the first one's.
        const std::size_t from = together ? i - 1 : i;
        second.poses.push_back(together ? source.poses[from] : source.poses[i] * T_FC.inverse());
      } else {
        first.poses.push_back(source.poses[i]);
      }
    }
    if (together) {
      second.T_FC.setIdentity();
      of_second = of_first;
    }
    first.images.read = [=](std::size_t i) { return source.images.read(of_first.at(i)); };
    second.images.read = [=](std::size_t i) { return source.images.read(of_second.at(i)); };
    first.more = {second};
    const DepthDataset dataset = DepthDataset::open(first, {});
    ASSERT_EQ(dataset.size(), 12);
    EXPECT_EQ(dataset.sensors(), 2);
    EXPECT_EQ(dataset.sensor(1), 1);
    const MapRun run = run_mapping(dataset, fine());
    const MapSummary s = summarize(run);
    EXPECT_EQ(s.ok, 12) << s.rejected_reason;
    EXPECT_TRUE(s.taken);
    // As the first camera would measure it.
    EXPECT_NEAR(run.frames[1].mapped.ground.height, (run.T_WD * dataset.pose(1)).translation().z(),
                0.01);
    EXPECT_LT(s.height_error, 0.005);
    EXPECT_EQ(s.low_cells, 0);
    if (together) continue;
    EXPECT_NEAR(s.free_cells, whole.free_cells, 0.01 * whole.free_cells);
    EXPECT_NEAR(s.occupied_cells, whole.occupied_cells, 0.02 * whole.occupied_cells);
  }
}

TEST_F(MapRecording, WithoutPosesTheGroundIsMeasuredOnly) {
  recording_.write_numbered(folder_);
  DepthDatasetOptions options;
  options.camera = recording_.camera;
  const MapRun run = run_mapping(DepthDataset::open(folder_, options), fine());
  const MapSummary s = summarize(run);
  EXPECT_EQ(s.ground, 12);
  EXPECT_NEAR(s.height_median, 0.62, 0.003);
  EXPECT_LT(s.tilt_worst, 0.5 * kDegree);
  EXPECT_TRUE(std::isnan(s.height_error));
  EXPECT_EQ(run.maps.ground, nullptr);
  EXPECT_EQ(run.maps.octree, nullptr);
}

TEST_F(MapRecording, WithoutGroundNothingIsMapped) {
  recording_.frames = 3;
  recording_.scene.room.low.z() = -4.0;  // far below
  recording_.scene.boxes.clear();
  recording_.write_seven_scenes(folder_);
  const MapRun run = run_mapping(DepthDataset::open(folder_), fine());
  const MapSummary s = summarize(run);
  EXPECT_FALSE(run.no_ground.empty());
  EXPECT_FALSE(s.taken);
  EXPECT_EQ(s.rejected, 3);
  EXPECT_EQ(s.rejected_reason, "no ground: " + run.no_ground);
  EXPECT_EQ(s.ground, 0);
  EXPECT_TRUE(std::isnan(s.height_median));
  EXPECT_TRUE(std::isnan(s.height_error));
  EXPECT_TRUE(std::isnan(s.tilt_spread));
  EXPECT_TRUE(std::isnan(s.walls.median));
  EXPECT_EQ(run.maps.ground, nullptr);
  EXPECT_TRUE(run.changes.empty());
}

// The first frames show a table 0.3 m high and no floor; driving on, the floor beside it comes into
// view. The map is made again, on the floor, also from the frames that were on the table.
TEST_F(MapRecording, ATableTakenForTheFloorIsRevised) {
  recording_.scene.boxes = {{{-2.03, -2.52, 0.0}, {1.0, 2.57, 0.3}}};
  recording_.step = 0.2;
  recording_.write_seven_scenes(folder_);
  const DepthDataset dataset = DepthDataset::open(folder_);
  MapRunOptions coarse;
  coarse.mapper.map.resolution = 0.1;
  const MapRun run = run_mapping(dataset, coarse);
  ASSERT_GE(run.changes.size(), 2U);
  EXPECT_NEAR(run.changes.front().height, 0.32, 0.01);
  EXPECT_NEAR(run.changes.back().height, 0.62, 0.02);
  EXPECT_TRUE(std::any_of(run.changes.begin(), run.changes.end(), [](const GroundChange& change) {
    return change.reason.find("given up: hypothesis") != std::string::npos;
  }));
  EXPECT_NEAR((run.T_WD * dataset.pose(0)).translation().z(), 0.62, 0.02);
  const MapSummary s = summarize(run);
  ASSERT_TRUE(s.taken);
  EXPECT_NEAR(s.taken->height, 0.62, 0.02);
  ASSERT_FALSE(s.rejected_grounds.empty());
  EXPECT_NEAR(s.rejected_grounds[0].height, 0.32, 0.06);
  EXPECT_THAT(s.rejected_grounds[0].why, HasSubstr("below it"));
  // Where the first frames looked, the table stands in the way.
  const Eigen::Vector3d table = run.T_WD * recording_.T_DW * Eigen::Vector3d(-0.5, 0.0, 0.3);
  EXPECT_EQ(run.maps.ground->state(run.maps.ground->frame().cell(table.x(), table.y())),
            CellState::kOccupied);
  // The hypotheses over time: of each frame, at most one taken.
  std::vector<int> taken(run.frames.size(), 0);
  for (const GroundRecord& r : run.ground) {
    taken[static_cast<std::size_t>(r.frame)] += r.taken;
    EXPECT_EQ(r.stamp, dataset.stamp(r.frame));
    EXPECT_FALSE(r.why.empty());
  }
  EXPECT_EQ(taken[0], 0);
  EXPECT_EQ(taken.back(), 1);
  EXPECT_EQ(*std::max_element(taken.begin(), taken.end()), 1);
  // Told how high the camera is, the table is never taken.
  MapRunOptions told = coarse;
  told.height = 0.6;
  for (const GroundChange& change : run_mapping(dataset, told).changes) {
    EXPECT_NEAR(change.height, 0.62, 0.03);
  }
}

// Of one image no two frames agree; what there is is taken, and it is said.
TEST_F(MapRecording, OfOneImage) {
  recording_.frames = 1;
  recording_.write_seven_scenes(folder_);
  const MapRun run = run_mapping(DepthDataset::open(folder_), fine());
  const MapSummary s = summarize(run);
  ASSERT_TRUE(s.taken);
  EXPECT_THAT(s.taken->why, HasSubstr("seen in 1 frames"));
  EXPECT_GT(s.taken->sigma_height, 0.005);
  EXPECT_EQ(s.ok, 1);
}

// Poses that jump by 10 cm half way, away from the wall ahead: the wall is entered twice.
TEST_F(MapRecording, WrongPosesDoubleWalls) {
  recording_.scene.boxes.clear();
  recording_.scene.room.high.x() = 1.4;
  recording_.frames = 16;
  recording_.write_seven_scenes(folder_);
  const WallThickness good = summarize(run_mapping(DepthDataset::open(folder_), fine())).walls;
  recording_.write_seven_scenes(folder_, 8, Eigen::Vector3d(-0.1, 0.0, 0.0));
  const WallThickness bad = summarize(run_mapping(DepthDataset::open(folder_), fine())).walls;
  std::printf("walls %.2f m thick, %.0f %% doubled; with poses that jump %.2f m, %.0f %%\n",
              good.median, 100.0 * good.doubled, bad.median, 100.0 * bad.doubled);
  EXPECT_LT(good.doubled, 0.15);
  EXPECT_GT(bad.doubled, good.doubled + 0.3);
  EXPECT_GT(bad.median, good.median + 0.04);
}

// --- Real recordings, where they are there.

std::string shared(const std::string& name) {
  return std::string(PROSPECT_SHARED_DATA) + "/rgbd/" + name;
}

TEST(RealRecording, OfAWheeledRobot) {
  const std::string folder = shared("aims_realsense_a");
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  DepthDatasetOptions options;
  options.camera = PinholeCamera{384.0, 384.0, 320.0, 240.0, 640.0, 480.0};
  const MapRun run = run_mapping(DepthDataset::open(folder, options), fine());
  const MapSummary s = summarize(run);
  EXPECT_EQ(s.frames, 33);
  EXPECT_EQ(s.ground, 33);
  // Aimed at: within 1 cm of 0.624 m, spread at most 1.5 degrees.
  EXPECT_GT(s.height_min, 0.614);
  EXPECT_LT(s.height_max, 0.634);
  EXPECT_LT(s.tilt_spread, 1.5 * kDegree);
}

const char* kKitchen = "7scenes_redkitchen_a";

TEST(RealRecording, OfAKitchen) {
  const std::string folder = shared(kKitchen);
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const MapRun run = run_mapping(DepthDataset::open(folder), fine());
  const MapSummary s = summarize(run);
  EXPECT_EQ(s.rejected, 0);
  EXPECT_GE(s.ground, 56);
  EXPECT_GT(s.free_cells, 1000);
  EXPECT_GT(s.occupied_cells, 300);
  EXPECT_LE(s.low_cells, 0.02 * s.occupied_cells);
  EXPECT_LT(s.walls.doubled, 0.2);
  std::printf("a frame takes %.1f ms of the processor, 95 %%: %.1f ms\n", s.frame.p50, s.frame.p95);
}

// The ground of some frames in a row against that of all: often a piece of floor at an angle.
TEST(RealRecording, AFewLooksAtAKitchensFloorClaimNoMoreThanTheyKnow) {
  const std::string folder = shared(kKitchen);
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const DepthDataset dataset = DepthDataset::open(folder);
  std::vector<DepthImage> images;
  for (int i = 0; i < dataset.size(); ++i) images.push_back(dataset.read(i));
  const auto ground = [&](int first, int frames) {
    GroundHypotheses hypotheses(dataset.camera());
    for (int i = first; i < first + frames; ++i) {
      hypotheses.add(images[static_cast<std::size_t>(i)], dataset.pose(i));
    }
    hypotheses.settle();
    EXPECT_NE(hypotheses.taken(), nullptr) << first << " " << frames;
    return hypotheses.taken() != nullptr ? *hypotheses.taken() : GroundHypothesis();
  };
  const GroundHypothesis whole = ground(0, dataset.size());
  for (const int frames : {3, 5, 10, 20}) {
    double tilt = 0.0, height = 0.0, most = 0.0;
    int windows = 0;
    for (int first = 0; first + frames <= dataset.size(); first += std::max(1, frames / 3)) {
      const GroundHypothesis found = ground(first, frames);
      const Eigen::Isometry3d T_DC = dataset.pose(first);
      const Eigen::Vector3d up = T_DC.linear().transpose() * whole.normal;
      Eigen::Vector3d t1, t2;
      ground_tangents(T_DC.linear().transpose() * found.normal, t1, t2);
      const Eigen::Vector2d e(up.dot(t1), up.dot(t2));
      const double off = whole.normal.dot(T_DC.translation()) + whole.offset - found.height;
      const double tilt2 = e.dot(found.covariance.topLeftCorner<2, 2>().inverse() * e);
      const double height2 = off * off / (found.sigma_height * found.sigma_height);
      tilt += 0.5 * tilt2;
      height += height2;
      most = std::max({most, std::sqrt(tilt2), std::sqrt(height2)});
      ++windows;
    }
    std::printf("%d frames: NEES of the tilt %.2f, of the height %.2f, at most %.1f deviations\n",
                frames, tilt / windows, height / windows, most);
    EXPECT_LT(most, 3.0) << frames;
    EXPECT_GT(tilt / windows, 0.2);  // not by claiming nothing
  }
}

// The kitchen with poses that jump by 10 cm half way, so that a wall seen again lies before the
// one that is in the map. (Away from it, the new rays clear the old wall and nothing is left.)
TEST(RealRecording, WrongPosesDoubleWallsOfAKitchen) {
  const std::string folder = shared(kKitchen);
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const double good = summarize(run_mapping(DepthDataset::open(folder), fine())).walls.doubled;
  const fs::path copy =
      fs::temp_directory_path() / ("prospect kitchen " + std::to_string(::getpid()));
  for (const Eigen::Vector3d& off : {Eigen::Vector3d(0.1, 0, 0), Eigen::Vector3d(0, 0, -0.1)}) {
    fs::remove_all(copy);
    fs::create_directories(copy);
    const DepthDataset dataset = DepthDataset::open(folder);
    fs::copy(folder + "/camera-intrinsics.txt", copy);
    for (int i = 0; i < dataset.size(); ++i) {
      const std::string name = DepthRecording::frame_name(3 * i);
      fs::create_symlink(fs::absolute(folder + "/" + name + ".depth.png"),
                         copy / (name + ".depth.png"));
      Eigen::Isometry3d T = dataset.pose(i);
      if (2 * i >= dataset.size()) T.translation() += off;
      std::ofstream(copy / (name + ".pose.txt")) << DepthRecording::pose_text(T);
    }
    const double bad =
        summarize(run_mapping(DepthDataset::open(copy.string()), fine())).walls.doubled;
    std::printf("walls doubled: %.1f %%; with poses that jump %.1f %%\n", 100.0 * good,
                100.0 * bad);
    EXPECT_GT(bad, 2.0 * good);
  }
  fs::remove_all(copy);
}

TEST(RealRecording, FaultsInAKitchen) {
  const std::string folder = shared(kKitchen);
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const DepthDataset dataset = DepthDataset::open(folder);
  const MapRun good = run_mapping(dataset, fine());
  constexpr int kFrames = 11, kFirst = 4;
  std::vector<test::DepthFrame> frames;
  for (int k = 0; k < kFrames; ++k) {
    frames.push_back({dataset.stamp(k), dataset.read(k), good.T_WD * dataset.pose(k)});
  }
  for (const test::DepthFault& fault : test::depth_faults()) {
    DepthMapper mapper(dataset.camera(), fine().mapper);
    test::expect_fault_noticed(
        fault, mapper, kFrames, kFirst, [&](int k) { return frames[static_cast<std::size_t>(k)]; },
        [&](int k) { return good.frames[static_cast<std::size_t>(k)].mapped.state; });
    // Nothing is occupied that is free in the map of the whole clip without faults, but at edges.
    int wrong = 0, occupied = 0;
    const auto ground = mapper.map().ground();
    const GridFrame f = ground->frame();
    for (int n = 0; n < f.size(); ++n) {
      if (ground->state(f.at(n)) != CellState::kOccupied) continue;
      ++occupied;
      wrong += good.maps.ground->state(f.at(n)) == CellState::kFree;
    }
    EXPECT_GT(occupied, 50) << fault.name;
    EXPECT_LE(wrong, 0.1 * occupied) << fault.name;
  }
}

// No poses: the camera is held where the first ground planes put it. What is mapped is of no use
// then, but each image's state is its own.
TEST(RealRecording, FaultsOnAWheeledRobot) {
  const std::string folder = shared("aims_realsense_a");
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  DepthDatasetOptions options;
  options.camera = PinholeCamera{384.0, 384.0, 320.0, 240.0, 640.0, 480.0};
  const DepthDataset dataset = DepthDataset::open(folder, options);
  const GroundPrior ground = run_mapping(dataset, fine()).first;
  Eigen::Isometry3d T_WC = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d ahead = (Eigen::Vector3d::UnitZ() - ground.up.z() * ground.up).normalized();
  T_WC.linear() << ahead.transpose(), ground.up.cross(ahead).transpose(), ground.up.transpose();
  T_WC.translation().z() = ground.height;
  constexpr int kFrames = 11, kFirst = 4;
  std::vector<test::DepthFrame> frames;
  for (int k = 0; k < kFrames; ++k) frames.push_back({dataset.stamp(k), dataset.read(k), T_WC});
  DepthMapper clean(dataset.camera(), fine().mapper);
  std::vector<Mapping> states;
  for (const test::DepthFrame& frame : frames) {
    states.push_back(clean.process(frame.stamp, frame.image, frame.T_WC).state);
    EXPECT_EQ(states.back(), Mapping::kOk);
  }
  for (const test::DepthFault& fault : test::depth_faults()) {
    DepthMapper mapper(dataset.camera(), fine().mapper);
    test::expect_fault_noticed(
        fault, mapper, kFrames, kFirst, [&](int k) { return frames[static_cast<std::size_t>(k)]; },
        [&](int k) { return states[static_cast<std::size_t>(k)]; });
  }
}

}  // namespace
}  // namespace prospect::map_run_test
