// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#ifdef PROSPECT_WITH_LZ4
#include <lz4frame.h>
#endif
#ifdef PROSPECT_WITH_ZSTD
#include <zstd.h>
#endif
#ifdef PROSPECT_WITH_SQLITE
#include <sqlite3.h>
#endif

#include "adapters/formats/bags/bag_file.h"
#include "adapters/formats/datasets/depth_dataset.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/scan_source.h"
#include "adapters/formats/datasets/stereo_dataset.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/missions/recordings/inspection.h"
#include "adapters/missions/recordings/odometry_run.h"
#include "adapters/missions/recordings/stereo_depth_source.h"
#include "tests/adapters/lidar_recording.h"
#include "tests/adapters/ros_bag_writer.h"
#include "tests/images/image_file.h"
#include "tests/perception/depth_recording.h"
#include "tests/perception/rendered_room.h"

namespace prospect::ros_bag_test {
namespace {

namespace fs = std::filesystem;
using test::BagMessage;
using test::CdrWriter;
using test::RenderedRoom;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kFrames = 4;
constexpr std::int64_t kStart = 1'700'000'000'000'000'000;  // [ns]

std::string plain(const std::string& records) { return records; }
std::uint64_t checksum(const std::string& records) {
  return ::crc32(0, reinterpret_cast<const Bytef*>(records.data()),
                 static_cast<uInt>(records.size()));
}

Eigen::Isometry3d pose(int k) { return RenderedRoom::looking(0.05 * k, 0.0, 1.1, 0.02 * k); }

std::string image_message(std::int64_t t, const std::string& frame, int width, int height,
                          const std::string& encoding, const std::string& pixels) {
  CdrWriter w;
  w.header(t, frame)
      .number(static_cast<std::uint32_t>(height))
      .number(static_cast<std::uint32_t>(width));
  w.text(encoding).number(std::uint8_t{0});
  w.number(static_cast<std::uint32_t>(pixels.size() / static_cast<std::size_t>(height)));
  return w.bytes(pixels).str();
}

std::string info_message(std::int64_t t, double tx, double f, int width, int height) {
  const double cx = 0.5 * width, cy = 0.5 * height;
  CdrWriter w;
  w.header(t, "left")
      .number(static_cast<std::uint32_t>(height))
      .number(static_cast<std::uint32_t>(width));
  w.text("plumb_bob").number(std::uint32_t{5}).doubles({0, 0, 0, 0, 0});
  w.doubles({f, 0, cx, 0, f, cy, 0, 0, 1}).doubles({1, 0, 0, 0, 1, 0, 0, 0, 1});
  w.doubles({f, 0, cx, tx, 0, f, cy, 0, 0, 0, 1, 0});
  for (int k = 0; k < 6; ++k) w.number(std::uint32_t{0});  // binning, region of interest
  return w.number(std::uint8_t{0}).str();
}

std::string text_of(const Image& image) { return {image.pixels.begin(), image.pixels.end()}; }

/// A pair of cameras at 10 Hz, the pose of base_link, from which the left camera stands 0.3 m
/// forward and 0.2 m up.
std::vector<BagMessage> stereo_messages(const std::string& encoding = "mono8",
                                        bool compressed = false) {
  StereoCamera camera;
  camera.left = {240.0, 240.0, 160.0, 120.0, 320.0, 240.0};
  camera.baseline = 0.12;
  // The images are the same for all: they are rendered once.
  static const std::vector<RenderedRoom::Pair> pairs = [&] {
    std::vector<RenderedRoom::Pair> rendered;
    for (int k = 0; k < kFrames; ++k) {
      rendered.push_back(RenderedRoom().render(camera, pose(k), 2.0, k));
    }
    return rendered;
  }();
  Eigen::Isometry3d T_BC = Eigen::Isometry3d::Identity();
  T_BC.translation() << 0.3, 0.0, 0.2;
  T_BC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  std::vector<BagMessage> out;
  out.push_back({"/tf_static", "tf2_msgs/msg/TFMessage", kStart,
                 CdrWriter()
                     .number(std::uint32_t{1})
                     .header(kStart, "base_link")
                     .text("left")
                     .pose(T_BC)
                     .str()});
  for (int k = 0; k < kFrames; ++k) {
    const std::int64_t t = kStart + 100'000'000LL * k;
    const RenderedRoom::Pair& pair = pairs[static_cast<std::size_t>(k)];
    for (const bool right : {false, true}) {
      const std::string side = right ? "/stereo/right/" : "/stereo/left/";
      const Image& image = right ? pair.right : pair.left;
      if (compressed) {
        const std::vector<std::uint8_t> png = encode_pixels(".png", test::pixels_of(image));
        out.push_back({side + "image_raw/compressed", "sensor_msgs/msg/CompressedImage", t,
                       CdrWriter()
                           .header(t, "left")
                           .text("mono8; png compressed")
                           .bytes({png.begin(), png.end()})
                           .str()});
      } else {
        std::string pixels = text_of(image);
        if (encoding == "rgb8") {
          std::string three;
          for (const char c : pixels) three += std::string(3, c);
          pixels = three;
        }
        out.push_back({side + "image_raw", "sensor_msgs/msg/Image", t,
                       image_message(t, "left", 320, 240, encoding, pixels)});
      }
      out.push_back({side + "camera_info", "sensor_msgs/msg/CameraInfo", t,
                     info_message(t, right ? -28.8 : 0.0, 240.0, 320, 240)});
    }
    CdrWriter odometry;
    odometry.header(t, "odom").text("base_link").pose(pose(k) * T_BC.inverse());
    odometry.doubles(std::vector<double>(36 + 6 + 36, 0.0));
    out.push_back({"/odom", "nav_msgs/msg/Odometry", t, odometry.str()});
  }
  return out;
}

class RosBag : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = (fs::temp_directory_path() / ("prospect bag " + std::to_string(::getpid()))).string();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ + "/" + name, std::ios::binary) << bytes;
    return folder_ + "/" + name;
  }
  static std::string refusal(const std::string& path, const StereoDatasetOptions& options = {}) {
    try {
      const StereoDataset dataset = StereoDataset::open(path, options);
      for (int i = 0; i < dataset.size(); ++i) dataset.read(i);
    } catch (const InputError& error) {
      EXPECT_EQ(error.lines().size(), 1u) << error.what();
      return error.what();
    }
    return "accepted";
  }
  static void follow(const std::string& path) {
    StereoDatasetOptions options;
    options.topics["truth"] = "/odom";
    const StereoDataset dataset = StereoDataset::open(path, options);
    ASSERT_EQ(dataset.size(), kFrames);
    EXPECT_EQ(dataset.layout(), "ROS 2 bag");
    EXPECT_NEAR(dataset.camera().baseline, 0.12, 1e-9);
    EXPECT_NEAR(dataset.stamp(3) - dataset.stamp(0), 0.3, 1e-6);
    EXPECT_THAT(dataset.notes(), Contains(HasSubstr("topics left=/stereo/left/image_raw")));
    ASSERT_EQ(dataset.ground_truth().size(), static_cast<std::size_t>(kFrames));
    for (int k = 0; k < kFrames; ++k) {
      EXPECT_TRUE(dataset.ground_truth()[k].T.isApprox(pose(k), 1e-9));
    }
    const OdometrySummary s = summarize(run_odometry(dataset));
    EXPECT_EQ(s.ok, kFrames);
    EXPECT_LT(s.ate_first.max, 0.004);
  }

  std::string folder_;
};

TEST_F(RosBag, McapPlainAndInChunks) {
  for (const int per_chunk : {0, 1, 5, 1000}) {
    follow(write("a.mcap", test::mcap_of(stereo_messages(), per_chunk, "", plain, checksum)));
  }
  follow(folder_);  // the folder of a recorder
}

TEST_F(RosBag, CompressedImagesAndColour) {
  follow(write("a.mcap", test::mcap_of(stereo_messages("mono8", true), 4, "", plain, checksum)));
  follow(write("a.mcap", test::mcap_of(stereo_messages("rgb8"), 4, "", plain, checksum)));
}

#ifdef PROSPECT_WITH_LZ4
TEST_F(RosBag, ChunksByLz4) {
  const auto compress = [](const std::string& from) {
    std::string to(LZ4F_compressFrameBound(from.size(), nullptr), '\0');
    to.resize(LZ4F_compressFrame(to.data(), to.size(), from.data(), from.size(), nullptr));
    return to;
  };
  std::string bytes = test::mcap_of(stereo_messages(), 5, "lz4", compress, checksum);
  follow(write("a.mcap", bytes));
  bytes[bytes.size() / 2] ^= 0x55;
  EXPECT_THAT(refusal(write("a.mcap", bytes)), HasSubstr("expected an intact file"));
}
#endif

#ifdef PROSPECT_WITH_ZSTD
TEST_F(RosBag, ChunksByZstd) {
  const auto compress = [](const std::string& from) {
    std::string to(ZSTD_compressBound(from.size()), '\0');
    to.resize(ZSTD_compress(to.data(), to.size(), from.data(), from.size(), 1));
    return to;
  };
  follow(write("a.mcap", test::mcap_of(stereo_messages(), 5, "zstd", compress, checksum)));
}
#endif

TEST_F(RosBag, DamagedAndUnfinishedFiles) {
  const std::string bytes = test::mcap_of(stereo_messages(), 3, "", plain, checksum);
  // A recorder that was killed: what is there is read, and said to be all.
  std::string cut = bytes.substr(0, bytes.size() * 3 / 4);
  const std::string path = write("a.mcap", cut);
  const StereoDataset dataset = StereoDataset::open(path);
  EXPECT_LT(dataset.size(), kFrames);
  EXPECT_THAT(dataset.notes(), Contains(HasSubstr("ends early")));
  std::string flipped = bytes;
  flipped[bytes.size() / 2] ^= 1;
  EXPECT_THAT(refusal(write("a.mcap", flipped)), HasSubstr("wrong checksum"));
  EXPECT_THAT(refusal(write("a.mcap", "no bag at all")), HasSubstr("no MCAP file"));
  EXPECT_THAT(refusal(write("a.mcap", bytes.substr(0, 60))), HasSubstr("holds no message"));
  EXPECT_THAT(
      refusal(write("a.mcap", test::mcap_of(stereo_messages(), 3, "snappy", plain, checksum))),
      HasSubstr("compressed by 'snappy'; expected none, lz4 or zstd"));
  // Every prefix is read as far as it goes or refused in one line: no crash.
  for (std::size_t size = 0; size < 4000; size += 97) {
    refusal(write("a.mcap", bytes.substr(0, size)));
  }
  std::vector<BagMessage> messages = stereo_messages();
  messages[1].bytes.resize(200);
  EXPECT_THAT(refusal(write("a.mcap", test::mcap_of(messages, 3, "", plain, checksum))),
              HasSubstr("/stereo/left/image_raw message 0: the message ends early"));
}

#ifdef PROSPECT_WITH_ZSTD
std::string zstd_of(const std::string& from) {
  std::string to(ZSTD_compressBound(from.size()), '\0');
  to.resize(ZSTD_compress(to.data(), to.size(), from.data(), from.size(), 1));
  return to;
}

TEST_F(RosBag, FilesThatAreCompressedAsAWhole) {
#ifdef PROSPECT_WITH_LZ4
  const auto lz4 = [](const std::string& from) {
    std::string to(LZ4F_compressFrameBound(from.size(), nullptr), '\0');
    to.resize(LZ4F_compressFrame(to.data(), to.size(), from.data(), from.size(), nullptr));
    return to;
  };
  const std::string inside = test::mcap_of(stereo_messages(), 5, "lz4", lz4, checksum);
  follow(write("a.mcap.lz4", lz4(inside)));
  fs::remove(folder_ + "/a.mcap.lz4");
#else
  const std::string inside = test::mcap_of(stereo_messages(), 5, "", plain, checksum);
#endif
  // In two frames, as pzstd writes them.
  const std::size_t half = inside.size() / 2;
  const std::string packed = zstd_of(inside.substr(0, half)) + zstd_of(inside.substr(half));
  follow(write("a_0.mcap.zstd", packed));
  follow(folder_);
  write("a_0.mcap", inside);  // the same once more is not read twice
  follow(folder_);
  fs::remove(folder_ + "/a_0.mcap");
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{3}, packed.size() / 3, packed.size() - 1}) {
    EXPECT_THAT(refusal(write("a_0.mcap.zstd", packed.substr(0, size))),
                HasSubstr("a_0.mcap.zstd: cannot be decompressed; expected an intact file"));
  }
  EXPECT_THAT(refusal(write("b.db3.xz", packed)),
              HasSubstr("b.db3.xz: compressed as a whole by xz; expected .zstd, .lz4 or"));
}

TEST_F(RosBag, MessagesThatAreCompressedEach) {
  std::vector<BagMessage> messages = stereo_messages();
  for (BagMessage& m : messages) m.bytes = zstd_of(m.bytes);
  follow(write("a.mcap", test::mcap_of(messages, 3, "", plain, checksum)));
  messages[1].bytes.resize(messages[1].bytes.size() / 2);
  EXPECT_THAT(
      StereoDataset::open(write("a.mcap", test::mcap_of(messages, 3, "", plain, checksum))).notes(),
      Contains(HasSubstr("1 of 4 images of /stereo/left/image_raw left out: "
                         "/stereo/left/image_raw message 0: cannot be decompressed")));
}
#endif

TEST_F(RosBag, OneBadMessageIsLeftOutAndCounted) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto with_bad = [&](const std::string& topic, int which,
                            const std::function<void(BagMessage&)>& spoil) {
    std::vector<BagMessage> messages = stereo_messages();
    int n = 0;
    for (BagMessage& m : messages) {
      if (m.topic == topic && n++ == which) spoil(m);
    }
    return write("a.mcap", test::mcap_of(messages, 7, "", plain, checksum));
  };
  StereoDatasetOptions options;
  options.topics["truth"] = "/odom";
  const auto notes_of = [&](const std::string& path) {
    const StereoDataset dataset = StereoDataset::open(path, options);
    EXPECT_EQ(dataset.size(), kFrames);
    return dataset.notes();
  };
  EXPECT_THAT(notes_of(with_bad(
                  "/stereo/left/camera_info", 2,
                  [&](BagMessage& m) { m.bytes = info_message(kStart, 0.0, nan, 320, 240); })),
              Contains(HasSubstr("1 of 4 calibrations of /stereo/left/camera_info left out: "
                                 "/stereo/left/camera_info message 2: ")));
  for (const bool first : {false, true}) {
    for (const double bad : {nan, 0.0}) {
      const std::string path = with_bad("/odom", first ? 0 : 2, [&](BagMessage& m) {
        CdrWriter odometry;
        odometry.header(kStart + (first ? 0 : 200'000'000LL), "odom").text("base_link");
        odometry.doubles(std::vector<double>(7, bad)).doubles(std::vector<double>(78, 0.0));
        m.bytes = odometry.str();
      });
      EXPECT_THAT(notes_of(path), Contains(HasSubstr("1 of 4 poses of /odom left out: ")));
      EXPECT_EQ(StereoDataset::open(path, options).ground_truth().size(), 3u);
    }
  }
  const std::string tf = with_bad("/odom", 3, [&](BagMessage& m) {
    m = {"/tf", "tf2_msgs/msg/TFMessage", m.time,
         CdrWriter()
             .number(std::uint32_t{1})
             .header(m.time, "map")
             .text("base_link")
             .doubles(std::vector<double>(7, nan))
             .str()};
  });
  EXPECT_THAT(notes_of(tf), Contains(HasSubstr("1 of 2 transforms of TF left out: /tf message 0")));
  // Of images the pair: it is lost, with the reason.
  const OdometryRun run = run_odometry(StereoDataset::open(
      with_bad("/stereo/right/image_raw", 1, [](BagMessage& m) { m.bytes.resize(200); })));
  EXPECT_EQ(summarize(run).ok, kFrames - 1);
  EXPECT_THAT(run.notes,
              Contains(HasSubstr("/stereo/right/image_raw message 1: the message ends")));
}

/// A message of a bag with one of its fields changed.
template <ros::Message T>
void change(BagMessage& m, const std::function<void(T&)>& how) {
  const std::string before = m.bytes;  // whose views the message has
  T message = ros::from_cdr<T>(before, "m");
  how(message);
  m.bytes = ros::to_cdr(message);
}

TEST_F(RosBag, WhatChangesOnTheWayIsLeftOutAndCounted) {
  struct Row {
    std::string topic;
    int which;  // of its messages; -1: all
    std::function<void(BagMessage&)> change;
    std::string expected;  // among the notes
    std::size_t truth = kFrames;
    int pairs = kFrames;
  };
  const auto odometry = [](const std::function<void(ros::Odometry&)>& how) {
    return [how](BagMessage& m) { change<ros::Odometry>(m, how); };
  };
  const auto info = [](const std::function<void(ros::CameraInfo&)>& how) {
    return [how](BagMessage& m) { change<ros::CameraInfo>(m, how); };
  };
  const std::vector<Row> rows = {
      {"/stereo/left/image_raw", 1,
       [](BagMessage& m) {
         change<ros::Image>(m, [](ros::Image& image) { image.header.frame_id = "rear"; });
       },
       "1 of 4 images of /stereo/left/image_raw left out: /stereo/left/image_raw message 1: is of "
       "frame 'rear', before of 'left'",
       kFrames, kFrames - 1},
      {"/odom", 2, odometry([](ros::Odometry& m) { m.child_frame_id = "wheel"; }),
       "1 of 4 poses of /odom left out: /odom message 2: a pose of 'wheel', before of 'base_link'",
       kFrames - 1},
      {"/odom", 2, odometry([](ros::Odometry& m) { m.header.frame_id = "map"; }),
       "1 of 4 poses of /odom left out: /odom message 2: is of frame 'map', before of 'odom'",
       kFrames - 1},
      {"/odom", 0, odometry([](ros::Odometry& m) { m.pose.covariance[0] = -1.0; }),
       "1 of 4 poses of /odom left out: /odom message 0: a variance of -1 says", kFrames - 1},
      {"/odom", -1, odometry([](ros::Odometry& m) { m.header.stamp = {}; }),
       "/odom: 4 poses without a stamp: the time of recording stands for it"},
      {"/stereo/left/image_raw", 2,
       [](BagMessage& m) {
         change<ros::Image>(m, [](ros::Image& image) { image.header.stamp.sec -= 100; });
       },
       "/stereo/left/image_raw: 1 images stamped before what was recorded before, by up to ",
       kFrames, kFrames - 1},
      {"/stereo/right/camera_info", 0, info([](ros::CameraInfo& m) { m.k = {}, m.p = {}; }),
       "1 of 4 calibrations of /stereo/right/camera_info left out: /stereo/right/camera_info "
       "message 0: K and P are 0"},
      {"/tf_static", -1,
       [](BagMessage& m) {
         change<ros::TFMessage>(m, [](ros::TFMessage& tf) {
           tf.transforms.push_back(tf.transforms[0]);
           tf.transforms[0].transform.translation.x += 1.0;
         });
       },
       "TF: left in base_link is told to be fixed at two places; the newest counts"}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.expected);
    std::vector<BagMessage> messages = stereo_messages();
    int n = 0;
    for (BagMessage& m : messages) {
      if (m.topic == row.topic && (row.which < 0 || n++ == row.which)) row.change(m);
    }
    StereoDatasetOptions options;
    options.topics["truth"] = "/odom";
    const StereoDataset dataset = StereoDataset::open(
        write("a.mcap", test::mcap_of(messages, 7, "", plain, checksum)), options);
    EXPECT_THAT(dataset.notes(), Contains(HasSubstr(row.expected)));
    EXPECT_EQ(dataset.size(), row.pairs);
    EXPECT_EQ(dataset.ground_truth().size(), row.truth);
  }
}

TEST_F(RosBag, OtherPairsAreNamed) {
  std::vector<BagMessage> messages = stereo_messages();
  const std::size_t n = messages.size();
  for (std::size_t i = 0; i < n; ++i) {
    BagMessage m = messages[i];
    if (!m.topic.starts_with("/stereo")) continue;
    m.topic.replace(0, 7, "/rear");
    messages.push_back(m);
  }
  const StereoDataset dataset =
      StereoDataset::open(write("a.mcap", test::mcap_of(messages, 7, "", plain, checksum)));
  EXPECT_THAT(dataset.notes(),
              Contains(HasSubstr("by their names; not used: /rear/left/image_raw and "
                                 "/rear/right/image_raw")));
}

TEST_F(RosBag, MessagesInOtherEncodingsAreNamed) {
  std::string bytes = test::mcap_of(stereo_messages(), 0, "", plain, checksum);
  const std::string cdr = test::mcap_text("cdr"), other = test::mcap_text("pb3");
  // One topic: it is not taken for what its type says.
  const std::size_t left = bytes.find(cdr, bytes.find(test::mcap_text("/stereo/left/image_raw")));
  bytes.replace(left, cdr.size(), other);
  StereoDatasetOptions options;
  options.topics = {{"left", "/stereo/left/image_raw"}, {"right", "/stereo/right/image_raw"}};
  EXPECT_THAT(refusal(write("a.mcap", bytes), options),
              HasSubstr("is of type sensor_msgs/msg/Image in pb3, not cdr as of ROS 2"));
  EXPECT_THAT(refusal(folder_), HasSubstr("/stereo/left/image_raw (sensor_msgs/msg/Image in pb3"));
  for (std::size_t at = 0; (at = bytes.find(cdr, at)) != std::string::npos;) {
    bytes.replace(at, cdr.size(), other);
  }
  EXPECT_THAT(refusal(write("a.mcap", bytes)), HasSubstr("no message is in cdr"));
  Found found = Found::kUsable;
  const auto json = inspect_path(folder_, {}, {}, found);
  EXPECT_EQ(found, Found::kIncomplete);
  EXPECT_THAT(inspection_text(json), HasSubstr("of sensor_msgs/msg/Image in pb3"));
}

TEST_F(RosBag, ACalibrationThatChangesOnTheWayIsRefused) {
  std::vector<BagMessage> messages = stereo_messages();
  std::string* last = nullptr;
  for (BagMessage& m : messages) {
    if (m.topic == "/stereo/left/camera_info") last = &m.bytes;
  }
  ASSERT_NE(last, nullptr);
  *last = info_message(kStart, 0.0, 241.0, 320, 240);
  EXPECT_THAT(refusal(write("a.mcap", test::mcap_of(messages, 7, "", plain, checksum))),
              HasSubstr("/stereo/left/camera_info message " + std::to_string(kFrames - 1) +
                        ": another calibration than the first one's"));
}

TEST_F(RosBag, TopicsThatAreGivenOrMissing) {
  std::vector<BagMessage> messages = stereo_messages();
  for (BagMessage& m : messages) {
    if (m.topic == "/stereo/right/image_raw") m.topic = "/other/picture";
  }
  const std::string path = write("a.mcap", test::mcap_of(messages, 7, "", plain, checksum));
  EXPECT_THAT(refusal(path), HasSubstr("expected --topics left=TOPIC,right=TOPIC of: /tf_static"));
  StereoDatasetOptions options;
  options.topics = {{"left", "/stereo/left/image_raw"}, {"right", "/other/picture"}};
  EXPECT_THAT(refusal(path, options), HasSubstr("no camera_info beside /other/picture"));
  options.topics["right_info"] = "/stereo/right/camera_info";
  EXPECT_EQ(refusal(path, options), "accepted");
  options.topics["right"] = "/odom";
  EXPECT_THAT(refusal(path, options), HasSubstr("is of type nav_msgs/msg/Odometry"));
  options.topics["right"] = "/nothing";
  EXPECT_THAT(refusal(path, options), HasSubstr("has no topic /nothing"));
  Found found = Found::kUnknown;
  const auto json = inspect_path(path, {}, {}, found);
  EXPECT_EQ(found, Found::kIncomplete);
  write("a.mcap", test::mcap_of(stereo_messages(), 7, "", plain, checksum));
  const auto good = inspect_path(folder_, {}, {}, found);
  EXPECT_EQ(found, Found::kUsable) << good.dump(1);
  EXPECT_EQ(good["recordings"].size(), 1u);
}

TEST_F(RosBag, TopicsThatNothingWasRecordedOf) {
  // As a recorder writes what it listened to in vain: a schema and a channel, and no message.
  std::string bytes = test::mcap_of(stereo_messages(), 7, "", plain, checksum);
  const std::size_t after_head =
      8 + test::mcap_record(1, test::mcap_text("ros2") + test::mcap_text("test")).size();
  const auto insert = [&](int id, const std::string& topic, const std::string& type) {
    bytes.insert(
        after_head,
        test::mcap_record(3, test::le(id, 2) + test::mcap_text(type) + test::mcap_text("ros2msg") +
                                 test::mcap_text("")) +
            test::mcap_record(4, test::le(id, 2) + test::le(id, 2) + test::mcap_text(topic) +
                                     test::mcap_text("cdr") + test::le(0, 4)));
  };
  insert(900, "/rect/left/image", "sensor_msgs/msg/Image");
  insert(901, "/rect/right/image", "sensor_msgs/msg/Image");
  insert(902, "/rect/left/camera_info", "sensor_msgs/msg/CameraInfo");
  const std::string path = write("a.mcap", bytes);
  follow(path);
  StereoDatasetOptions options;
  options.topics = {{"left", "/rect/left/image"}, {"right", "/rect/right/image"}};
  EXPECT_THAT(refusal(path, options),
              HasSubstr("topic /rect/left/image holds no message; expected one of: "));
  options.topics = {{"left", "/stereo/left/image_raw"},
                    {"right", "/stereo/right/image_raw"},
                    {"left_info", "/rect/left/camera_info"}};
  EXPECT_THAT(refusal(path, options), HasSubstr("topic /rect/left/camera_info holds no message"));
  Found found = Found::kUnknown;
  EXPECT_THAT(inspection_text(inspect_path(path, {}, {}, found)),
              HasSubstr("/rect/left/image, 0 "));
  EXPECT_EQ(found, Found::kUsable);
}

#ifdef PROSPECT_WITH_SQLITE
TEST_F(RosBag, Database) {
  const std::string path = folder_ + "/a.db3";
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  const auto run = [&](const std::string& sql) {
    ASSERT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sql;
  };
  run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, "
      "serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)");
  run("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER "
      "NOT NULL, data BLOB NOT NULL)");
  std::vector<std::string> topics;
  for (const BagMessage& m : stereo_messages()) {
    std::size_t id = 0;
    while (id < topics.size() && topics[id] != m.topic) ++id;
    if (id == topics.size()) {
      topics.push_back(m.topic);
      run("INSERT INTO topics VALUES(" + std::to_string(id) + ",'" + m.topic + "','" + m.type +
          "','cdr','')");
    }
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(database, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)",
                       -1, &insert, nullptr);
    sqlite3_bind_int64(insert, 1, static_cast<std::int64_t>(id));
    sqlite3_bind_int64(insert, 2, m.time);
    sqlite3_bind_blob(insert, 3, m.bytes.data(), static_cast<int>(m.bytes.size()),
                      SQLITE_TRANSIENT);
    ASSERT_EQ(sqlite3_step(insert), SQLITE_DONE);
    sqlite3_finalize(insert);
  }
  sqlite3_close(database);
  follow(path);
  EXPECT_THAT(refusal(write("b.db3", "no database, but longer than its head would be")),
              HasSubstr("expected an intact database of rosbag2"));

  // A refusal amid the rows closes the database as well.
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  run("DELETE FROM topics WHERE id = 0");
  sqlite3_close(database);
  const sqlite3_int64 in_use = sqlite3_memory_used();
  EXPECT_THAT(refusal(path), HasSubstr("a message of no topic"));
  EXPECT_EQ(sqlite3_memory_used(), in_use);
}
#endif

TEST_F(RosBag, DepthImagesWithPoses) {
  const test::DepthRecording recording;
  std::vector<BagMessage> messages;
  const int n = 6;
  for (int k = 0; k < n; ++k) {
    const std::int64_t t = kStart + 100'000'000LL * k;
    const DepthImage image = recording.scene.render(recording.camera, recording.pose(k), 0.0015,
                                                    100 + static_cast<std::uint64_t>(k));
    std::string pixels;
    for (const float z : image.depth) {
      pixels +=
          test::le(std::isfinite(z) ? static_cast<std::uint64_t>(std::lround(z * 1000)) : 0, 2);
    }
    messages.push_back({"/camera/depth/image_rect_raw", "sensor_msgs/msg/Image", t,
                        image_message(t, "optical", 320, 240, "16UC1", pixels)});
    CdrWriter info;
    messages.push_back({"/camera/depth/camera_info", "sensor_msgs/msg/CameraInfo", t,
                        info_message(t, 0.0, 262.5, 320, 240)});
    if (k == 3) continue;  // no pose within a quarter of a second would be left out
    messages.push_back({"/pose", "geometry_msgs/msg/PoseStamped", t,
                        CdrWriter().header(t, "map").pose(recording.pose(k)).str()});
  }
  const std::string path = write("d.mcap", test::mcap_of(messages, 4, "", plain, checksum));
  const DepthDataset dataset = DepthDataset::open(path);
  EXPECT_EQ(dataset.size(), n);
  EXPECT_EQ(dataset.camera().fx, 262.5);
  EXPECT_EQ(dataset.depth_scale(), 1000.0);
  ASSERT_TRUE(dataset.has_poses());
  EXPECT_TRUE(dataset.pose(2).isApprox(recording.pose(2), 1e-9));
  // Between its neighbours.
  EXPECT_LT((dataset.pose(3).translation() - recording.pose(3).translation()).norm(), 0.01);
  EXPECT_NEAR(dataset.read(1).at(160, 200),
              recording.scene.render(recording.camera, recording.pose(1), 0.0015, 101).at(160, 200),
              0.001);
  // With a lidar in the bag, too, it is said which of the two is mapped.
  const test::LidarRecording lidar;
  for (const BagMessage& message : lidar.messages()) messages.push_back(message);
  const std::string both = write("both.mcap", test::mcap_of(messages, 4, "", plain, checksum));
  for (const bool scans : {false, true}) {
    DepthDatasetOptions options;
    if (scans) options.topics["scan"] = "/scan";
    Found found = Found::kUnknown;
    const auto json = inspect_path(both, {}, options, found);
    ASSERT_EQ(json["recordings"].size(), 2U);
    const auto& depth = json["recordings"][0];
    EXPECT_EQ(depth["kind"], "depth images");
    EXPECT_EQ(depth["used_by"].is_null(), scans);
    EXPECT_EQ(json["recordings"][1]["used_by"].is_null(), !scans);
    EXPECT_THAT(inspection_text(json), HasSubstr(scans ? "uses the scans, as --topics scan=TOPIC"
                                                       : "uses the depth images; with --topics"));
  }
}

TEST_F(RosBag, StereoPairIsMappedWhereThereIsNothingElse) {
  std::vector<BagMessage> messages = stereo_messages();
  const std::string pair = write("pair.mcap", test::mcap_of(messages, 4, "", plain, checksum));
  EXPECT_TRUE(is_used_for_stereo_depth(pair, {}));
  EXPECT_FALSE(is_used_for_stereo_depth(pair, {{"depth", "/stereo/left/image_raw"}}));
  StereoDatasetOptions options;
  options.fixed_frame = "";
  const DepthSource source = open_stereo_depth(pair, options);
  EXPECT_THAT(source.notes, Contains(HasSubstr("poses by the recording, of 4 of 4 frames")));
  ASSERT_EQ(source.poses.size(), static_cast<std::size_t>(kFrames));
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_TRUE(source.poses[static_cast<std::size_t>(k)].isApprox(pose(k), 1e-9));
  }
  EXPECT_EQ(source.images.read(2).kind, RawImage::Kind::kFloat);
  // The odometry does without the bag's poses, which are no truth.
  EXPECT_TRUE(StereoDataset::open(pair).ground_truth().empty());

  const test::LidarRecording lidar;
  for (const BagMessage& message : lidar.messages()) messages.push_back(message);
  const std::string both = write("both.mcap", test::mcap_of(messages, 4, "", plain, checksum));
  const std::map<std::string, std::string> chosen = {{"left", "/stereo/left/image_raw"},
                                                     {"right", "/stereo/right/image_raw"}};
  EXPECT_TRUE(is_used_for_scans(both, {}));
  EXPECT_FALSE(is_used_for_stereo_depth(both, {}));
  EXPECT_FALSE(is_used_for_scans(both, chosen));
  EXPECT_TRUE(is_used_for_stereo_depth(both, chosen));
}

TEST(RosMessages, ImagesOfOtherKinds) {
  // Big-endian, both the message and its pixels.
  std::string big("\0\0\0\0", 4);
  const auto be = [&](std::uint64_t value, int size) {
    while ((big.size() - 4) % static_cast<std::size_t>(size) != 0) big += '\0';
    const std::string little = test::le(value, size);
    big.append(little.rbegin(), little.rend());
  };
  be(5, 4), be(0, 4), be(2, 4), big += std::string("c\0", 2);
  be(1, 4), be(2, 4), be(7, 4), big += std::string("mono16\0", 7);
  be(1, 1), be(4, 4), be(4, 4), big += std::string("\x01\x02\x03\x04", 4);
  const RawImage image = read_ros_image(big, false, "m");
  EXPECT_EQ(image.number16(0), 0x0102);
  EXPECT_EQ(image.number16(1), 0x0304);
  EXPECT_EQ(read_ros_header(big, "m").stamp, 5.0);
  // One pixel of colour in each order; luma of the two kinds of 4:2:2.
  const auto first = [](const std::string& encoding, int width, const std::string& pixels) {
    const RawImage raw =
        read_ros_image(image_message(kStart, "c", width, 1, encoding, pixels), false, "m");
    return std::vector<int>(raw.bytes.begin(),
                            raw.bytes.begin() + std::min<std::ptrdiff_t>(3, std::ssize(raw.bytes)));
  };
  EXPECT_EQ(first("bgr8", 1, "\x01\x02\x03"), (std::vector<int>{1, 2, 3}));
  EXPECT_EQ(first("rgb8", 1, "\x01\x02\x03"), (std::vector<int>{3, 2, 1}));
  EXPECT_EQ(first("yuv422", 2, "\x01\x02\x03\x04"), (std::vector<int>{2, 4}));
  EXPECT_EQ(first("yuv422_yuy2", 2, "\x01\x02\x03\x04"), (std::vector<int>{1, 3}));
  EXPECT_THROW(first("bgr8", 2, "\x01\x02\x03"), InputError);
  EXPECT_THROW(first("hologram", 1, "\x01"), InputError);
  EXPECT_THROW(read_ros_image("", false, "m"), InputError);
  EXPECT_THROW(read_ros_camera_info(info_message(0, NAN, 1, 2, 2), "m"), InputError);
  // Every prefix of a message ends early, in one line.
  const std::string whole = info_message(kStart, 0.0, 240.0, 320, 240);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THROW(read_ros_camera_info(whole.substr(0, size), "m"), InputError) << size;
  }
  // The red pixel of a pattern is the one that is named first.
  std::string pattern(16 * 16, '\0');
  for (int v = 0; v < 16; v += 2) {
    for (int u = 0; u < 16; u += 2) pattern[static_cast<std::size_t>(16 * v + u)] = '\x7f';
  }
  const RawImage red =
      read_ros_image(image_message(kStart, "c", 16, 16, "bayer_rggb8", pattern), false, "m");
  ASSERT_EQ(red.channels, 3);
  const std::size_t middle = 3 * (16 * 8 + 8);
  EXPECT_EQ(red.bytes[middle + 2], 0x7f);
  EXPECT_EQ(red.bytes[middle], 0);
}

}  // namespace
}  // namespace prospect::ros_bag_test
