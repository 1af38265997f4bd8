// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/depth_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <opencv2/core.hpp>
#include <sstream>
#include <string>
#include <tuple>

#include "adapters/formats/files/input_error.h"
#include "tests/images/image_file.h"
#include "tests/perception/depth_recording.h"

namespace prospect::depth_dataset_test {
namespace {

namespace fs = std::filesystem;
using test::DepthRecording;
using ::testing::HasSubstr;

/// Recordings of a rendered room, written anew for each test and then damaged.
class DepthDatasetTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        (fs::temp_directory_path() / ("prospect depth " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
    recording_.frames = 3;
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) {
    fs::create_directories(fs::path(folder_ + "/" + name).parent_path());
    std::ofstream(folder_ + "/" + name) << text;
  }
  std::string refusal(const DepthDatasetOptions& options = {}) {
    try {
      const DepthDataset dataset = DepthDataset::open(folder_, options);
      for (int i = 0; i < dataset.size(); ++i) dataset.read(i);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u) << error.what();
      return error.what();
    }
    return "accepted";
  }
  std::string tum_image(int k) const {
    char stamp[32];
    std::snprintf(stamp, sizeof stamp, "%.6f", 1305031102.0 + recording_.period * k);
    return folder_ + "/depth/" + stamp + ".png";
  }
  static DepthDatasetOptions given_camera() {
    DepthDatasetOptions options;
    options.camera = PinholeCamera{262.5, 262.5, 159.5, 119.5, 1.0, 1.0};
    return options;
  }

  DepthRecording recording_;
  std::string folder_;
};

void expect_good(const DepthDataset& dataset, const DepthRecording& recording, double unit) {
  ASSERT_EQ(dataset.size(), recording.frames);
  EXPECT_EQ(dataset.camera().fx, 262.5);
  EXPECT_EQ(dataset.camera().width, 320.0);
  EXPECT_EQ(dataset.camera().height, 240.0);
  EXPECT_NEAR(dataset.stamp(2) - dataset.stamp(0), 0.2, 1e-6);
  for (int k = 0; k < dataset.size(); ++k) {
    if (dataset.has_poses()) {
      EXPECT_TRUE(dataset.pose(k).isApprox(recording.T_DW * recording.pose(k), 1e-6));
    }
    const DepthImage image = dataset.read(k);
    const DepthImage truth =
        recording.scene.render(recording.camera, recording.pose(k), DepthRecording::kNoise,
                               100 + static_cast<std::uint64_t>(k));
    for (int v = 0; v < 240; v += 7) {
      for (int u = 0; u < 320; u += 7) {
        ASSERT_EQ(std::isfinite(image.at(u, v)), std::isfinite(truth.at(u, v)));
        if (std::isfinite(image.at(u, v))) {
          ASSERT_NEAR(image.at(u, v), truth.at(u, v), 0.51 * unit);
        }
      }
    }
  }
}

TEST_F(DepthDatasetTest, SevenScenesLayout) {
  recording_.write_seven_scenes(folder_);
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.layout(), "7-Scenes");
  EXPECT_TRUE(dataset.has_poses());
  EXPECT_TRUE(dataset.times_assumed());
  expect_good(dataset, recording_, 0.001);
}

TEST_F(DepthDatasetTest, TumLayout) {
  recording_.write_tum(folder_);
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.layout(), "TUM RGB-D");
  EXPECT_TRUE(dataset.has_poses());
  EXPECT_FALSE(dataset.times_assumed());
  EXPECT_EQ(dataset.without_pose(), 0);
  expect_good(dataset, recording_, 0.0002);
}

TEST_F(DepthDatasetTest, TextAsEditorsOfWindowsLeaveIt) {
  recording_.write_tum(folder_);
  for (const char* name : {"depth.txt", "groundtruth.txt", "camera-intrinsics.txt"}) {
    std::ifstream in(folder_ + "/" + name);
    std::string text = "\xef\xbb\xbf";
    for (std::string line; std::getline(in, line);) {
      if (line.empty() || line[0] != '#') text += line + "\r\n";
    }
    in.close();
    write(name, text);
  }
  expect_good(DepthDataset::open(folder_), recording_, 0.0002);
}

// The rate says which unit stamps are in: ten images a second.
TEST_F(DepthDatasetTest, TumStampsInAnotherUnit) {
  recording_.frames = 3;
  for (const auto& [period, unit] : {std::pair{100.0, "ms"}, std::pair{100000.0, "us"}}) {
    recording_.period = period;
    fs::remove_all(folder_);
    recording_.write_tum(folder_);
    const DepthDataset dataset = DepthDataset::open(folder_);
    ASSERT_EQ(dataset.size(), 3);
    EXPECT_EQ(dataset.without_pose(), 0);
    EXPECT_NEAR(dataset.stamp(1) - dataset.stamp(0), 0.1, 1e-6);
    EXPECT_THAT(dataset.notes(), ::testing::Contains(HasSubstr(std::string("stamps in ") + unit +
                                                               ", by their rate")));
  }
}

TEST_F(DepthDatasetTest, TumFramesWithoutAPoseAreLeftOut) {
  recording_.write_tum(folder_);
  std::ifstream in(folder_ + "/groundtruth.txt");
  std::string text, line;
  for (int n = 0; std::getline(in, line); ++n) {
    if (n != 2) text += line + "\n";  // of the second frame
  }
  in.close();
  write("groundtruth.txt", text);
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.size(), 2);
  EXPECT_EQ(dataset.without_pose(), 1);
  EXPECT_TRUE(dataset.pose(1).isApprox(recording_.T_DW * recording_.pose(2), 1e-6));
  write("groundtruth.txt", "1.0 0 0 0 0 0 0 1\n");
  EXPECT_THAT(refusal(), HasSubstr("no pose within 0.02 s"));
  fs::remove(folder_ + "/groundtruth.txt");
  EXPECT_FALSE(DepthDataset::open(folder_).has_poses());
}

TEST_F(DepthDatasetTest, NumberedLayout) {
  recording_.write_numbered(folder_);
  EXPECT_THAT(refusal(), HasSubstr("no file states the camera's intrinsics"));
  const DepthDataset dataset = DepthDataset::open(folder_, given_camera());
  EXPECT_EQ(dataset.layout(), "numbered");
  EXPECT_FALSE(dataset.has_poses());
  expect_good(dataset, recording_, 0.001);
  recording_.write_intrinsics(folder_);
  expect_good(DepthDataset::open(folder_), recording_, 0.001);
  EXPECT_THAT(refusal(given_camera()), HasSubstr("expected no others beside it"));
}

TEST_F(DepthDatasetTest, SaysWhatIsMissingOrMalformed) {
  EXPECT_THAT(refusal(), HasSubstr("no such folder"));
  fs::create_directories(folder_);
  EXPECT_THAT(refusal(), HasSubstr("depth.txt (TUM RGB-D), frame-NNNNNN.depth.png"));
  fs::create_directories(folder_ + "/depth");
  EXPECT_THAT(refusal(), HasSubstr("holds no image"));

  recording_.write_seven_scenes(folder_);
  const auto damaged = [&](const std::string& name, const std::string& text) {
    recording_.write_seven_scenes(folder_);
    write(name, text);
    return refusal();
  };
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_THAT(damaged("camera-intrinsics.txt", "1 2 3\n"), HasSubstr("ends after 1 rows"));
  EXPECT_THAT(damaged("camera-intrinsics.txt", "585 0 160\n0 x 120\n0 0 1\n"),
              HasSubstr("camera-intrinsics.txt:2: "));
  EXPECT_THAT(damaged("camera-intrinsics.txt", "-5 0 160\n0 5 120\n0 0 1\n"),
              HasSubstr("not of the form"));
  EXPECT_THAT(damaged("camera-intrinsics.txt", "262 0 900\n0 262 120\n0 0 1\n"),
              HasSubstr("the principal point is (900, 120)"));
  EXPECT_THAT(damaged("frame-000003.pose.txt", "1 0 0 0\n0 1 0 0\n0 0 x 0\n0 0 0 1\n"),
              HasSubstr("frame-000003.pose.txt:3: "));
  EXPECT_THAT(damaged("frame-000003.pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 2\n"),
              HasSubstr("not a rotation"));
  EXPECT_THAT(damaged("frame-000003.pose.txt", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n5\n"),
              HasSubstr("frame-000003.pose.txt:5: "));
  EXPECT_THAT(damaged("frame-000003.depth.png", "no image"), HasSubstr("cannot be decoded"));
  recording_.write_seven_scenes(folder_);
  fs::resize_file(folder_ + "/frame-000003.depth.png", 9000);
  EXPECT_THAT(refusal(), HasSubstr("truncated"));
  EXPECT_THAT(damaged("frame-zebra.depth.png", "no image"), HasSubstr("the name is no number"));
  fs::remove_all(folder_);
  recording_.write_seven_scenes(folder_);
  fs::remove(folder_ + "/frame-000003.pose.txt");
  EXPECT_THAT(refusal(), HasSubstr("frame-000003.pose.txt: no such file"));

  fs::remove_all(folder_);
  recording_.write_tum(folder_);
  EXPECT_EQ(refusal(), "accepted");
  write("depth.txt", "1305031102.0 depth/absent.png\n");
  EXPECT_THAT(refusal(), HasSubstr("depth/absent.png is absent"));
  write("depth.txt", "now depth/1.png\n");
  EXPECT_THAT(refusal(), HasSubstr("depth.txt:1: not a frame"));
  write("depth.txt", "# nothing\n");
  EXPECT_THAT(refusal(), HasSubstr("holds no frame"));
  fs::remove_all(folder_);
  recording_.write_tum(folder_);
  fs::remove(folder_ + "/camera-intrinsics.txt");
  EXPECT_THAT(refusal(), HasSubstr("no file states the camera's intrinsics"));
}

TEST_F(DepthDatasetTest, RefusesImagesThatAreNoDepth) {
  recording_.write_seven_scenes(folder_);
  test::write_image(folder_ + "/frame-000003.depth.png", cv::Mat(240, 320, CV_8UC1, cv::Scalar(7)));
  EXPECT_THAT(refusal(), HasSubstr("not of 16 bits a pixel"));
  test::write_image(folder_ + "/frame-000003.depth.png",
                    cv::Mat(120, 160, CV_16UC1, cv::Scalar(7)));
  EXPECT_THAT(refusal(), HasSubstr("has 160 x 120 pixels, the first image 320 x 240"));
}

TEST_F(DepthDatasetTest, DepthScaleByThePoses) {
  recording_.frames = 8;
  recording_.write_tum(folder_);
  EXPECT_THAT(DepthDataset::open(folder_).notes().back(), HasSubstr("5000 a metre, by the layout"));
  // The same in millimetres, as a RealSense writes it.
  for (int k = 0; k < recording_.frames; ++k) {
    recording_.write_image(tum_image(k), k, 0.001);
  }
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.depth_scale(), 1000.0);
  EXPECT_FALSE(dataset.depth_scale_doubtful());
  EXPECT_THAT(dataset.notes().back(), HasSubstr("1000 a metre, not 5000"));
  expect_good(dataset, recording_, 0.001);
  // One that is given stands, but what speaks against it is said.
  DepthDatasetOptions options;
  options.depth_scale = 5000.0;
  const DepthDataset given = DepthDataset::open(folder_, options);
  EXPECT_EQ(given.depth_scale(), 5000.0);
  EXPECT_TRUE(given.depth_scale_doubtful());
  options.depth_scale = 1000.0;
  EXPECT_FALSE(DepthDataset::open(folder_, options).depth_scale_doubtful());
}

// They move, but fit no scale.
TEST_F(DepthDatasetTest, PosesThatCannotTellTheScaleAreNamed) {
  recording_.frames = 8;
  recording_.write_tum(folder_);
  std::ifstream in(folder_ + "/groundtruth.txt");
  const std::string metres{std::istreambuf_iterator<char>(in), {}};
  in.close();
  // Too far between them; or turned by 0.7 degrees a frame that the camera did not turn.
  for (const auto& [times, turned, said] :
       {std::tuple(1000.0, 0.0, "the poses cannot tell: by them the images show nothing in common"),
        {1.0, 0.012, "the poses cannot tell: images and poses disagree by"}}) {
    std::istringstream lines(metres);
    std::string spoilt;
    int frame = 0;
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream words(line);
      std::string stamp;
      double x, y, z;
      Eigen::Quaterniond q;
      words >> stamp >> x >> y >> z >> q.x() >> q.y() >> q.z() >> q.w();
      q = q * Eigen::AngleAxisd(turned * frame++, Eigen::Vector3d::UnitX());
      std::ostringstream text;
      text << stamp << ' ' << times * x << ' ' << times * y << ' ' << times * z << ' ' << q.x()
           << ' ' << q.y() << ' ' << q.z() << ' ' << q.w() << '\n';
      spoilt += text.str();
    }
    write("groundtruth.txt", spoilt);
    const std::string note = DepthDataset::open(folder_).notes().back();
    EXPECT_THAT(note, HasSubstr(said));
    EXPECT_EQ(note.find("neither poses"), std::string::npos) << note;
  }
}

TEST_F(DepthDatasetTest, QuaternionsWithWFirst) {
  recording_.frames = 8;
  recording_.write_tum(folder_);
  std::ifstream in(folder_ + "/groundtruth.txt");
  std::string swapped;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string word[8];
    for (std::string& one : word) words >> one;
    for (const int n : {0, 1, 2, 3, 7, 4, 5, 6}) swapped += word[n] + " ";
    swapped += "\n";
  }
  in.close();
  write("groundtruth.txt", swapped);
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.depth_scale(), 5000.0);
  EXPECT_FALSE(dataset.depth_scale_doubtful());
  EXPECT_THAT(dataset.notes().back(), HasSubstr("the poses' quaternions have w first"));
  expect_good(dataset, recording_, 0.0002);
}

TEST_F(DepthDatasetTest, DepthScaleByTheHeightOrUnchecked) {
  recording_.write_tum(folder_);
  for (int k = 0; k < recording_.frames; ++k) {
    recording_.write_image(tum_image(k), k, 0.001);
  }
  fs::remove(folder_ + "/groundtruth.txt");
  EXPECT_THAT(DepthDataset::open(folder_).notes().back(),
              HasSubstr("neither poses that move nor --camera-height"));
  DepthDatasetOptions options;
  options.camera_height = 0.62;
  const DepthDataset dataset = DepthDataset::open(folder_, options);
  EXPECT_EQ(dataset.depth_scale(), 1000.0);
  EXPECT_THAT(dataset.notes().back(), HasSubstr("the ground is 0.62 m below the camera so"));
  options.camera_height = 1.6;  // wrong
  EXPECT_TRUE(DepthDataset::open(folder_, options).depth_scale_doubtful());
}

TEST_F(DepthDatasetTest, DepthsAsFloats) {
  recording_.write_numbered(folder_);
  recording_.write_intrinsics(folder_);
  for (const char* ending : {".tiff", ".pfm"}) {
    fs::remove_all(folder_ + "/depth");
    fs::create_directories(folder_ + "/depth");
    for (int k = 0; k < recording_.frames; ++k) {
      const DepthImage image =
          recording_.scene.render(recording_.camera, recording_.pose(k), DepthRecording::kNoise,
                                  100 + static_cast<std::uint64_t>(k));
      test::write_image(
          folder_ + "/depth/" + std::to_string(3 * k) + ending,
          cv::Mat(image.height, image.width, CV_32F, const_cast<float*>(image.depth.data())));
    }
    const DepthDataset dataset = DepthDataset::open(folder_);
    EXPECT_EQ(dataset.depth_scale(), 1.0) << ending;
    expect_good(dataset, recording_, 1e-5);
  }
}

TEST_F(DepthDatasetTest, FramesWithoutAFinitePoseAreLeftOut) {
  const std::string inf = "-inf -inf -inf -inf\n";
  const std::string nan = "nan nan nan nan\n";
  for (const std::string& pose :
       {inf + inf + inf + inf, inf + inf + inf + "0 0 0 1\n", nan + nan + nan + nan,
        std::string("1 0 0 0\n0 1 0 0\n0 0 -1 0\n0 0 0 1\n"),
        std::string("1 0 0 0\n0 1 0 nan\n0 0 1 0\n0 0 0 1\n"),
        std::string("1 0 0 0\n0 1 0 0\n0 0 1 1e300\n0 0 0 1\n"),
        std::string("1 0 0 -2e8\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")}) {
    recording_.write_seven_scenes(folder_);
    write("frame-000003.pose.txt", pose);
    const DepthDataset dataset = DepthDataset::open(folder_);
    EXPECT_EQ(dataset.size(), 2);
    EXPECT_EQ(dataset.without_pose(), 1);
    EXPECT_TRUE(dataset.pose(1).isApprox(recording_.T_DW * recording_.pose(2), 1e-6));
  }
  for (const char* frame : {"frame-000000", "frame-000003", "frame-000006"}) {
    write(std::string(frame) + ".pose.txt", inf + inf + inf + inf);
  }
  EXPECT_THAT(refusal(), HasSubstr("no frame has a finite pose"));
}

TEST_F(DepthDatasetTest, AssociationsAndStampsInOtherUnits) {
  recording_.write_tum(folder_);
  std::ifstream in(folder_ + "/depth.txt");
  std::string line, associations, micro;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    const std::string stamp = line.substr(0, line.find(' '));
    associations += stamp + " rgb/x.png " + line + "\n";
    micro +=
        std::to_string(std::llround(std::stod(stamp) * 1e6)) + line.substr(line.find(' ')) + "\n";
  }
  in.close();
  write("depth.txt", micro);
  const DepthDataset dataset = DepthDataset::open(folder_);
  EXPECT_EQ(dataset.size(), recording_.frames);
  EXPECT_NEAR(dataset.stamp(2) - dataset.stamp(0), 0.2, 1e-6);
  EXPECT_THAT(dataset.notes().front(), HasSubstr("stamps in us"));
  fs::remove(folder_ + "/depth.txt");
  write("associations.txt", associations);
  expect_good(DepthDataset::open(folder_), recording_, 0.0002);
}

}  // namespace
}  // namespace prospect::depth_dataset_test
