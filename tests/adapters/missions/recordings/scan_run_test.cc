// SPDX-License-Identifier: Apache-2.0
#include "adapters/missions/recordings/scan_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/missions/recordings/map_run.h"
#include "tests/adapters/lidar_recording.h"

namespace prospect::scan_run_test {
namespace {

namespace fs = std::filesystem;
using test::BagMessage;
using test::LidarRecording;
using ::testing::Contains;
using ::testing::HasSubstr;

std::string bag_of(const std::vector<BagMessage>& messages) {
  return test::mcap_of(
      messages, 8, "", [](const std::string& records) { return records; },
      [](const std::string&) { return std::uint64_t{0}; });
}

class ScanRun : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("prospect scans " + std::to_string(::getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  std::string bag(const std::vector<BagMessage>& messages) {
    return write("a.mcap", bag_of(messages));
  }
  static std::string refusal(const std::string& path, const ScanOptions& options = {}) {
    const ScanSource source = open_scan_source(path, options);
    if (source.missing.size() == 1) return source.missing[0];
    return source.missing.empty() ? "accepted" : "several lines";
  }
  /// Maps it and holds the map against the room, in cells along the axes.
  static MapRun map(const ScanSource& source, const LidarRecording& recording,
                    double height = 0.0) {
    ScanMapperOptions options;
    options.map.resolution = 0.05;
    options.map.max_range = 8.0;
    const MapRun run = run_scan_mapping(source, place_scans(source, height), {options});
    EXPECT_EQ(run.frames.size(), static_cast<std::size_t>(recording.scans));
    for (const MapRunFrame& frame : run.frames) {
      EXPECT_EQ(frame.mapped.state, Mapping::kOk) << frame.mapped.reason;
    }
    const GroundMap& ground = *run.maps.ground;
    // A wall is one cell thick: hits are entered up to 0.025 m behind the room's sides, which are
    // 0.01 m inside of their cells.
    int occupied = 0, off_the_walls = 0, free = 0, beyond = 0;
    const double half = 0.036;
    const GridFrame& frame = ground.frame();
    for (int n = 0; n < frame.size(); ++n) {
      const Cell c = frame.at(n);
      const Eigen::Vector2d p(0.05 * (c.i + 0.5), 0.05 * (c.j + 0.5));
      const auto near_side = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        const bool within =
            (p.array() > a.array() - half).all() && (p.array() < b.array() + half).all();
        const bool inside =
            (p.array() > a.array() + half).all() && (p.array() < b.array() - half).all();
        return within && !inside;
      };
      if (ground.state(c) == CellState::kOccupied) {
        ++occupied;
        off_the_walls += !near_side(recording.low, recording.high) &&
                         !near_side(recording.box_low, recording.box_high);
      } else if (ground.state(c) == CellState::kFree) {
        ++free;
        beyond += (p.array() < recording.low.array() - half).any() ||
                  (p.array() > recording.high.array() + half).any();
      }
    }
    EXPECT_EQ(off_the_walls, 0);
    EXPECT_EQ(beyond, 0);
    EXPECT_GT(occupied, 150);
    EXPECT_GT(free, 3000);
    return run;
  }

  fs::path folder_;
};

TEST_F(ScanRun, ABagWithMovingTransforms) {
  const LidarRecording recording;
  const std::string path = bag(recording.messages());
  const ScanSource source = open_scan_source(path);
  ASSERT_THAT(source.missing, ::testing::IsEmpty());
  EXPECT_EQ(source.layout, "ROS 2 bag");
  EXPECT_EQ(source.scans, 20u);
  EXPECT_EQ(source.points, 180u);
  EXPECT_TRUE(source.planar);
  EXPECT_FLOAT_EQ(static_cast<float>(source.max_range), 12.0F);
  EXPECT_THAT(source.notes, Contains(HasSubstr("topic scan=/scan, by its type")));
  EXPECT_THAT(source.notes, Contains(HasSubstr("poses by TF, from odom to laser")));
  // Transforms come between the scans, so these are interpolated.
  EXPECT_TRUE(source.poses[3].isApprox(recording.body(3) * recording.T_BS, 1e-3));
  const MapRun run = map(source, recording);
  EXPECT_NEAR(run.frames[0].mapped.T_WC.translation().z(), 0.18, 1e-9);
  const MapRun again = map(source, recording);
  EXPECT_EQ(ground_csv(run), ground_csv(again));
  EXPECT_EQ(run.maps.voxels->data(), again.maps.voxels->data());
  const MapSummary s = summarize(run);
  EXPECT_EQ(s.ok, 20);
  EXPECT_EQ(s.ground, 0);
  EXPECT_TRUE(is_used_for_scans(path, {}));

  Found found = Found::kUnknown;
  const auto json = inspect_path(path, {}, {}, found);
  EXPECT_EQ(found, Found::kUsable) << json.dump(1);
  ASSERT_EQ(json["recordings"].size(), 1u);
  EXPECT_EQ(json["recordings"][0]["used_by"], "prospect map");
  EXPECT_THAT(inspection_text(json),
              HasSubstr("scans        20, the first of 180 points, 10 Hz, to 12 m: /scan"));
}

TEST_F(ScanRun, ABagOfClouds) {
  const LidarRecording recording;
  const ScanSource source = open_scan_source(bag(recording.messages(0.0, true)));
  ASSERT_THAT(source.missing, ::testing::IsEmpty());
  EXPECT_FALSE(source.planar);
  EXPECT_EQ(source.points, 720u);
  EXPECT_THAT(source.notes, Contains(HasSubstr("topic scan=/points, by its type")));
  const MapRun run = map(source, recording);
  // Walls and box from the floor up to half a metre; what stands on z = 0 is the floor.
  EXPECT_GT(run.frames[0].mapped.hits, run.frames[0].mapped.floor);
  EXPECT_GT(run.frames[0].mapped.floor, 0);
  const VoxelGrid& voxels = *run.maps.voxels;
  const auto state = [&](double x, double y, double z) {
    const Eigen::Vector3i v = voxels.voxel({x, y, z});
    return voxels.state(v.x(), v.y(), v.z());
  };
  EXPECT_EQ(state(2.475, 0.02, 0.325), CellState::kOccupied);
  EXPECT_EQ(state(1.025, 0.725, 0.325), CellState::kOccupied) << "the box";
  EXPECT_EQ(state(0.02, 0.02, 0.175), CellState::kFree);
}

TEST_F(ScanRun, BeamsAreMovedToWhereTheLidarWasAtTheirTime) {
  LidarRecording recording;
  recording.scans = 18;
  std::vector<BagMessage> messages = recording.messages(0.5);
  // The odometry goes on to the last beam of the last scan.
  const std::int64_t end = LidarRecording::kStart + LidarRecording::kStep * 19;
  messages.push_back(
      {"/tf", "tf2_msgs/msg/TFMessage", end,
       LidarRecording::transform_message(end, "odom", "base_link", recording.body(19))});
  map(open_scan_source(bag(messages)), recording);
}

TEST_F(ScanRun, PosesOfATopicAndOfAFrameThatIsGiven) {
  const LidarRecording recording;
  std::vector<BagMessage> messages = recording.messages();
  for (BagMessage& m : messages) {  // the same poses as a topic
    if (m.topic != "/tf") continue;
    const double k = static_cast<double>(m.time - LidarRecording::kStart) / LidarRecording::kStep;
    test::CdrWriter odometry;
    odometry.header(m.time, "odom").text("base_link").pose(recording.body(k));
    odometry.doubles(std::vector<double>(36 + 6 + 36, 0.0));
    m = {"/wheels", "nav_msgs/msg/Odometry", m.time, odometry.str()};
  }
  const ScanSource source = open_scan_source(bag(messages));
  EXPECT_THAT(source.notes, Contains(HasSubstr("topic pose=/wheels, by its type")));
  EXPECT_THAT(source.notes, Contains(HasSubstr("poses of base_link, moved to laser by TF")));
  map(source, recording);
  ScanOptions options;
  options.fixed_frame = "map";
  EXPECT_THAT(refusal((folder_ / "a.mcap").string(), options),
              HasSubstr("no transform leads from map to laser; expected a frame above it, such as "
                        "base_link"));
  options.topics["pose"] = "/wheels";
  EXPECT_THAT(refusal((folder_ / "a.mcap").string(), options), HasSubstr("expected one"));
  messages.erase(messages.begin());  // without /tf_static
  EXPECT_THAT(refusal(bag(messages)), HasSubstr("/wheels: poses of base_link, but no transform "
                                                "leads to laser"));
}

TEST_F(ScanRun, WhatIsMissingOrLeftOut) {
  const LidarRecording recording;
  std::vector<BagMessage> messages = recording.messages();
  std::erase_if(messages, [](const BagMessage& m) { return m.topic == "/tf"; });
  EXPECT_THAT(refusal(bag(messages)),
              HasSubstr("no pose of the lidar's frame 'laser' is in the bag"));
  messages = recording.messages();
  std::erase_if(messages, [](const BagMessage& m) {
    return m.topic == "/tf" && m.time > LidarRecording::kStart + 5 * LidarRecording::kStep;
  });
  const ScanSource half = open_scan_source(bag(messages));
  EXPECT_EQ(half.stamps.size(), 5u);
  EXPECT_EQ(half.without_pose, 15u);
  EXPECT_THAT(half.notes, Contains("15 scans without a pose at their time left out"));
  // Heights that the poses do not tell.
  ScanSource source = open_scan_source(bag(recording.messages()));
  for (Eigen::Isometry3d& T : source.poses) T.translation().z() = 0.0;
  EXPECT_EQ(place_scans(source, 0.0).height, 0.2);
  EXPECT_THAT(place_scans(source, 0.0).notes[0], HasSubstr("taken as 0.2 m; --lidar-height"));
  EXPECT_EQ(place_scans(source, 1.1).height, 1.1);
  map(source, recording, 1.1);  // the slice holds the plane of the scans
  source.planar = false;
  EXPECT_THROW(place_scans(source, 0.0), InputError);
}

TEST_F(ScanRun, ALogOfCarmen) {
  LidarRecording recording;
  recording.scans = 40;
  recording.T_BS = LidarRecording::at(0.1, 0.0, 0.0, 0.0);
  const std::string text = recording.carmen_log();
  const ScanSource source = open_scan_source(write("room.log", text));
  ASSERT_THAT(source.missing, ::testing::IsEmpty());
  EXPECT_EQ(source.layout, "CARMEN log");
  EXPECT_THAT(source.notes, Contains("read without lines of other kinds: 40 ODOM, 1 PARAM"));
  EXPECT_NEAR(source.stamps[39], 13.9, 1e-9);
  map(source, recording);
  // The newer kind of line states its angles; a reading at its range's end is nothing seen.
  const ScanSource newer = open_scan_source(
      write("b.clf",
            "ROBOTLASER1 0 -1.5708 3.1416 1.5708 20 0.01 0 3 1.0 20.0 2.0 1 0.5 5 6 0.25 5 6 "
            "0.25 0 0 0 0 0 100.5 host 1\r\nFLASER 2 1 1 0 0 0 0 0 0 99 host 1\n"));
  ASSERT_EQ(newer.stamps.size(), 1u);
  EXPECT_EQ(newer.stamps[0], 100.5);
  EXPECT_THAT(newer.notes, Contains("1 scans whose time does not increase left out"));
  EXPECT_EQ(newer.poses[0].translation(), Eigen::Vector3d(5, 6, 0));
  const DepthScan scan = newer.read(0);
  ASSERT_EQ(scan.hits.size(), 2u);
  EXPECT_LT((scan.hits[0] - Eigen::Vector3d(0, -1, 0)).norm(), 1e-4);
  EXPECT_EQ(scan.misses.size(), 1u);
}

TEST_F(ScanRun, LogsThatCannotBe) {
  struct Row {
    std::string text, expected;
  };
  for (const Row& row : std::vector<Row>{
           {"FLASER 3 1 2\n", "a.log:1: ends before a range"},
           {"# CARMEN\nFLASER 1 x 0 0 0 0 0 0 1 h 1\n", "a.log:2: 'x' for a range"},
           {"FLASER 1 1 0 nan 0 0 0 0 1 h 1\n", "'nan' for y"},
           {"FLASER -1 1 0 0 0 0 0 0 1 h 1\n", "expected 0 to 100000"},
           {"FLASER 1e9 1 0 0 0 0 0 0 1 h 1\n", "expected 0 to 100000"},
           {"FLASER 1 1 0 0 0 0 0\n", "ends before"},
           {"ROBOTLASER1 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1 h 1\n", "maximum range"},
           {"# CARMEN Logfile\n", "holds no FLASER"}}) {
    EXPECT_THAT(refusal(write("a.log", row.text)), HasSubstr(row.expected)) << row.text;
  }
  EXPECT_FALSE(is_carmen_log(write("other.log", "made by another program\n")));
  EXPECT_THAT(refusal(write("a.log", "FLASER 1 1 0 0 0 0 0 0 1 h 1\n"), {{}, "map"}),
              HasSubstr("neither topics nor frames"));
}

/// A lidar of one plane goes twice round a block of 8 x 6 m in a hall of 12 x 10 m with two niches;
/// of each turn its odometry misses `missed`.
struct RoundTheBlock {
  static constexpr double kStep = 0.1, kHeight = 0.2;  // [m]
  std::vector<Eigen::Isometry3d> truth;
  ScanSource source;

  explicit RoundTheBlock(double missed) {
    const double corners[4][2] = {{1.0, 1.0}, {11.0, 1.0}, {11.0, 9.0}, {1.0, 9.0}};
    Pose told;
    for (int lap = 0; lap < 2; ++lap) {
      for (int c = 0; c < 4; ++c) {
        const Eigen::Vector2d from(corners[c][0], corners[c][1]),
            to(corners[(c + 1) % 4][0], corners[(c + 1) % 4][1]);
        const double yaw = M_PI / 2.0 * c;
        const int steps = static_cast<int>((to - from).norm() / kStep);
        for (int n = 0; n < steps; ++n) {
          const Eigen::Vector2d p = from + (to - from) * n / steps;
          truth.push_back(LidarRecording::at(p.x(), p.y(), kHeight, yaw));
        }
        for (int n = 0; n < 10; ++n) {
          truth.push_back(
              LidarRecording::at(to.x(), to.y(), kHeight, yaw + M_PI / 2.0 * (n + 0.5) / 10));
        }
      }
    }
    source.layout = "made";
    source.from = "/scan", source.fixed = "odom";
    source.poses.push_back(truth.front());
    for (std::size_t k = 0; k < truth.size(); ++k) {
      source.stamps.push_back(0.1 * static_cast<double>(k));
      if (k == 0) continue;
      Eigen::Isometry3d moved = truth[k - 1].inverse() * truth[k];
      const double turned = std::atan2(moved.linear()(1, 0), moved.linear()(0, 0));
      moved.linear() =
          Eigen::AngleAxisd((1.0 - missed) * turned, Eigen::Vector3d::UnitZ()).toRotationMatrix();
      source.poses.push_back(source.poses.back() * moved);
    }
    source.scans = truth.size();
    source.read = [this](std::size_t k) { return scan(truth[k]); };
  }
  RoundTheBlock(const RoundTheBlock&) = delete;
  RoundTheBlock& operator=(const RoundTheBlock&) = delete;

  static double range(const Eigen::Vector2d& o, const Eigen::Vector2d& d) {
    double best = 100.0;
    const auto box = [&](double x0, double y0, double x1, double y1) {
      const double low[2] = {x0, y0}, high[2] = {x1, y1};
      for (int a = 0; a < 2; ++a) {
        if (std::abs(d[a]) < 1e-12) continue;
        for (const double side : {low[a], high[a]}) {
          const double s = (side - o[a]) / d[a], other = o[1 - a] + s * d[1 - a];
          if (s > 0.0 && other >= low[1 - a] && other <= high[1 - a]) best = std::min(best, s);
        }
      }
    };
    box(0.0, 0.0, 12.0, 10.0);
    box(2.0, 2.0, 10.0, 8.0);
    box(4.0, 0.0, 4.6, 0.5);
    box(7.0, 9.6, 8.5, 10.0);
    return best;
  }
  static DepthScan scan(const Eigen::Isometry3d& T) {
    DepthScan scan;
    for (int i = 0; i < 360; ++i) {
      const double a = 2.0 * M_PI * i / 360;
      const Eigen::Vector3d ray(std::cos(a), std::sin(a), 0.0);
      const Eigen::Vector2d d = (T.linear() * ray).head<2>();
      const double r = range(T.translation().head<2>(), d);
      (r < 6.0 ? scan.hits : scan.misses).push_back(ray * std::min(r, 6.0));
    }
    return scan;
  }
  /// [m], root mean square, about the start.
  double error(const MapRun& run) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      sum += (run.frames[k].mapped.T_WC.translation() - truth[k].translation()).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }
};

TEST_F(ScanRun, LoopsCorrectPosesThatDrift) {
  ScanRunOptions options;
  options.mapper.map.resolution = 0.05;
  options.mapper.map.max_range = 6.0;
  const RoundTheBlock drive(0.01);
  const ScanPlacement placement = place_scans(drive.source, 0.0);
  const MapRun drawn = run_scan_mapping(drive.source, placement, options);
  options.loops = true;
  const MapRun straight = run_scan_mapping(drive.source, placement, options);
  EXPECT_FALSE(drawn.loops);
  ASSERT_TRUE(straight.loops);
  const int before = summarize(drawn).occupied_cells, after = summarize(straight).occupied_cells;
  std::printf("%.3f m as drawn, %.3f m with %d of %d loops; %d and %d occupied\n",
              drive.error(drawn), drive.error(straight), straight.loops->used,
              straight.loops->found, before, after);
  EXPECT_GT(straight.loops->used, 5);
  EXPECT_GT(straight.loops->farthest, 0.2);
  EXPECT_GT(drive.error(drawn), 0.3);
  EXPECT_LT(drive.error(straight), 0.4 * drive.error(drawn));
  EXPECT_LT(after, 0.8 * before);
  // The first pose is where it was.
  EXPECT_LT(
      (straight.frames[0].mapped.T_WC.translation() - drawn.frames[0].mapped.T_WC.translation())
          .norm(),
      0.02);
}

TEST_F(ScanRun, LoopsMovePosesThatAreRightByLessThanAVoxel) {
  ScanRunOptions options;
  options.mapper.map.resolution = 0.05;
  options.mapper.map.max_range = 6.0;
  const RoundTheBlock drive(0.0);
  const ScanPlacement placement = place_scans(drive.source, 0.0);
  options.loops = true;
  const MapRun straight = run_scan_mapping(drive.source, placement, options);
  std::printf("%.4f m with %d of %d loops\n", drive.error(straight), straight.loops->used,
              straight.loops->found);
  EXPECT_LT(drive.error(straight), 0.05);
}

TEST_F(ScanRun, WhoWalksIsInTheMapWhereMoversAreSwitchedOff) {
  // A room of 8 m, with a lidar in its middle; somebody 0.4 m wide comes in after a second.
  const auto somebody = [](std::size_t k) {
    return Eigen::Vector2d(2.0, 3.0 - 0.1 * (static_cast<double>(k) - 10.0));
  };
  ScanSource source;
  source.layout = "made";
  source.from = "/scan", source.fixed = "odom";
  source.scans = 40;
  for (std::size_t k = 0; k < source.scans; ++k) {
    source.stamps.push_back(0.1 * static_cast<double>(k));
    source.poses.push_back(LidarRecording::at(0.0, 0.0, 0.25, 0.0));
  }
  source.read = [&](std::size_t k) {
    DepthScan scan;
    for (int i = 0; i < 720; ++i) {
      const double a = 2.0 * M_PI * i / 720;
      const Eigen::Vector2d along(std::cos(a), std::sin(a));
      double range = 4.0 / along.cwiseAbs().maxCoeff();
      const double ahead = along.dot(somebody(k));
      const double in = 0.04 - somebody(k).squaredNorm() + ahead * ahead;
      if (k > 10 && ahead > 0.0 && in > 0.0) range = std::min(range, ahead - std::sqrt(in));
      scan.hits.emplace_back(range * along.x(), range * along.y(), 0.0);
    }
    return scan;
  };
  ScanRunOptions options;
  options.mapper.map.max_range = 8.0;
  for (const bool follows : {true, false}) {
    options.movers.enabled = follows;
    const MapRun run = run_scan_mapping(source, place_scans(source, 0.25), options);
    const GroundMap& ground = *run.maps.ground;
    int inside = 0;
    for (int n = 0; n < ground.frame().size(); ++n) {
      const Cell c = ground.frame().at(n);
      inside += ground.state(c) == CellState::kOccupied &&
                ground.frame().center(c).cwiseAbs().maxCoeff() < 3.8;
    }
    EXPECT_EQ(inside > 0, !follows) << inside;
  }
}

}  // namespace
}  // namespace prospect::scan_run_test
