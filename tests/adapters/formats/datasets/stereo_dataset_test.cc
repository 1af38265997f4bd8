// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/stereo_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "tests/images/image_file.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/image_faults.h"
#include "tests/perception/rendered_room.h"

namespace prospect::stereo_dataset_test {
namespace {

namespace fs = std::filesystem;
using test::RenderedRoom;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kFrames = 6;

StereoCamera camera() {
  StereoCamera c;
  c.left = {300.0, 300.0, 200.0, 150.0, 400.0, 300.0};
  c.baseline = 0.12;
  return c;
}

Eigen::Isometry3d pose(int k) { return RenderedRoom::looking(0.05 * k, 0.0, 1.1, 0.02 * k); }

/// Recordings of the rendered room, written anew for each test and then damaged.
class StereoRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        (fs::temp_directory_path() / ("prospect recording " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static const std::vector<RenderedRoom::Pair>& pairs() {
    static const std::vector<RenderedRoom::Pair> pairs = [] {
      std::vector<RenderedRoom::Pair> made;
      for (int k = 0; k < kFrames; ++k)
        made.push_back(RenderedRoom().render(camera(), pose(k), 2.0, k));
      return made;
    }();
    return pairs;
  }

  std::string write(const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }

  void kitti() {
    fs::create_directories(folder_ + "/image_0");
    fs::create_directories(folder_ + "/image_1");
    std::string times, poses;
    Trajectory truth;
    for (int k = 0; k < kFrames; ++k) {
      char name[32];
      std::snprintf(name, sizeof name, "/%06d.png", k);
      test::write_image(folder_ + "/image_0" + name, pairs()[k].left);
      test::write_image(folder_ + "/image_1" + name, pairs()[k].right);
      times += std::to_string(0.1 * k) + "\n";
      truth.push_back({0.1 * k, pose(0).inverse() * pose(k)});
    }
    write("calib.txt",
          "P0: 300 0 200 0 0 300 150 0 0 0 1 0\n"
          "P1: 300 0 200 -36 0 300 150 0 0 0 1 0\n"
          "P2: 300 0 200 1 0 300 150 0 0 0 1 0\n"
          "Tr: 1 2 3\n");
    write("times.txt", times);
    write("poses.txt", kitti_text(truth));
  }

  std::string sensor(double y) {
    // Body: x forward, y left, z up, as a level camera at (0, y, 0).
    std::ostringstream text;
    text << "%YAML:1.0\nsensor_type: camera\ncomment: a test\nT_BS:\n  cols: 4\n  rows: 4\n"
         << "  data: [0, 0, 1, 0, -1, 0, 0, " << y << ", 0, -1, 0, 0, 0, 0, 0, 1]\n"
         << "rate_hz: 10\nresolution: [400, 300]\ncamera_model: pinhole\n"
         << "intrinsics: [300, 300, 200, 150]\ndistortion_model: radial-tangential\n"
         << "distortion_coefficients: [0, 0, 0, 0]\n";
    return text.str();
  }

  void euroc() {
    write("mav0/cam0/sensor.yaml", sensor(0.0));
    write("mav0/cam1/sensor.yaml", sensor(-0.12));
    fs::create_directories(folder_ + "/mav0/cam0/data");
    fs::create_directories(folder_ + "/mav0/cam1/data");
    std::string truth = "#timestamp, p, q\n";
    for (int k = 0; k < kFrames; ++k) {
      const std::string stamp = std::to_string(1400000000000000000LL + 100000000LL * k);
      test::write_image(folder_ + "/mav0/cam0/data/" + stamp + ".png", pairs()[k].left);
      test::write_image(folder_ + "/mav0/cam1/data/" + stamp + ".png", pairs()[k].right);
      char line[256];
      const Eigen::Vector3d t = pose(k).translation();
      std::snprintf(line, sizeof line, "%s,%.9f,%.9f,%.9f,%.9f,0,0,%.9f,0,0,0\n", stamp.c_str(),
                    t.x(), t.y(), t.z(), std::cos(0.01 * k), std::sin(0.01 * k));
      truth += line;
    }
    write("mav0/state_groundtruth_estimate0/data.csv", truth);
  }

  std::string refusal() {
    try {
      StereoDataset::open(folder_);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u) << error.what();
      return error.what();
    }
    return "accepted";
  }

  void replace(const std::string& name, const std::string& from, const std::string& to) {
    std::ifstream in(folder_ + "/" + name);
    std::stringstream text;
    text << in.rdbuf();
    std::string s = text.str();
    ASSERT_NE(s.find(from), std::string::npos) << from;
    s.replace(s.find(from), from.size(), to);
    write(name, s);
  }

  std::string folder_;
};

void expect_good(const StereoDataset& dataset, double tolerance) {
  ASSERT_EQ(dataset.size(), kFrames);
  EXPECT_EQ(dataset.unpaired(), 0);
  EXPECT_NEAR(dataset.stamp(3) - dataset.stamp(0), 0.3, 1e-6);
  EXPECT_NEAR(dataset.camera().baseline, 0.12, 1e-6);
  ASSERT_EQ(dataset.ground_truth().size(), static_cast<std::size_t>(kFrames));
  const OdometryRun run = run_odometry(dataset);
  const OdometrySummary s = summarize(run);
  EXPECT_EQ(s.ok, kFrames);
  EXPECT_LT(s.end.translation, tolerance);
  // The ground truth is the rectified left camera's: the first pose agrees, and so does all else.
  EXPECT_LE((run.pairs[0].estimate.matrix() - run.pairs[0].truth.matrix()).norm(), 1e-6);
  EXPECT_LT(s.ate_first.max, tolerance);
}

TEST_F(StereoRecording, KittiLayout) {
  kitti();
  const StereoDataset dataset = StereoDataset::open(folder_);
  EXPECT_EQ(dataset.layout(), "KITTI");
  EXPECT_FALSE(dataset.times_assumed());
  expect_good(dataset, 0.005);
}

TEST_F(StereoRecording, EurocLayout) {
  euroc();
  const StereoDataset dataset = StereoDataset::open(folder_);
  EXPECT_EQ(dataset.layout(), "EuRoC");
  expect_good(dataset, 0.005);
  // As other tools write the table: w last, and the names of the columns say so.
  std::string truth = "timestamp,tx,ty,tz,qx,qy,qz,qw\r\n";
  for (int k = 0; k < kFrames; ++k) {
    char line[256];
    const Eigen::Vector3d t = pose(k).translation();
    std::snprintf(line, sizeof line, "%lld,%.9f,%.9f,%.9f,0,0,%.9f,%.9f\r\n",
                  1400000000000000000LL + 100000000LL * k, t.x(), t.y(), t.z(), std::sin(0.01 * k),
                  std::cos(0.01 * k));
    truth += line;
  }
  write("mav0/state_groundtruth_estimate0/data.csv", truth);
  expect_good(StereoDataset::open(folder_), 0.005);
}

TEST_F(StereoRecording, SaysWhatIsMissingOrMalformed) {
  EXPECT_THAT(refusal(), HasSubstr("no such folder"));
  fs::create_directories(folder_);
  EXPECT_THAT(refusal(), HasSubstr("image_00/data and calib_cam_to_cam.txt (KITTI raw), "
                                   "image_00/data_rect (KITTI-360); mav0/cam0"));
  write("rgb.txt", "");
  EXPECT_THAT(refusal(), HasSubstr("one camera and depth, for `prospect map`"));

  kitti();
  write("times.txt", "0\n0.1\n");
  EXPECT_THAT(refusal(), HasSubstr("holds 2 lines for 6 images"));
  write("times.txt", "0\n0.1\nx\n");
  EXPECT_THAT(refusal(), HasSubstr("times.txt:3: not an increasing time"));
  std::string nanoseconds;
  for (int i = 0; i <= kFrames; ++i)
    nanoseconds += std::to_string(1'700'000'000'000'000'000 + i * 100'000'000LL) + "\n";
  write("times.txt", nanoseconds);
  {
    const StereoDataset dataset = StereoDataset::open(folder_);
    EXPECT_NEAR(dataset.stamp(1) - dataset.stamp(0), 0.1, 1e-6);
    EXPECT_THAT(dataset.notes(), Contains("times.txt in ns, by their rate; KITTI's are in s"));
    EXPECT_THAT(dataset.notes(), Contains(HasSubstr("; the last image is number")));
  }
  fs::remove(folder_ + "/times.txt");
  EXPECT_TRUE(StereoDataset::open(folder_).times_assumed());
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(refusal(), HasSubstr("poses.txt: holds 1 lines for "));
  fs::remove(folder_ + "/poses.txt");
  EXPECT_TRUE(StereoDataset::open(folder_).ground_truth().empty());
  fs::remove(folder_ + "/image_1/000003.png");
  EXPECT_EQ(StereoDataset::open(folder_).unpaired(), 1);
  fs::remove(folder_ + "/image_1/000004.png");
  EXPECT_THAT(refusal(), HasSubstr("000003.png: the other camera has no such image, and 1 more"));
  write("image_0/cover.png", "");
  EXPECT_THAT(refusal(), HasSubstr("the name is no number"));
}

TEST_F(StereoRecording, RefusesACalibrationThatTheImagesContradict) {
  kitti();
  const std::string good = "P1: 300 0 200 -36 0 300 150 0 0 0 1 0";
  const std::pair<const char*, const char*> cases[] = {
      {"P1: 300 0 200 36 0 300 150 0 0 0 1 0", "look exchanged"},
      {"P1: 300 0 200 -3600 0 300 150 0 0 0 1 0", "the baseline is 12 m"},
      {"P1: 300 0 200 -0.36 0 300 150 0 0 0 1 0", "the baseline is 0.0012 m"},
      {"P1: 310 0 200 -36 0 310 150 0 0 0 1 0", "different focal lengths"},
      {"P1: 300 0 200 -36 0 300 150 0 0 0 1", "expected twelve numbers"},
      {"P1: 300 0 200 nan 0 300 150 0 0 0 1 0", "expected twelve numbers"},
      {"P1: 300 1 200 -36 0 300 150 0 0 0 1 0", "not of the form"},
      {"P9: 300 0 200 -36 0 300 150 0 0 0 1 0", "P1 is missing"},
  };
  std::string now = good;
  for (const auto& [line, complaint] : cases) {
    replace("calib.txt", now, line);
    now = line;
    EXPECT_THAT(refusal(), HasSubstr(complaint));
  }
  // For images of twice the size.
  write("calib.txt",
        "P0: 600 0 400 0 0 600 300 0 0 0 1 0\nP1: 600 0 400 -72 0 600 300 0 0 0 1 0\n");
  EXPECT_THAT(refusal(),
              HasSubstr("the principal point is (400, 300) but the images have 400 x 300"));
}

TEST_F(StereoRecording, RefusesExchangedAndShiftedImages) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  kitti();
  fs::rename(folder_ + "/image_0", folder_ + "/other");
  fs::rename(folder_ + "/image_1", folder_ + "/image_0");
  fs::rename(folder_ + "/other", folder_ + "/image_1");
  EXPECT_THAT(refusal(), HasSubstr("left and right look exchanged"));
  kitti();
  for (int k = 0; k < kFrames; ++k) {
    Image lower(400, 300);
    for (int v = 5; v < 300; ++v) {
      for (int u = 0; u < 400; ++u) lower.at(u, v) = pairs()[k].right.at(u, v - 5);
    }
    char name[64];
    std::snprintf(name, sizeof name, "/image_1/%06d.png", k);
    test::write_image(folder_ + name, lower);
  }
  EXPECT_THAT(refusal(), HasSubstr("rows do not correspond: the right image fits 5 px higher"));
  kitti();
  for (int k = 0; k < kFrames; ++k) {
    char name[64];
    std::snprintf(name, sizeof name, "/image_1/%06d.png", k);
    test::write_image(folder_ + name, Image(200, 150, 90));
  }
  EXPECT_THAT(refusal(), HasSubstr("has 200 x 150 pixels, the left image 400 x 300"));
  for (int k = 0; k < kFrames; ++k) {
    char name[64];
    std::snprintf(name, sizeof name, "image_1/%06d.png", k);
    write(name, "no image");
  }
  EXPECT_THAT(refusal(), HasSubstr("cannot be decoded"));
}

TEST_F(StereoRecording, RefusesWrongSensorFiles) {
  euroc();
  replace("mav0/cam1/sensor.yaml", "-0.12", "0.12");
  EXPECT_THAT(refusal(), HasSubstr("look exchanged"));
  write("mav0/cam1/sensor.yaml", sensor(-0.12));
  replace("mav0/cam1/sensor.yaml", "radial-tangential", "cylindrical");
  EXPECT_THAT(refusal(), HasSubstr("sensor.yaml:12: distortion_model"));
  write("mav0/cam1/sensor.yaml", sensor(-0.12));
  replace("mav0/cam1/sensor.yaml", "[400, 300]", "[752, 480]");
  EXPECT_THAT(refusal(), HasSubstr("resolutions differ"));
  replace("mav0/cam0/sensor.yaml", "[400, 300]", "[752, 480]");
  EXPECT_THAT(refusal(), HasSubstr("400 x 300 pixels, the calibration is for 752 x 480"));
  write("mav0/cam0/sensor.yaml", sensor(0.0));
  write("mav0/cam1/sensor.yaml", sensor(-12.0));
  EXPECT_THAT(refusal(), HasSubstr("baseline is 12 m"));
  fs::remove(folder_ + "/mav0/cam1/sensor.yaml");
  EXPECT_THAT(refusal(), HasSubstr("sensor.yaml"));
}

// Real recordings, where they are there.

std::string shared(const std::string& name) {
  return std::string(PROSPECT_SHARED_DATA) + "/stereo/" + name;
}

TEST(RealRecording, KittiClip) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const std::string folder = shared("kitti_seq1");
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const OdometrySummary s = summarize(run_odometry(StereoDataset::open(folder)));
  EXPECT_EQ(s.ok, 50);  // one frame tracks 38 points: degraded
  // Measured 0.85 %, 0.58 %, 0.86 deg and 0.023 m (docs/results/perception.md); room for another
  // compiler.
  EXPECT_LT(s.end.share, 0.0095);
  EXPECT_LT(s.rpe_10m.translation, 0.0068);
  EXPECT_LT(s.end.rotation, 0.95 * M_PI / 180.0);
  EXPECT_LT(s.ate_fit.rmse, 0.05);
  // The ground truth of the first eleven frames is interpolated; from there on it is far closer.
  const OdometrySummary later = summarize(run_odometry(StereoDataset::open(folder), {}, 12));
  EXPECT_EQ(later.frames, 39);
  EXPECT_LT(later.end.share, 0.0065);
  EXPECT_LT(later.end.rotation, 0.25 * M_PI / 180.0);
}

TEST(RealRecording, EurocAtRest) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  const std::string folder = shared("euroc_v101_start_static");
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const OdometryRun run = run_odometry(StereoDataset::open(folder));
  const OdometrySummary s = summarize(run);
  EXPECT_EQ(s.ok, 25);
  EXPECT_EQ(s.keyframes, 1);
  EXPECT_LT(std::abs(run.frames.front().row_error), 0.3);
  EXPECT_LT(s.end.translation, 0.0025);
  EXPECT_LT(s.end.rotation, 0.2 * M_PI / 180.0);
}

/// The faults of image_faults.h on a real recording: noticed within two frames, no jump, and good
/// again at most `recovery` frames after.
void expect_faults_noticed(const std::string& folder, int first, double step, int recovery) {
  if (!fs::exists(folder)) GTEST_SKIP() << "no " << folder;
  const StereoDataset dataset = StereoDataset::open(folder);
  const OdometryRun good = run_odometry(dataset);
  std::printf("%-20s %-9s %-48s %s\n", "fault", "state", "reason", "after it");
  const int begin = first - 8;
  for (const test::ImageFault& fault : test::image_faults()) {
    SCOPED_TRACE(fault.name);
    StereoOdometry odometry(dataset.camera(), {}, good.frames[begin].T_WC);
    test::StereoFrame before;
    test::FaultOutcome outcome(fault, first);
    const int end = std::min(dataset.size(), first + fault.count + recovery + 4);
    for (int k = begin; k < end; ++k) {
      const bool faulty = outcome.faulty(k);
      auto pair = dataset.read(k);
      test::StereoFrame frame{dataset.stamp(k), std::move(pair.left), std::move(pair.right)};
      if (faulty && !fault.apply) continue;
      if (k == first - 1) before = frame;
      if (faulty) frame = fault.apply(frame, before, k - first);
      const OdometryFrame out =
          odometry.process(frame.stamp, frame.left.view(), frame.right.view());
      ASSERT_TRUE(out.T_WC.matrix().allFinite());
      if (out.state != Localization::kLost && out.reason.find("frozen") == std::string::npos) {
        const double off = (out.T_WC.translation() - good.frames[k].T_WC.translation()).norm();
        EXPECT_LT(off, 0.2 * step + 0.01) << k << " " << out.reason;
      }
      outcome.add(k, out);
    }
    outcome.expect(recovery);
  }
}

TEST(RealRecording, FaultsOnTheKittiClip) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  expect_faults_noticed(shared("kitti_seq1"), 20, 1.2, 5);
}

TEST(RealRecording, FaultsAtRest) {
  NOT_UNDER_SANITIZERS("recordings go the ways of rendered sequences, on larger images");
  expect_faults_noticed(shared("euroc_v101_start_static"), 10, 0.0, 2);
}

}  // namespace
}  // namespace prospect::stereo_dataset_test
