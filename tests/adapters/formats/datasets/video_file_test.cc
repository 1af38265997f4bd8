// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/video_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numeric>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "tests/adapters/matroska_video.h"

namespace prospect::video_file_test {
namespace {

namespace fs = std::filesystem;
using test::MatroskaVideo;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kWidth = 32, kHeight = 16;
constexpr double kTexture = 7.5;  // mean of what jpeg_video() adds

double mean(const RawImage& image) {
  return std::accumulate(image.bytes.begin(), image.bytes.end(), 0.0) /
         static_cast<double>(image.bytes.size());
}

std::string grey_frame(int k, int width = kWidth) {
  std::string bytes;
  for (int i = 0; i < width * kHeight; ++i) bytes += static_cast<char>(16 * k + i % width);
  return bytes;
}

/// Stamps of rates that vary, from a start that is not 0.
MatroskaVideo grey_video() {
  MatroskaVideo video{kWidth, kHeight, {}};
  for (const std::uint64_t ms : {70'500u, 70'533u, 70'633u, 70'640u, 72'000u}) {
    video.frames.push_back({ms, grey_frame(static_cast<int>(video.frames.size()))});
  }
  return video;
}

/// Frame k is grey in a colour image, of levels 40 + 20 k with a texture that adds 0 to 15.
MatroskaVideo jpeg_video(int frames) {
  MatroskaVideo video{kWidth, kHeight, {}, "V_MJPEG"};
  for (int k = 0; k < frames; ++k) {
    cv::Mat image(kHeight, kWidth, CV_8UC3);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      image.at<cv::Vec3b>(i / kWidth, i % kWidth) = cv::Vec3b::all(40 + 20 * k + 5 * i % 16);
    }
    const std::vector<std::uint8_t> bytes = encode_pixels(".jpg", image);
    video.frames.push_back(
        {static_cast<std::uint64_t>(100 * k), std::string(bytes.begin(), bytes.end())});
  }
  return video;
}

class VideoFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << bytes;
    return folder_ + "/" + name;
  }
  /// What is said of a file that cannot be used.
  std::string refusal(const std::string& path) {
    try {
      std::vector<std::string> notes;
      video_images(path, notes);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u);
      EXPECT_THAT(error.what(), AllOf(HasSubstr(path + ": "), HasSubstr("expected")));
      return error.what();
    }
    return "accepted";
  }

  const std::string folder_ =
      (fs::temp_directory_path() / ("prospect videos " + std::to_string(::getpid()))).string();
  std::vector<std::string> notes_;
};

class DecodedVideo : public VideoFileTest {
 protected:
  void SetUp() override {
    if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) {
      GTEST_SKIP() << "no ffmpeg in PATH (Debian: apt-get install ffmpeg)";
    }
    VideoFileTest::SetUp();
  }
};

TEST_F(DecodedVideo, FramesAndTheirTimesAreThoseOfTheFile) {
  const ImageStream stream = video_images(write("a.mkv", grey_video().bytes()), notes_);
  EXPECT_THAT(stream.stamps, ElementsAre(70.5, 70.533, 70.633, 70.64, 72.0));
  EXPECT_EQ(stream.names[3], folder_ + "/a.mkv frame 3");
  EXPECT_THAT(notes_, IsEmpty());
  for (const int k : {0, 0, 1, 4, 2, 3, 0}) {  // also again, leaping, and back
    const RawImage image = stream.read(static_cast<std::size_t>(k));
    EXPECT_EQ(image.width, kWidth);
    EXPECT_EQ(image.height, kHeight);
    EXPECT_EQ(image.channels, 1);
    EXPECT_EQ(std::string(image.bytes.begin(), image.bytes.end()), grey_frame(k)) << k;
  }
}

TEST_F(DecodedVideo, ColourIsItsLuminanceOfFullRange) {
  const ImageStream stream = video_images(write("a.mkv", jpeg_video(11).bytes()), notes_);
  EXPECT_THAT(notes_, IsEmpty());
  ASSERT_EQ(stream.size(), 11u);
  for (int k = 0; k < 11; ++k) {
    EXPECT_NEAR(mean(stream.read(static_cast<std::size_t>(k))), 40 + 20 * k + kTexture, 1) << k;
  }
}

TEST_F(DecodedVideo, SideBySideAreTwoImages) {
  const std::string path = write("a.mkv", grey_video().bytes());
  const auto [left, right] = side_by_side_images(path, notes_);
  EXPECT_EQ(left.stamps, right.stamps);
  for (const std::size_t k : {1, 2}) {
    const RawImage l = left.read(k), r = right.read(k);
    ASSERT_EQ(l.width, kWidth / 2);
    ASSERT_EQ(r.bytes.size(), static_cast<std::size_t>(kWidth / 2 * kHeight));
    EXPECT_EQ(l.bytes[kWidth / 2], 16 * k);  // begin of the second row
    EXPECT_EQ(r.bytes[kWidth / 2], 16 * k + kWidth / 2);
  }
  MatroskaVideo odd{31, kHeight, {{0, grey_frame(0, 31)}}};
  EXPECT_THROW(side_by_side_images(write("odd.mkv", odd.bytes()), notes_), InputError);
}

TEST_F(DecodedVideo, WhatIsCutOffIsSaidAndTheRestIsRead) {
  std::string bytes = grey_video().bytes();
  bytes.resize(bytes.size() - 200);  // within the last frame
  const ImageStream stream = video_images(write("a.mkv", bytes), notes_);
  EXPECT_THAT(stream.stamps, ElementsAre(70.5, 70.533, 70.633, 70.64));
  EXPECT_THAT(notes_,
              ElementsAre(AllOf(HasSubstr("a.mkv: 4 frames are read, to 70.64 s"),
                                HasSubstr("File ended prematurely"), Not(HasSubstr("0x")))));
  const RawImage last = stream.read(3);
  EXPECT_EQ(std::string(last.bytes.begin(), last.bytes.end()), grey_frame(3));
}

TEST_F(DecodedVideo, AFrameThatIsCutOffIsNotMadeUp) {
  // Of this container the decoder is given the half frame, too, and this one makes it whole.
  MatroskaVideo video = grey_video();
  for (std::size_t k = 0; k < video.frames.size(); ++k) video.frames[k].ms = 100 * k;
  const std::string whole = write("a.mkv", video.bytes()), cut = folder_ + "/a.avi";
  ASSERT_EQ(std::system(("ffmpeg -v error -i '" + whole + "' -c:v ffv1 '" + cut + "'").c_str()), 0);
  std::ifstream in(cut, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(in)), {});
  bytes.resize(bytes.find("idx1") - 30);  // the index follows the last frame
  const ImageStream stream = video_images(write("a.avi", bytes), notes_);
  EXPECT_EQ(stream.stamps, (std::vector<double>{0.0, 0.1, 0.2, 0.3}));
  const RawImage last = stream.read(3);
  EXPECT_EQ(std::string(last.bytes.begin(), last.bytes.end()), grey_frame(3));
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("a.avi: 4 frames are read")));
}

TEST_F(DecodedVideo, ADamagedFrameIsLeftOut) {
  MatroskaVideo video = jpeg_video(5);
  std::string& bytes = video.frames[2].bytes;
  const std::size_t scan = bytes.find("\xff\xda");
  bytes.resize(scan + (bytes.size() - scan) / 2);
  const ImageStream stream = video_images(write("a.mkv", video.bytes()), notes_);
  EXPECT_THAT(stream.stamps, ElementsAre(0.0, 0.1, 0.3, 0.4));
  EXPECT_NEAR(mean(stream.read(2)), 100 + kTexture, 1);
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("a.mkv: 4 frames are read, to 0.4 s")));
}

TEST_F(DecodedVideo, RefusesInOneLine) {
  EXPECT_THAT(refusal(write("text.mp4", "no video")), HasSubstr("ffmpeg decodes no frame of it"));
  EXPECT_THAT(refusal(write("empty.avi", "")), HasSubstr("ffmpeg decodes no frame of it"));
  MatroskaVideo video = grey_video();
  video.codec = "V_NONSENSE";
  EXPECT_THAT(refusal(write("codec.mkv", video.bytes())), HasSubstr("Decoder (codec none)"));
  video = jpeg_video(3);
  const cv::Mat larger(2 * kHeight, kWidth, CV_8UC3, cv::Scalar::all(9));
  const std::vector<std::uint8_t> bytes = encode_pixels(".jpg", larger);
  video.frames[2].bytes.assign(bytes.begin(), bytes.end());
  EXPECT_THAT(refusal(write("sizes.mkv", video.bytes())),
              HasSubstr("frame 2 has another size than 32 x 16 pixels"));
}

TEST_F(DecodedVideo, AFileThatChangesIsNoticed) {
  const std::string path = write("a.mkv", grey_video().bytes());
  const ImageStream stream = video_images(path, notes_);
  write("a.mkv", grey_video().bytes().substr(0, 1500));
  EXPECT_THROW(stream.read(4), InputError);
}

TEST_F(VideoFileTest, WhatIsNoFileIsRefused) {
  ASSERT_EQ(::mkfifo((folder_ + "/fifo.mp4").c_str(), 0600), 0);
  EXPECT_THAT(refusal(folder_ + "/fifo.mp4"), HasSubstr("no regular file"));
  fs::create_symlink("/dev/zero", folder_ + "/device.mp4");
  EXPECT_THAT(refusal(folder_ + "/device.mp4"), HasSubstr("no regular file"));
  EXPECT_THAT(refusal(folder_), HasSubstr("no regular file"));
}

TEST_F(VideoFileTest, WithoutTheProgramItSaysWhatToInstall) {
  const std::string path = write("a.mkv", grey_video().bytes());
  const std::string folders = std::getenv("PATH");
  ::setenv("PATH", folder_.c_str(), 1);
  const std::string said = refusal(path);
  ::setenv("PATH", folders.c_str(), 1);
  EXPECT_THAT(said, HasSubstr("apt-get install ffmpeg"));
}

TEST_F(VideoFileTest, FindsAVideoByItsName) {
  write("left.MP4", "");
  write("right.mkv", "");
  write("cam0.txt", "");
  EXPECT_EQ(find_video(folder_ + "/left"), folder_ + "/left.MP4");
  EXPECT_EQ(find_video(folder_ + "/right"), folder_ + "/right.mkv");
  EXPECT_EQ(find_video(folder_ + "/cam0"), "");
  EXPECT_TRUE(is_video_name("film.WebM"));
  EXPECT_FALSE(is_video_name("mp4"));
}

}  // namespace
}  // namespace prospect::video_file_test
