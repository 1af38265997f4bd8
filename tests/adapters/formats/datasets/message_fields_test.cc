#include "adapters/formats/datasets/message_fields.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <functional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect::message_fields_test {
namespace {

/// Visits the fields of a message by their full names, and gives one of them another value.
struct Alters {
  std::string target, prefix;
  std::set<std::string> names;
  std::vector<std::uint8_t> bytes;  // of the altered data

  template <ros::Message T>
  void operator()(const char* name, T& value) {
    const std::string above = prefix;
    prefix += std::string(name) + ".";
    T::fields(value, *this);
    prefix = above;
  }
  template <ros::Message T>
  void operator()(const char* name, std::vector<T>& values) {
    ASSERT_FALSE(values.empty()) << name;
    (*this)(name, values.front());
  }
  template <typename T>
  void operator()(const char* name, T& value) {
    const std::string full = prefix + name;
    EXPECT_TRUE(names.insert(full).second) << full;
    if (full == target) alter(value);
  }

  template <ros::detail::Plain T>
  void alter(T& value) {
    value = static_cast<T>(value + 1);
  }
  void alter(bool& value) { value = !value; }
  void alter(std::string& text) { text += "_"; }
  template <typename T, std::size_t N>
  void alter(std::array<T, N>& values) {
    values.front() += 1;
  }
  template <typename T>
  void alter(std::vector<T>& values) {
    values.front() += 1;
  }
  void alter(std::span<const std::uint8_t>& data) {
    bytes.assign(data.begin(), data.end());
    bytes[2] ^= 1U;  // of a float of an image or point a low bit, which is seen, too
    data = bytes;
  }
};

std::string text(const auto&... numbers) {
  std::ostringstream out;
  out.precision(17);
  ((out << +numbers << ' '), ...);
  return out.str();
}
std::string text_of(const auto& numbers) {
  std::string out;
  for (const auto n : numbers) out += text(n);
  return out;
}

/// What reading makes of a message, as text; what is wrong with it, if it is refused.
template <ros::Message T>
std::string outcome(const T& message,
                    const std::function<std::string(std::string_view cdr)>& read) {
  const std::string cdr = ros::to_cdr(message);
  try {
    const RosHeader header = read_ros_header(cdr, "m");
    const bool calibration = std::string(T::kType) == ros::CameraInfo::kType;
    return (calibration ? "" : text(header.stamp)) + header.frame + " " + read(cdr);
  } catch (const InputError& e) {
    return std::string("refused: ") + e.what();
  }
}

/// The table names each field once, and no other; and it is true: a field that is used or refused
/// makes a difference in one of the messages, one that is not needed in none.
template <ros::Message T>
void check(const std::vector<T>& messages,
           const std::function<std::string(std::string_view cdr)>& read) {
  std::set<std::string> listed;
  for (const MessageField& field : fields_of(T::kType)) {
    SCOPED_TRACE(std::string(T::kType) + " " + field.name);
    EXPECT_TRUE(listed.insert(field.name).second) << "listed twice";
    bool differs = false;
    for (T message : messages) {
      const std::string before = outcome(message, read);
      ASSERT_FALSE(before.starts_with("refused")) << before;
      Alters alters{field.name, "", {}, {}};
      T::fields(message, alters);
      const std::string after = outcome(message, read);
      differs = differs || after != before;
      if (field.use == FieldUse::kRefused) {
        EXPECT_TRUE(after.starts_with("refused")) << after;
      }
    }
    EXPECT_EQ(differs, field.use != FieldUse::kNotNeeded);
    EXPECT_EQ(std::strlen(field.why) > 0, field.use == FieldUse::kNotNeeded);
  }
  T message = messages.front();
  Alters alters;
  T::fields(message, alters);
  EXPECT_EQ(listed, alters.names) << T::kType;
}

TEST(MessageFields, OfCameraInfo) {
  ros::CameraInfo whole;
  whole.header.frame_id = "camera";
  whole.width = 640;
  whole.height = 480;
  whole.distortion_model = "plumb_bob";
  whole.d.assign(5, 0.1);
  whole.k = {400.0, 0.0, 320.0, 0.0, 400.0, 240.0, 0.0, 0.0, 1.0};
  whole.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  whole.p = {400.0, 0.0, 320.0, -48.0, 0.0, 400.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  ros::CameraInfo part = whole;
  part.binning_x = 1;
  part.binning_y = 2;
  part.roi = {40, 20, 200, 400, false};
  check<ros::CameraInfo>({whole, part}, [](std::string_view cdr) {
    const CameraInfo info = read_ros_camera_info(cdr, "m");
    return text(info.width, info.height) + info.model + text_of(info.D) + text_of(info.K) +
           text_of(info.R) + text_of(info.P);
  });
}

TEST(MessageFields, OfImage) {
  static constexpr std::array<std::uint8_t, 8> kPixels = {1, 2, 3, 4, 5, 6, 7, 8};
  ros::Image image;
  image.header.frame_id = "camera";
  image.width = image.height = 2;
  image.encoding = "mono16";
  image.step = 4;
  image.data = kPixels;
  check<ros::Image>({image}, [](std::string_view cdr) {
    const RawImage raw = read_ros_image(cdr, false, "m");
    return text(raw.width, raw.height, raw.channels) + text_of(raw.bytes);
  });
}

TEST(MessageFields, OfLaserScan) {
  ros::LaserScan scan;
  scan.header.frame_id = "lidar";
  scan.angle_increment = 0.1F;
  scan.angle_max = 0.1F;
  scan.range_min = 0.1F;
  scan.range_max = 9.0F;
  scan.ranges = {2.0F, 3.0F};
  scan.intensities = {1.0F, 2.0F};
  check<ros::LaserScan>({scan}, [](std::string_view cdr) {
    const RosLaserScan s = read_ros_laser_scan(cdr, "m");
    return text(s.angle_min, s.angle_increment, s.time_increment, s.range_min, s.range_max) +
           text_of(s.ranges);
  });
}

TEST(MessageFields, OfPointCloud2) {
  std::array<float, 6> points = {1.0F, 2.0F, 3.0F, 4.0F, 5.0F, 6.0F};
  std::vector<std::uint8_t> data(sizeof points);
  std::memcpy(data.data(), points.data(), sizeof points);
  ros::PointCloud2 cloud;
  cloud.header.frame_id = "lidar";
  cloud.height = 2;
  cloud.width = 1;
  cloud.point_fields = {{"x", 0, 7, 1}, {"y", 4, 7, 1}, {"z", 8, 7, 1}};
  cloud.point_step = cloud.row_step = 12;
  cloud.data = data;
  check<ros::PointCloud2>({cloud}, [](std::string_view cdr) {
    std::string out;
    for (const Eigen::Vector3d& p : read_ros_point_cloud(cdr, "m")) {
      out += text(p.x(), p.y(), p.z());
    }
    return out;
  });
}

/// As image_geometry: K and P shifted by the window's corner, then divided by the binning.
TEST(MessageFields, CalibrationOfAWindow) {
  ros::CameraInfo m;
  m.width = 640;
  m.height = 480;
  m.k = {400.0, 0.0, 321.0, 0.0, 408.0, 243.0, 0.0, 0.0, 1.0};
  m.p = {400.0, 0.0, 321.0, -48.0, 0.0, 408.0, 243.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  m.binning_x = 2;
  m.binning_y = 4;
  m.roi = {41, 23, 200, 402, true};
  const CameraInfo info = read_ros_camera_info(ros::to_cdr(m), "m");
  EXPECT_EQ(info.width, 201.0);
  EXPECT_EQ(info.height, 50.0);
  EXPECT_EQ(info.K, (std::vector<double>{200.0, 0.0, 140.0, 0.0, 102.0, 55.0, 0.0, 0.0, 1.0}));
  EXPECT_EQ(info.P, (std::vector<double>{200.0, 0.0, 140.0, -24.0, 0.0, 102.0, 55.0, 0.0, 0.0, 0.0,
                                         1.0, 0.0}));
  m.roi.width = 0;
  try {
    read_ros_camera_info(ros::to_cdr(m), "m");
    ADD_FAILURE() << "a window without a width";
  } catch (const InputError& e) {
    EXPECT_EQ(
        std::string(e.what()),
        "m: roi of 0 x 200 pixels at (41, 23); expected a size and where it is in the sensor, "
        "or all 0");
  }
}

}  // namespace
}  // namespace prospect::message_fields_test
