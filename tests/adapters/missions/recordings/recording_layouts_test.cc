// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>

#include "adapters/formats/datasets/frame_pairs.h"
#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "tests/adapters/matroska_video.h"
#include "tests/images/image_file.h"
#include "tests/perception/rendered_room.h"

namespace prospect::recording_layouts_test {
namespace {

namespace fs = std::filesystem;
using test::RenderedRoom;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kFrames = 5;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // [ns]

StereoCamera ideal() {
  StereoCamera c;
  c.left = {240.0, 240.0, 160.0, 120.0, 320.0, 240.0};
  c.baseline = 0.12;
  return c;
}

Eigen::Isometry3d pose(int k) { return RenderedRoom::looking(0.05 * k, 0.0, 1.1, 0.02 * k); }

const std::vector<RenderedRoom::Pair>& pairs() {
  static const std::vector<RenderedRoom::Pair> made = [] {
    std::vector<RenderedRoom::Pair> all;
    for (int k = 0; k < kFrames; ++k)
      all.push_back(RenderedRoom().render(ideal(), pose(k), 2.0, k));
    return all;
  }();
  return made;
}

cv::Mat grey(const Image& image) { return test::pixels_of(image).clone(); }

cv::Mat colour(const Image& image) {
  std::vector<cv::Mat> planes(3, grey(image));
  cv::Mat out;
  cv::merge(planes, out);
  return out;
}

/// Of `bits` in 16.
cv::Mat wide(const Image& image, int bits) {
  cv::Mat out;
  grey(image).convertTo(out, CV_16U, 1 << (bits - 8));
  return out;
}

std::string six(int k) {
  char name[16];
  std::snprintf(name, sizeof name, "%06d", k);
  return name;
}

class Recording : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        (fs::temp_directory_path() / ("prospect layouts " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name) << text;
    return folder_ + "/" + name;
  }
  void image(const std::string& name, const cv::Mat& pixels) {
    fs::create_directories(fs::path(folder_ + "/" + name).parent_path());
    test::write_image(folder_ + "/" + name, pixels);
  }
  /// All frames into two folders, as LEFT/000000.png and so on.
  template <typename Make>
  void images(const std::string& left, const std::string& right, const std::string& ending,
              const Make& make) {
    for (int k = 0; k < kFrames; ++k) {
      image(left + "/" + six(k) + ending, make(pairs()[k].left));
      image(right + "/" + six(k) + ending, make(pairs()[k].right));
    }
  }
  void kitti() {
    images("image_0", "image_1", ".png", grey);
    write("calib.txt",
          "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  }
  std::string sensor(double y, const std::string& more = "",
                     const std::string& lens =
                         "distortion_model: radtan\n"
                         "distortion_coefficients: [0, 0, 0, 0, 0]\n") {
    std::ostringstream text;
    text << "%YAML:1.0\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n"
         << "  data: [0, 0, 1, 0, -1, 0, 0, " << y << ", 0, -1, 0, 0, 0, 0, 0, 1]\n"
         << "rate_hz: 10\nresolution: [320, 240]\ncamera_model: pinhole\n"
         << "intrinsics: [240, 240, 160, 120]\n"
         << lens << more;
    return text.str();
  }
  /// Stamps are kStart and 0.1 s apart, in `unit` [ns]; the right ones later by `late` [ns], and
  /// only every `every`-th is there.
  void euroc(std::int64_t unit = 1, std::int64_t late = 0, int every = 1) {
    write("mav0/cam0/sensor.yaml", sensor(0.0));
    write("mav0/cam1/sensor.yaml", sensor(-0.12));
    for (int k = 0; k < kFrames; ++k) {
      const std::int64_t t = kStart + 100'000'000LL * k;
      image("mav0/cam0/data/" + std::to_string(t / unit) + ".png", grey(pairs()[k].left));
      if (k % every == 0) {
        image("mav0/cam1/data/" + std::to_string((t + late) / unit) + ".png",
              grey(pairs()[k].right));
      }
    }
  }
  std::string refusal(const StereoDatasetOptions& options = {}) {
    try {
      const StereoDataset dataset = StereoDataset::open(folder_, options);
      for (int i = 0; i < dataset.size(); ++i) dataset.read(i);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u) << error.what();
      return error.what();
    }
    return "accepted";
  }
  /// Opens, and follows the motion: 5 cm a frame, to 4 mm over all.
  StereoDataset follow(const StereoDatasetOptions& options = {}, int frames = kFrames) {
    StereoDataset dataset = StereoDataset::open(folder_, options);
    EXPECT_EQ(dataset.size(), frames);
    EXPECT_NEAR(dataset.camera().baseline, 0.12, 1e-6);
    const OdometryRun run = run_odometry(dataset);
    EXPECT_EQ(summarize(run).ok, frames);
    if (run.frames.empty()) return dataset;
    const Eigen::Isometry3d moved = run.frames.front().T_WC.inverse() * run.frames.back().T_WC;
    const Eigen::Isometry3d truth = pose(0).inverse() * pose(kFrames - 1);
    EXPECT_LT((moved.translation() - truth.translation()).norm(), 0.004) << dataset.layout();
    return dataset;
  }

  std::string folder_;
};

// ---- KITTI odometry --------------------------------------------------------------------------

TEST_F(Recording, ColourPairOfKitti) {
  images("image_2", "image_3", ".png", colour);
  // Camera 2 stands 0.06 m to the left of camera 0, 3 0.06 m to the right.
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -129 0 240 120 0 0 0 1 0\n"
        "P2: 240 0 160 14.4 0 240 120 0 0 0 1 0\nP3: 240 0 160 -14.4 0 240 120 0 0 0 1 0\n");
  Trajectory truth;
  Eigen::Isometry3d T_2_0 = Eigen::Isometry3d::Identity();
  T_2_0.translation().x() = 0.06;
  for (int k = 0; k < kFrames; ++k) truth.push_back({0.1 * k, pose(k) * T_2_0});
  write("poses.txt", kitti_text(truth));
  const StereoDataset dataset = follow();
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("colour pair")));
  ASSERT_EQ(dataset.ground_truth().size(), static_cast<std::size_t>(kFrames));
  EXPECT_LT((dataset.ground_truth()[3].T.translation() - pose(3).translation()).norm(), 1e-6);
  EXPECT_LT(summarize(run_odometry(dataset)).ate_first.max, 0.004);
  fs::remove_all(folder_ + "/image_3");
  EXPECT_THAT(refusal(), HasSubstr("no such folder"));
}

TEST_F(Recording, JpegImagesAndTruncatedOnes) {
  images("image_0", "image_1", ".jpg", grey);
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  follow();
  const std::string one = folder_ + "/image_1/000002.jpg";
  fs::resize_file(one, fs::file_size(one) / 2);
  EXPECT_THAT(refusal(), HasSubstr("000002.jpg: truncated JPEG"));
  fs::resize_file(one, 7);
  EXPECT_THAT(refusal(), HasSubstr("000002.jpg: truncated JPEG"));
}

TEST_F(Recording, HiddenFilesAndOtherFilesArePassedOver) {
  kitti();
  write("image_0/._000000.png", "of a Mac");
  write("image_1/.DS_Store", "of a Mac");
  write("image_1/Thumbs.db", "of Windows");
  write("image_1/readme.txt", "of a person");
  follow();
  write("image_0/000003 (copy).png", "");
  EXPECT_THAT(refusal(), HasSubstr("is named otherwise than"));
}

TEST_F(Recording, RateOfImagesWithoutTimes) {
  kitti();
  StereoDatasetOptions options;
  options.rate = 25.0;
  EXPECT_NEAR(StereoDataset::open(folder_, options).stamp(4), 0.16, 1e-12);
  EXPECT_NEAR(StereoDataset::open(folder_).stamp(4), 0.4, 1e-12);
  EXPECT_THAT(StereoDataset::open(folder_).notes(), Contains(HasSubstr("10 Hz assumed")));
}

// ---- Bits and colours ------------------------------------------------------------------------

TEST_F(Recording, ImagesOfTwelveAndSixteenBits) {
  for (const int bits : {10, 12, 16}) {
    fs::remove_all(folder_);
    images("image_0", "image_1", ".png", [&](const Image& i) { return wide(i, bits); });
    write("calib.txt",
          "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
    const StereoDataset dataset = follow();
    EXPECT_THAT(dataset.notes(), Contains(HasSubstr("have " + std::to_string(bits) + " bits")));
    // The upper eight bits of what is used are the image that was made 12 or 16 bits of.
    EXPECT_EQ(dataset.read(2).left.pixels, pairs()[2].left.pixels) << bits;
  }
}

TEST_F(Recording, ImagesOfFloatsAreRefused) {
  images("image_0", "image_1", ".tiff", [](const Image& i) {
    cv::Mat out;
    grey(i).convertTo(out, CV_32F, 1.0 / 255);
    return out;
  });
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  EXPECT_THAT(refusal(), HasSubstr("an image of floats"));
}

// ---- KITTI raw -------------------------------------------------------------------------------

TEST_F(Recording, KittiRaw) {
  const std::string drive = "2011_09_26/drive_sync/";
  std::string times;
  for (int k = 0; k < kFrames; ++k) {
    char line[64];
    std::snprintf(line, sizeof line, "2011-09-26 13:02:%012.9f\n", 59.8 + 0.1 * k - (k > 1) * 60.0);
    times += k > 1 ? std::string(line).replace(14, 2, "03") : line;
  }
  images(drive + "image_00/data", drive + "image_01/data", ".png", grey);
  write(drive + "image_00/timestamps.txt", times);
  write(drive + "image_01/timestamps.txt", times);
  const auto calibration = [](const char* size, const char* rectified) {
    return std::string("calib_time: 09-Jan-2012 13:57:47\nS_00: ") + size +
           "\nK_00: 240 0 160 0 240 120 0 0 1\nD_00: 0 0 0 0 0\nR_00: 1 0 0 0 1 0 0 0 1\n"
           "T_00: 0 0 0\nS_rect_00: " +
           rectified + "\nP_rect_00: 240 0 160 0 0 240 120 0 0 0 1 0\nS_01: " + size +
           "\nK_01: 240 0 160 0 240 120 0 0 1\nD_01: 0 0 0 0 0\nR_01: 1 0 0 0 1 0 0 0 1\n"
           "T_01: -0.12 0 0\nS_rect_01: " +
           rectified + "\nP_rect_01: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n";
  };
  write("2011_09_26/calib_cam_to_cam.txt", calibration("400 300", "320 240"));
  const std::string root = folder_;
  folder_ = root + "/2011_09_26/drive_sync";
  const StereoDataset dataset = follow();
  EXPECT_EQ(dataset.layout(), "KITTI raw");
  EXPECT_NEAR(dataset.stamp(0), 1317042179.8, 1e-6);  // date -u -d '2011-09-26 13:02:59.8' +%s
  EXPECT_NEAR(dataset.stamp(4) - dataset.stamp(0), 0.4, 1e-6);
  folder_ = root;
  write("2011_09_26/calib_cam_to_cam.txt", calibration("320 240", "300 200"));
  folder_ = root + "/2011_09_26/drive_sync";
  follow();  // as they come from the cameras
  folder_ = root;
  write("2011_09_26/calib_cam_to_cam.txt", calibration("1392 512", "1242 375"));
  folder_ = root + "/2011_09_26/drive_sync";
  EXPECT_THAT(refusal(), HasSubstr("expected the calibration of these cameras"));
  fs::remove(root + "/2011_09_26/calib_cam_to_cam.txt");
  EXPECT_THAT(refusal(), HasSubstr("calib_cam_to_cam.txt is neither there nor"));
  std::ofstream(folder_ + "/image_01/timestamps.txt") << "yesterday\n";
  EXPECT_THAT(refusal(), HasSubstr("timestamps.txt:1: not a time"));
  folder_ = root;
}

TEST_F(Recording, Kitti360) {
  const std::string root = folder_;
  const std::string drive = "data_2d_raw/2013_05_28_drive_0000_sync";
  images(drive + "/image_00/data_rect", drive + "/image_01/data_rect", ".png", grey);
  fs::create_directories(root + "/" + drive + "/image_02/data_rgb");
  // Of the size of the cameras' own images, too.
  write("calibration/perspective.txt",
        "S_00: 320 240\nK_00: 200 0 160 0 200 120 0 0 1\nD_00: 1 0 0 0 0\n"
        "R_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\nS_rect_00: 320 240\n"
        "P_rect_00: 240 0 160 0 0 240 120 0 0 0 1 0\n"
        "S_01: 320 240\nK_01: 200 0 160 0 200 120 0 0 1\nD_01: 1 0 0 0 0\n"
        "R_01: 1 0 0 0 1 0 0 0 1\nT_01: -0.1 0 0\nS_rect_01: 320 240\n"
        "P_rect_01: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  folder_ = root + "/" + drive;
  EXPECT_EQ(follow().layout(), "KITTI-360");
  StereoDatasetOptions options;
  options.calibration = root + "/calibration/perspective.txt";
  follow(options);
  // Poses of camera 0, which not each image has.
  std::string poses;
  for (const int k : {0, 2, 3, 9}) {
    poses += std::to_string(k);
    for (int n = 0; n < 16; ++n) poses += " " + std::to_string(pose(k).matrix()(n / 4, n % 4));
    poses += "\n";
  }
  folder_ = root;
  write("data_poses/2013_05_28_drive_0000_sync/cam0_to_world.txt", poses);
  folder_ = root + "/" + drive;
  const StereoDataset posed = StereoDataset::open(folder_);
  ASSERT_EQ(posed.ground_truth().size(), 3u);
  EXPECT_EQ(posed.ground_truth()[1].stamp, posed.stamp(2));
  EXPECT_TRUE(posed.ground_truth()[1].T.isApprox(pose(2), 1e-5));
  EXPECT_THAT(posed.notes(), Contains(HasSubstr("ground truth from ")));
  folder_ = root;
  write("data_poses/2013_05_28_drive_0000_sync/cam0_to_world.txt", "0 1 0 0 0 0 1 0 0 0 0 1 0\n");
  folder_ = root + "/" + drive;
  EXPECT_THAT(refusal(), HasSubstr("cam0_to_world.txt:1: not a pose; expected the number of an"));
  fs::remove_all(root + "/data_poses");
  fs::remove_all(folder_ + "/image_00");
  EXPECT_THAT(refusal(), HasSubstr("the fisheye cameras of KITTI-360"));
  options.calibration = root + "/image_02.yaml";
  std::ofstream(options.calibration) << "%YAML:1.0\n---\nmodel_type: MEI\ncamera_name: c\n";
  folder_ = root;
  images("left", "right", ".png", grey);
  EXPECT_THAT(refusal(options), HasSubstr("by the model MEI, which is not supported"));
}

// ---- Numbers of images -----------------------------------------------------------------------

TEST_F(Recording, NumbersBeginAnywhereAndStep) {
  struct Numbers {
    int first, step, before, after;  // lines of times.txt before and after those of the images
  };
  for (const auto& [first, step, before, after] :
       {Numbers{1, 1, 0, 0}, Numbers{100, 5, 0, 0}, Numbers{1700, 33, 0, 0}, Numbers{3, 1, 3, 0},
        Numbers{7, 1, 0, 2}}) {
    SCOPED_TRACE(std::to_string(first) + " by " + std::to_string(step));
    fs::remove_all(folder_);
    std::string times;
    for (int k = -before; k < kFrames + after; ++k) times += std::to_string(9.0 + 0.1 * k) + "\n";
    Trajectory truth;
    for (int k = -before; k < kFrames + after; ++k) truth.push_back({0.0, pose(k)});
    for (int k = 0; k < kFrames; ++k) {
      const std::string name = "/img" + std::to_string(first + step * k);
      image("image_0" + name + (step == 33 ? "_left.png" : ".png"), grey(pairs()[k].left));
      image("image_1" + name + (step == 33 ? "-right.png" : ".png"), grey(pairs()[k].right));
    }
    write("calib.txt",
          "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
    write("times.txt", times);
    write("poses.txt", kitti_text(truth));
    const StereoDataset dataset = StereoDataset::open(folder_);
    ASSERT_EQ(dataset.size(), kFrames);
    EXPECT_NEAR(dataset.stamp(0), 9.0, 1e-6);
    EXPECT_NEAR(dataset.stamp(4), 9.4, 1e-6);
    ASSERT_EQ(dataset.ground_truth().size(), static_cast<std::size_t>(kFrames));
    EXPECT_LT((dataset.ground_truth()[2].T.matrix() - pose(2).matrix()).norm(), 1e-6);
    EXPECT_EQ(dataset.notes().empty(), before > 0);  // by number from 0 is KITTI's rule
  }
  write("times.txt", "9.0\n9.1\n");
  EXPECT_THAT(refusal(), HasSubstr("holds 2 lines for 5 images, numbered 7 to 11"));
  write("image_0/img12_b.png", "");
  EXPECT_THAT(refusal(), HasSubstr("img12_b.png: is named otherwise than"));
}

// ---- What is bad is left out -----------------------------------------------------------------

TEST_F(Recording, ABadImageIsLeftOutAndCounted) {
  kitti();
  for (const char* name : {"image_0/000000.png", "image_1/000002.png"}) {
    fs::remove_all(folder_);
    kitti();
    fs::resize_file(folder_ + "/" + name, 900);
    const OdometryRun run = run_odometry(StereoDataset::open(folder_));
    const OdometrySummary s = summarize(run);
    EXPECT_EQ(s.ok, kFrames - 1) << name;
    EXPECT_THAT(s.lost_reason, HasSubstr(std::string(name) + ": truncated"));
    ASSERT_EQ(run.notes.size(), 1u);
    EXPECT_THAT(run.notes[0], HasSubstr("1 of 5 pairs left out: "));
  }
  for (int k = 0; k < kFrames; ++k) fs::resize_file(folder_ + "/image_1/" + six(k) + ".png", 900);
  EXPECT_THAT(refusal(), HasSubstr("image_1/000000.png: truncated"));
}

TEST_F(Recording, OrientationOfImages) {
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  const auto exif = [](int orientation, bool little) {
    const std::string n = little ? std::string("\1\0\0\0", 4) : std::string("\0\0\0\1", 4);
    const char o = static_cast<char>(orientation);
    return little ? std::string("II*\0\10\0\0\0\1\0\x12\1\3\0", 14) + n + o + std::string(7, '\0')
                  : std::string("MM\0*\0\0\0\10\0\1\1\x12\0\3", 14) + n + std::string(1, '\0') + o +
                        std::string(6, '\0');
  };
  images("image_0", "image_1", ".jpg", grey);
  for (const bool little : {false, true}) {
    for (const int orientation : {1, 3, 6}) {
      for (int k = 0; k < kFrames; ++k) {
        image("image_0/" + six(k) + ".jpg", grey(pairs()[k].left));
        const std::string path = folder_ + "/image_0/" + six(k) + ".jpg";
        std::ifstream in(path, std::ios::binary);
        std::string bytes((std::istreambuf_iterator<char>(in)), {});
        const std::string block = std::string("Exif\0\0", 6) + exif(orientation, little);
        const std::size_t size = block.size() + 2;
        bytes.insert(2, std::string("\xff\xe1") + static_cast<char>(size >> 8) +
                            static_cast<char>(size & 255) + block);
        std::ofstream(path, std::ios::binary) << bytes;
      }
      EXPECT_THAT(refusal(), HasSubstr(orientation == 1 ? std::string("accepted")
                                                        : "000000.jpg: its orientation (Exif) is " +
                                                              std::to_string(orientation)));
    }
  }
}

TEST_F(Recording, TruthWithWFirst) {
  images("left", "right", ".png", grey);
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  for (const bool w_first : {false, true}) {
    std::string text;
    for (int k = 0; k < kFrames; ++k) {
      const Eigen::Quaterniond q(pose(k).linear());
      const Eigen::Vector3d t = pose(k).translation();
      std::ostringstream line;
      line.precision(12);
      line << 0.1 * k << " " << t.transpose() << " ";
      if (w_first) line << q.w() << " ";
      line << q.vec().transpose();
      if (!w_first) line << " " << q.w();
      text += line.str() + "\n";
    }
    write("groundtruth.txt", text);
    const OdometrySummary s = summarize(run_odometry(StereoDataset::open(folder_)));
    EXPECT_EQ(s.truth_turns_wrong.find("have w first") != std::string::npos, w_first)
        << s.truth_turns_wrong;
  }
}

// ---- EuRoC -----------------------------------------------------------------------------------

TEST_F(Recording, SensorFilesOfOthers) {
  euroc();
  // As Kalibr and Kimera write them.
  write("mav0/cam0/sensor.yaml",
        sensor(0.0, "rostopic: /left\ntimeshift_cam_imu: 0.01\ncamera_id: left_cam\n"));
  const StereoDataset dataset = follow();
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("rostopic, timeshift_cam_imu")));
  write("mav0/cam0/sensor.yaml", sensor(0.0, "",
                                        "distortion_model: radtan\n"
                                        "distortion_coefficients: [0, 0, 0]\n"));
  EXPECT_THAT(refusal(), HasSubstr("has 3 coefficients; expected 4, 5 or 8"));
  write("mav0/cam0/sensor.yaml", sensor(0.0, "",
                                        "distortion_model: equidistant\n"
                                        "distortion_coefficients: [0, 0, 0, 0, 0]\n"));
  EXPECT_THAT(refusal(), HasSubstr("expected 4 of an equidistant lens"));
  // A slip is none of the keys to pass over.
  write("mav0/cam0/sensor.yaml", sensor(0.0, "resolutio: [1, 2]\n"));
  EXPECT_THAT(refusal(), HasSubstr("resolutio"));
}

TEST_F(Recording, StampsThatDifferALittle) {
  euroc(1, 3000);
  StereoDataset dataset = follow();
  EXPECT_EQ(dataset.unpaired(), 0);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("right stamps 3 us after the left ones")));
  fs::remove_all(folder_);
  euroc(1, -4'000'000);
  dataset = StereoDataset::open(folder_);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("right stamps 4 ms before the left ones")));
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("depths are wrong while the camera turns")));
  fs::remove_all(folder_);
  euroc(1, 20'000'000);
  EXPECT_THAT(refusal(), HasSubstr("the right stamps are 20 ms later in the median"));
  StereoDatasetOptions options;
  options.sync = 0.025;
  EXPECT_EQ(StereoDataset::open(folder_, options).size(), kFrames);
}

TEST_F(Recording, CameraOfHalfTheRate) {
  euroc(1, 0, 2);
  const StereoDataset dataset = follow({}, 3);
  EXPECT_EQ(dataset.unpaired(), 2);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("left at 10 Hz, right at 5 Hz: the 3 pairs")));
}

TEST_F(Recording, StampsInOtherUnits) {
  const std::pair<std::int64_t, const char*> units[] = {{1'000, "us"}, {1'000'000, "ms"}};
  for (const auto& [unit, name] : units) {
    fs::remove_all(folder_);
    euroc(unit);
    const StereoDataset dataset = follow();
    EXPECT_NEAR(dataset.stamp(4) - dataset.stamp(0), 0.4, 1e-6) << name;
    EXPECT_NEAR(dataset.stamp(0), 1.7e9, 1.0);
    EXPECT_THAT(dataset.notes(), Contains(HasSubstr("stamps in " + std::string(name))));
  }
  fs::remove_all(folder_);
  euroc();
  for (const std::string camera : {"cam0", "cam1"}) {
    for (int k = 0; k < kFrames; ++k) {
      const std::string data = folder_ + "/mav0/" + camera + "/data/";
      fs::rename(data + std::to_string(kStart + 100'000'000LL * k) + ".png",
                 data + "1700000000." + std::to_string(k) + ".png");
    }
  }
  EXPECT_NEAR(follow().stamp(4), 1'700'000'000.4, 1e-5);
}

TEST_F(Recording, RootsOfEuroc) {
  euroc();
  const std::string root = folder_;
  folder_ = root + "/mav0";
  follow();
  folder_ = root;
}

TEST(StampUnit, ByTheRate) {
  const auto unit = [](std::int64_t start, std::int64_t step) {
    const auto found = stamp_unit({start, start + step, start + 2 * step, start + 9 * step});
    return found ? std::string(found->name) : "none";
  };
  EXPECT_EQ(unit(0, 33), "ms");
  EXPECT_EQ(unit(0, 33'333), "us");
  EXPECT_EQ(unit(0, 33'333'333), "ns");
  EXPECT_EQ(unit(1'700'000'000, 1), "s");
  EXPECT_EQ(unit(1'700'000'000'000'000'000, 60'000'000'000), "ns");  // one a minute: by the date
  EXPECT_EQ(unit(5, 60'000'000'000), "none");
  EXPECT_TRUE(counts_frames({0, 1, 2, 3, 7}));
  EXPECT_TRUE(counts_frames({100, 105, 110}));
  EXPECT_FALSE(counts_frames({0, 33, 67}));
  EXPECT_FALSE(counts_frames({1'700'000'000, 1'700'000'001}));
}

ImageStream stream_of(const std::vector<double>& stamps) {
  ImageStream stream;
  stream.name = "camera";
  stream.stamps = stamps;
  for (const double t : stamps) stream.names.push_back(std::to_string(t));
  return stream;
}

TEST(FramePairs, OneBeginsLaterAndOneIsSlower) {
  std::vector<double> fast, slow, late;
  for (int k = 0; k < 60; ++k) {
    fast.push_back(0.05 * k);
    if (k % 3 == 1) slow.push_back(0.05 * k + 0.001);
    if (k > 20) late.push_back(0.05 * k);
  }
  FramePairs pairs = pair_frames(stream_of(fast), stream_of(slow));
  EXPECT_EQ(pairs.pairs.size(), 20u);
  EXPECT_EQ(pairs.left_rate, 3);
  EXPECT_EQ(pairs.holes, 0);
  EXPECT_NEAR(pairs.offset, 0.001, 1e-9);
  EXPECT_EQ(pairing_problem(pairs, stream_of(fast), stream_of(slow)), "");
  pairs = pair_frames(stream_of(slow), stream_of(fast));
  EXPECT_EQ(pairs.right_rate, 3);
  EXPECT_EQ(pairs.holes, 0);
  pairs = pair_frames(stream_of(fast), stream_of(late));
  EXPECT_EQ(pairs.left_alone, 21);
  EXPECT_EQ(pairs.holes, 0);
  // A slower camera that also drops a third of its own.
  std::vector<double> dropped;
  for (std::size_t k = 0; k < slow.size(); ++k) {
    if (k % 3 != 1) dropped.push_back(slow[k]);
  }
  pairs = pair_frames(stream_of(fast), stream_of(dropped));
  EXPECT_GT(pairs.left_alone, 40);
  std::vector<double> elsewhere = {100.0, 100.05, 100.1};
  pairs = pair_frames(stream_of(fast), stream_of(elsewhere));
  EXPECT_THAT(pairing_problem(pairs, stream_of(fast), stream_of(elsewhere)),
              HasSubstr("share no time"));
}

// ---- Calibrations of others ------------------------------------------------------------------

constexpr const char* kCameraInfo =
    "image_width: 320\nimage_height: 240\ncamera_name: c\n"
    "camera_matrix:\n  rows: 3\n  cols: 3\n  data: [240, 0, 160, 0, 240, 120, 0, 0, 1]\n"
    "distortion_model: plumb_bob\n"
    "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n"
    "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
    "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [240, 0, 160, TX, 0, 240, 120, 0, 0, 0, 1, "
    "0]\n";

std::string camera_info(const std::string& tx) {
  std::string text = kCameraInfo;
  return text.replace(text.find("TX"), 2, tx);
}

TEST_F(Recording, FoldersWithCameraInfo) {
  images("left", "right", ".png", grey);
  EXPECT_THAT(refusal(), HasSubstr("no file states the calibration; expected calib.txt"));
  StereoDatasetOptions options;
  options.calibration =
      write("a.yaml", camera_info("0")) + "," + write("b.yaml", camera_info("-28.8"));
  EXPECT_EQ(follow(options).layout(), "folders");
  options.rectified = true;
  follow(options);
  options.calibration = folder_ + "/a.yaml";
  EXPECT_THAT(refusal(options), HasSubstr("expected two, separated by a comma"));
  options.calibration = folder_ + "/a.yaml," + folder_ + "/a.yaml";
  EXPECT_THAT(refusal(options), HasSubstr("P states no baseline"));
  options.calibration = folder_ + "/b.yaml," + folder_ + "/a.yaml";
  EXPECT_THAT(refusal(options), HasSubstr("they look exchanged"));
  write("left/camera_info.yaml", camera_info("0"));
  write("right/camera_info.yaml", camera_info("-28.8"));
  EXPECT_THAT(follow().notes(), Contains(HasSubstr("calibration from")));
}

// A multiple of P projects alike, and gives other lengths.
TEST_F(Recording, PThatIsNotOfARectifiedPairIsRefused) {
  images("left", "right", ".png", grey);
  const std::string sound = camera_info("-28.8");
  const std::string row = "data: [240, 0, 160, -28.8, 0, 240, 120, 0, 0, 0, 1, 0]";
  StereoDatasetOptions options;
  options.rectified = true;
  for (const char* wrong : {"480, 0, 320, -57.6, 0, 480, 240, 0, 0, 0, 2, 0",
                            "240, 9, 160, -28.8, 0, 240, 120, 0, 0, 0, 1, 0",
                            "240, 0, 160, -28.8, 0, 240, 120, -28.8, 0, 0, 1, 0",
                            "240, 0, 160, -28.8, 0, 240, 120, 0, 0, 0, 1, 0.3",
                            "240, 0, 160, -28.8, 0, 0, 120, 0, 0, 0, 1, 0"}) {
    std::string text = sound;
    ASSERT_NE(text.find(row), std::string::npos);
    text.replace(text.find(row), row.size(), "data: [" + std::string(wrong) + "]");
    options.calibration = write("a.yaml", camera_info("0")) + "," + write("b.yaml", text);
    EXPECT_THAT(refusal(options), HasSubstr("b.yaml: P is not of the form [fx 0 cx tx;")) << wrong;
  }
}

TEST_F(Recording, PWithTheOtherSign) {
  images("left", "right", ".png", grey);
  StereoDatasetOptions options;
  options.calibration =
      write("a.yaml", camera_info("0")) + "," + write("b.yaml", camera_info("28.8"));
  for (const bool rectified : {false, true}) {
    options.rectified = rectified;
    EXPECT_THAT(follow(options).notes(), Contains(HasSubstr("as the images say")));
  }
  // Of a camera that is to the left the images say so.
  fs::rename(folder_ + "/left", folder_ + "/other");
  fs::rename(folder_ + "/right", folder_ + "/left");
  fs::rename(folder_ + "/other", folder_ + "/right");
  EXPECT_THAT(refusal(options), HasSubstr("left and right look exchanged"));
  images("left", "right", ".png", [](const Image&) { return cv::Mat(240, 320, CV_8U, 90); });
  EXPECT_THAT(refusal(options), HasSubstr("too little texture to say on which side"));
  options.calibration = folder_ + "/b.yaml," + folder_ + "/b.yaml";
  EXPECT_THAT(refusal(options), HasSubstr("P has the same fourth number, 28.8"));
}

TEST_F(Recording, CalibrationOfAZed) {
  std::string conf;
  for (const char* resolution : {"HD", "VGA"}) {
    for (const std::string side : {"LEFT", "RIGHT"}) {
      conf += "[" + side + "_CAM_" + resolution + "]\nfx=" + (side == "LEFT" ? "350" : "351") +
              "\nfy=352\ncx=336.5\ncy=188.25\nk1=-0.1\nk2 = 0.02\np1=0.003\np2=-0.004\nk3=0.5\n";
    }
  }
  conf +=
      "[STEREO]\nBaseline=120\nTY_VGA=0.3\nTZ_VGA=-0.5\nTY=9\nTZ=9\nCV_VGA=0.02\nRX_VGA=0.01\n"
      "RZ_VGA=0\nCV_HD=0\n";
  const StereoCalibration all = read_stereo_calibration(write("SN1.conf", conf));
  const StereoCalibration vga = of_size(all, 672, 376);
  EXPECT_FALSE(vga.rectified);
  EXPECT_EQ(vga.right.pinhole.fx, 351.0);
  EXPECT_EQ(vga.left.distortion[3], -0.004);
  EXPECT_EQ(vga.left.distortion[4], 0.5);
  // x_right = R x_left - (Baseline, TY, TZ).
  const Eigen::Isometry3d T_RL = vga.right.T_BC.inverse();
  EXPECT_LT((T_RL.translation() - Eigen::Vector3d(-0.12, -0.0003, 0.0005)).norm(), 1e-12);
  const Eigen::AngleAxisd turn(T_RL.linear());
  EXPECT_LT((turn.angle() * turn.axis() - Eigen::Vector3d(0.01, 0.02, 0.0)).norm(), 1e-9);
  EXPECT_EQ(of_size(all, 1280, 720).left.pinhole.width, 1280.0);
  images("left", "right", ".png", grey);
  StereoDatasetOptions options;
  options.calibration = folder_ + "/SN1.conf";
  EXPECT_THAT(refusal(options), HasSubstr("is for images of 1280 x 720 px, 672 x 376 px, but"));
  options.calibration = write("SN2.conf", "[STEREO]\nBaseline=120\n");
  EXPECT_THAT(refusal(options), HasSubstr("fx is missing in [left_cam_hd]"));
  options.calibration = write("SN3.conf", conf + "RX_VGA=0.02\n");
  EXPECT_THAT(refusal(options), HasSubstr("rx_vga is stated twice in [stereo]"));
  options.calibration = write("SN4.conf", conf.replace(conf.find("188.25"), 6, "188,25"));
  EXPECT_THAT(refusal(options), HasSubstr("cy in [left_cam_hd] is '188,25'; expected one number"));
}

/// Frames as they are, 0.1 s apart from 20 s on.
test::MatroskaVideo video_of(Image RenderedRoom::Pair::*side, std::uint64_t late_ms = 0) {
  test::MatroskaVideo video{320, 240, {}};
  for (int k = 0; k < kFrames; ++k) {
    const Image& image = pairs()[k].*side;
    video.frames.push_back({20'000 + 100u * static_cast<unsigned>(k) + late_ms,
                            std::string(image.pixels.begin(), image.pixels.end())});
  }
  return video;
}

TEST_F(Recording, Videos) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no ffmpeg in PATH";
  const test::MatroskaVideo left = video_of(&RenderedRoom::Pair::left);
  test::MatroskaVideo right = video_of(&RenderedRoom::Pair::right, 2);
  // The right one begins a frame earlier: pairs are made by stamps, not by counting.
  right.frames.insert(right.frames.begin(), {19'902, right.frames[3].bytes});
  write("left.mkv", left.bytes());
  write("right.mkv", right.bytes());
  EXPECT_THAT(refusal(), HasSubstr("no file states the calibration; expected calib.txt"));
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  Trajectory truth;
  for (int k = 0; k < kFrames; ++k) truth.push_back({20.0 + 0.1 * k, pose(k)});
  write("groundtruth.txt", tum_text(truth));
  const StereoDataset dataset = follow();
  EXPECT_EQ(dataset.layout(), "videos");
  EXPECT_EQ(dataset.unpaired(), 1);
  EXPECT_EQ(dataset.stamp(4), 20.4);
  EXPECT_EQ(dataset.read(3).left.pixels, pairs()[3].left.pixels);
  EXPECT_EQ(dataset.read(3).right.pixels, pairs()[3].right.pixels);
  EXPECT_LT(summarize(run_odometry(dataset)).ate_first.max, 0.004);
  Found found{};
  const nlohmann::ordered_json json = inspect_path(folder_, {}, {}, found);
  EXPECT_EQ(found, Found::kUsable) << json;
  EXPECT_EQ(json["recordings"][0]["right"]["images"], kFrames + 1);

  write("right.mkv", video_of(&RenderedRoom::Pair::right, 30).bytes());
  EXPECT_THAT(refusal(), HasSubstr("or --sync SECONDS"));
  StereoDatasetOptions options;
  options.sync = 0.04;
  follow(options);
  test::MatroskaVideo small{160, 120, {}};
  for (const auto& frame : left.frames)
    small.frames.push_back({frame.ms, frame.bytes.substr(0, 160 * 120)});
  write("right.mkv", small.bytes());
  EXPECT_THAT(refusal(), HasSubstr("right.mkv frame 0: has 160 x 120 pixels, the left image 320"));
  write("right.mkv", "no video");
  EXPECT_THAT(refusal(), HasSubstr("right.mkv: ffmpeg decodes no frame of it"));
  // Folders count before videos.
  images("left", "right", ".png", grey);
  EXPECT_EQ(follow().layout(), "KITTI");
}

TEST_F(Recording, VideoSideBySide) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "no ffmpeg in PATH";
  test::MatroskaVideo video{640, 240, {}};
  for (int k = 0; k < kFrames; ++k) {
    cv::Mat both;
    cv::hconcat(grey(pairs()[k].left), grey(pairs()[k].right), both);
    video.frames.push_back(
        {100u * static_cast<unsigned>(k), std::string(both.datastart, both.dataend)});
  }
  write("film/both.mkv", video.bytes());
  write("film/calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  folder_ += "/film/both.mkv";
  const StereoDataset dataset = follow();
  EXPECT_EQ(dataset.read(2).left.pixels, pairs()[2].left.pixels);
  EXPECT_EQ(dataset.read(2).right.pixels, pairs()[2].right.pixels);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("left and right halves")));
  fs::remove_all(fs::path(folder_).parent_path());
}

TEST_F(Recording, FoldersWithOpenCvStereoAndCamchain) {
  images("image_left", "image_right", ".png", grey);
  const auto matrix = [](const char* name, int rows, int cols, const char* data) {
    return std::string(name) + ": !!opencv-matrix\n   rows: " + std::to_string(rows) +
           "\n   cols: " + std::to_string(cols) + "\n   dt: d\n   data: [ " + data + " ]\n";
  };
  const std::string intrinsics = "%YAML:1.0\n---\n" +
                                 matrix("M1", 3, 3, "240., 0., 160., 0., 240., 120., 0., 0., 1.") +
                                 matrix("D1", 1, 5, "0., 0., 0., 0., 0.") +
                                 matrix("M2", 3, 3, "240., 0., 160., 0., 240., 120., 0., 0., 1.") +
                                 matrix("D2", 1, 5, "0., 0., 0., 0., 0.");
  const std::string R = matrix("R", 3, 3, "1., 0., 0., 0., 1., 0., 0., 0., 1.");
  StereoDatasetOptions options;
  options.calibration = write("one.yaml", intrinsics + R + matrix("T", 3, 1, "-0.12, 0., 0."));
  EXPECT_THAT(follow(options).notes(), Contains(HasSubstr("taken as radial-tangential")));
  options.calibration = write("in.yml", intrinsics) + "," +
                        write("ex.yml", "%YAML:1.0\n---\n" + R + matrix("T", 3, 1, "-0.12, 0, 0"));
  follow(options);
  options.calibration = write("mm.yaml", intrinsics + R + matrix("T", 3, 1, "-120., 0., 0."));
  EXPECT_THAT(refusal(options), HasSubstr("which would be millimetres; expected metres"));
  options.calibration = write("no_t.yaml", intrinsics + R);
  EXPECT_THAT(refusal(options), HasSubstr("T is missing; expected 3 numbers"));
  const std::string camera =
      "  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n"
      "  distortion_model: radtan\n  intrinsics: [240, 240, 160, 120]\n  resolution: [320, 240]\n"
      "  rostopic: /cam\n";
  const std::string T =
      "  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.12]\n  - [0.0, 1.0, 0.0, 0.0]\n"
      "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n";
  write("camchain.yaml", "cam0:\n" + camera + "cam1:\n" + T + camera);
  follow();
  write("camchain.yaml", "cam0:\n" + camera + "cam1:\n" + camera);
  EXPECT_THAT(refusal(), HasSubstr("cam1 has no T_cn_cnm1"));
  write("camchain.yaml", "cam0:\n" + camera);
  EXPECT_THAT(refusal(), HasSubstr("holds cam0 only"));
  options.calibration = write("world.yaml", "rooms: []\n");
  EXPECT_THAT(refusal(options), HasSubstr("neither calib.txt"));
  options.calibration = write("bad.yaml", "M1: [1, 2\n");
  EXPECT_THAT(refusal(options), HasSubstr("expected YAML"));
}

TEST_F(Recording, FisheyePair) {
  // What an equidistant lens of f = 180 px sees: each pixel's ray, looked up in a wide flat image.
  StereoCamera flat;
  flat.left = {240.0, 240.0, 320.0, 240.0, 640.0, 480.0};
  flat.baseline = 0.12;
  for (int k = 0; k < kFrames; ++k) {
    const RenderedRoom::Pair seen = RenderedRoom().render(flat, pose(k), 1.0, k);
    for (const bool right : {false, true}) {
      const Image& from = right ? seen.right : seen.left;
      cv::Mat to(240, 320, CV_8U, cv::Scalar(0));
      for (int v = 0; v < 240; ++v) {
        for (int u = 0; u < 320; ++u) {
          const Eigen::Vector2d d((u - 160.0) / 180.0, (v - 120.0) / 180.0);
          const double t = d.norm();
          const Eigen::Vector2d ray = t < 1e-9 ? d : Eigen::Vector2d(d * (std::tan(t) / t));
          const double x = 240.0 * ray.x() + 320.0, y = 240.0 * ray.y() + 240.0;
          if (!(x >= 0 && y >= 0 && x < 639 && y < 479)) continue;
          const int i = static_cast<int>(x), j = static_cast<int>(y);
          const double a = x - i, b = y - j;
          to.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(
              std::lround((1 - a) * (1 - b) * from.at(i, j) + a * (1 - b) * from.at(i + 1, j) +
                          (1 - a) * b * from.at(i, j + 1) + a * b * from.at(i + 1, j + 1)));
        }
      }
      image((right ? "right/" : "left/") + six(k) + ".png", to);
    }
  }
  const std::string camera =
      "  camera_model: pinhole\n  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n"
      "  distortion_model: equidistant\n  intrinsics: [180, 180, 160, 120]\n"
      "  resolution: [320, 240]\n";
  write("camchain.yaml", "cam0:\n" + camera +
                             "cam1:\n  T_cn_cnm1:\n  - [1, 0, 0, -0.12]\n  - [0, 1, 0, 0]\n"
                             "  - [0, 0, 1, 0]\n  - [0, 0, 0, 1]\n" +
                             camera);
  const StereoDataset dataset = follow();
  // The rows that are widest decide: 120 px up and 119 px down.
  EXPECT_NEAR(dataset.camera().left.fx, 239.0 / (std::tan(120.0 / 180.0) + std::tan(119.0 / 180.0)),
              0.5);
}

// ---- What is said ----------------------------------------------------------------------------

TEST_F(Recording, LostRecordingHasNoError) {
  kitti();
  Trajectory truth;
  for (int k = 0; k < kFrames; ++k) truth.push_back({0.1 * k, pose(k)});
  write("poses.txt", kitti_text(truth));
  for (int k = 1; k < kFrames; ++k) {
    image("image_0/" + six(k) + ".png", cv::Mat(240, 320, CV_8U, cv::Scalar(90 + k)));
  }
  const OdometrySummary s = summarize(run_odometry(StereoDataset::open(folder_)));
  EXPECT_EQ(s.lost, kFrames - 1);
  EXPECT_TRUE(s.mostly_lost);
  EXPECT_NE(s.lost_reason, "");
  EXPECT_NEAR(s.covered, 0.2, 1e-12);
  for (const double none : {s.end.translation, s.end.share, s.end.rotation, s.ate_first.rmse,
                            s.ate_fit.rmse, s.true_length, s.estimated_length}) {
    EXPECT_TRUE(std::isnan(none));
  }
}

TEST_F(Recording, Inspect) {
  const auto inspect = [&](Found expected) {
    Found found = Found::kUnknown;
    const auto json = inspect_path(folder_, {}, {}, found);
    EXPECT_EQ(found, expected) << json.dump(1);
    EXPECT_NE(inspection_text(json), "");
    return json;
  };
  fs::create_directories(folder_);
  EXPECT_TRUE(inspect(Found::kUnknown).contains("looked_for"));
  images("left", "right", ".png", [](const Image& i) { return wide(i, 12); });
  auto json = inspect(Found::kIncomplete)["recordings"][0];
  EXPECT_TRUE(json["calibration"].is_null());
  EXPECT_EQ(json["missing"].size(), 1u);
  EXPECT_FALSE(json["supply"].empty());
  EXPECT_EQ(json["left"]["significant_bits"], 12);
  EXPECT_EQ(json["pairs"], kFrames);
  // The lines that it names are what is missing.
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  json = inspect(Found::kUsable)["recordings"][0];
  EXPECT_EQ(json["layout"], "KITTI");
  EXPECT_NEAR(json["calibration"]["baseline_m"].get<double>(), 0.12, 1e-9);
  EXPECT_TRUE(json["ground_truth_poses"].is_null());
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 28.8 0 240 120 0 0 0 1 0\n");
  json = inspect(Found::kIncomplete)["recordings"][0];
  EXPECT_THAT(json["missing"][0].get<std::string>(), HasSubstr("look exchanged"));
  // One that the images alone tell.
  write("calib.txt",
        "P0: 240 0 160 0 0 240 120 0 0 0 1 0\nP1: 240 0 160 -28.8 0 240 120 0 0 0 1 0\n");
  for (int k = 0; k < kFrames; ++k) {
    image("left/" + six(k) + ".png", grey(pairs()[k].right));
    image("right/" + six(k) + ".png", grey(pairs()[k].left));
  }
  json = inspect(Found::kIncomplete)["recordings"][0];
  EXPECT_THAT(json["missing"][0].get<std::string>(), HasSubstr("left and right look exchanged"));
  Found found = Found::kUnknown;
  EXPECT_EQ(inspect_path(write("w.bt", ""), {}, {}, found)["what"], "OctoMap");
  EXPECT_EQ(found, Found::kUsable);
  EXPECT_THROW(inspect_path(folder_ + "/nothing", {}, {}, found), InputError);
}

}  // namespace
}  // namespace prospect::recording_layouts_test
