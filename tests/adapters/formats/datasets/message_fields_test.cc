// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/message_fields.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/images/image_codec.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/message_definition.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/rosgraph_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "tests/adapters/formats/altered_message.h"

namespace prospect::message_fields_test {
namespace {

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
std::string text_of(const RosTransform& t) {
  std::string out = text(t.stamp) + t.parent + " " + t.child + " ";
  for (int n = 0; n < 16; ++n) out += text(t.T.matrix()(n / 4, n % 4));
  for (int n = 0; n < 36; ++n) out += text(t.covariance(n / 6, n % 6));
  return out;
}
std::string text_of(const RosMotion& m) {
  return text(m.stamp, m.linear.x(), m.linear.y(), m.linear.z(), m.angular.x(), m.angular.y(),
              m.angular.z()) +
         m.frame;
}

/// With stamp and frame of its header.
std::string with_header(std::string_view cdr, const std::string& rest) {
  const RosHeader header = read_ros_header(cdr, "m");
  return text(header.stamp) + header.frame + " " + rest;
}

/// Holds the table against what reading makes of the bytes of messages.
template <ros::Message T>
void check(const std::vector<T>& messages,
           const std::function<std::string(std::string_view cdr)>& read) {
  test::expect_fields_of<T>(messages, [&](const T& message) {
    const std::string cdr = ros::to_cdr(message);
    try {
      return read(cdr);
    } catch (const InputError& e) {
      return std::string("refused: ") + e.what();
    }
  });
}

/// Whatever the readers of recordings and of DDS take from bytes stands in the tables.
TEST(MessageFields, OfAllTypesThatAreRead) {
  namespace fs = std::filesystem;
  const std::regex taken("(?:(?:from_cdr|subscribe|definition_of)<|serve<)ros::(\\w+)");
  std::set<std::string> types;
  for (const char* room : {"/adapters/formats/datasets", "/adapters/robots/dds"}) {
    for (const auto& entry : fs::directory_iterator(std::string(PROSPECT_SOURCE_DIR) + room)) {
      std::ifstream file(entry.path());
      std::stringstream source;
      source << file.rdbuf();
      const std::string code = source.str();
      for (std::sregex_iterator it(code.begin(), code.end(), taken), end; it != end; ++it) {
        types.insert((*it)[1]);
      }
    }
  }
  EXPECT_TRUE(types.contains("Odometry") && types.contains("Image")) << "the search finds them";
  types.erase("Header");  // in the others
  // Of services and actions.
  for (const auto& [name, full] : std::map<std::string, std::string>{
           {"TriggerRequest", "std_srvs/srv/Trigger_Request"},
           {"CancelGoalRequest", "action_msgs/srv/CancelGoal_Request"},
           {"NavigateToPoseSendGoalRequest", "nav2_msgs/action/NavigateToPose_SendGoal_Request"},
           {"NavigateToPoseGetResultRequest",
            "nav2_msgs/action/NavigateToPose_GetResult_Request"}}) {
    EXPECT_EQ(types.erase(name), 1u) << name;
    EXPECT_FALSE(fields_of(full.c_str()).empty()) << full;
  }
  for (const std::string& type : types) {
    bool known = false;
    for (const char* package : {"sensor_msgs/msg/", "geometry_msgs/msg/", "nav_msgs/msg/",
                                "tf2_msgs/msg/", "std_msgs/msg/", "rosgraph_msgs/msg/"}) {
      known = known || !fields_of((package + type).c_str()).empty();
    }
    EXPECT_TRUE(known) << type;
  }
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
    return read_ros_header(cdr, "m").frame + text(info.width, info.height) + info.model +
           text_of(info.D) + text_of(info.K) + text_of(info.R) + text_of(info.P);
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
    return with_header(cdr, text(raw.width, raw.height, raw.channels) + text_of(raw.bytes));
  });
}

TEST(MessageFields, OfCompressedImage) {
  const auto coded = [](const char* ending, int type) {
    return encode_pixels(ending, cv::Mat(2, 4, type, cv::Scalar(70)));
  };
  const std::vector<std::uint8_t> bmp = coded(".bmp", CV_8UC1), png = coded(".png", CV_16UC1);
  std::vector<std::uint8_t> depth(12, 0);
  depth.insert(depth.end(), png.begin(), png.end());
  ros::CompressedImage image, with_head;
  image.header.frame_id = with_head.header.frame_id = "camera";
  image.format = "bmp";
  image.data = bmp;
  with_head.format = "16UC1; compressedDepth";
  with_head.data = depth;
  check<ros::CompressedImage>({image, with_head}, [](std::string_view cdr) {
    const RawImage raw = read_ros_image(cdr, true, "m");
    return with_header(cdr, text(raw.width, raw.height, raw.channels) + text_of(raw.bytes));
  });
}

TEST(MessageFields, OfLaserScan) {
  ros::LaserScan scan;
  scan.header.frame_id = "lidar";
  scan.angle_increment = 0.1F;
  scan.angle_max = 0.1F;
  scan.scan_time = 0.1F;
  scan.range_min = 0.1F;
  scan.range_max = 9.0F;
  scan.ranges = {2.0F, 3.0F};
  scan.intensities = {1.0F, 2.0F};
  ros::LaserScan slow = scan;
  slow.time_increment = 11.0F;
  slow.scan_time = 2.0F;
  check<ros::LaserScan>({scan, slow}, [](std::string_view cdr) {
    const RosLaserScan s = read_ros_laser_scan(cdr, "m");
    return with_header(
        cdr, text(s.angle_min, s.angle_increment, s.time_increment, s.range_min, s.range_max) +
                 text_of(s.ranges));
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
    return with_header(cdr, out);
  });
}

TEST(MessageFields, OfImu) {
  ros::Imu imu;
  imu.header = {{5, 7}, "imu_link"};
  imu.angular_velocity = {1.0, 2.0, 3.0};
  imu.linear_acceleration = {4.0, 5.0, 6.0};
  check<ros::Imu>({imu}, [](std::string_view cdr) {
    const RosImu m = read_ros_imu(cdr, "m");
    const Eigen::Vector3d &w = m.sample.angular_velocity, &a = m.sample.linear_acceleration;
    return text(m.header.stamp, w.x(), w.y(), w.z(), a.x(), a.y(), a.z()) + m.header.frame;
  });
  imu.angular_velocity_covariance[0] = -1.0;
  EXPECT_THROW(read_ros_imu(ros::to_cdr(imu), "m"), InputError) << "it has no gyro";
  imu.angular_velocity_covariance[0] = 0.0;
  imu.angular_velocity.y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(read_ros_imu(ros::to_cdr(imu), "m"), InputError);
  imu.angular_velocity.y = 0.0;
  imu.header.stamp = {};
  EXPECT_THROW(read_ros_imu(ros::to_cdr(imu), "m"), InputError);
}

ros::TransformStamped transform() {
  ros::TransformStamped t;
  t.header = {{5, 7}, "odom"};
  t.child_frame_id = "base";
  t.transform.translation = {1.0, 2.0, 3.0};
  t.transform.rotation = {0.5, 0.5, 0.5, 0.5};
  return t;
}
ros::Pose pose() { return {{1.0, 2.0, 3.0}, {0.5, 0.5, 0.5, 0.5}}; }

TEST(MessageFields, OfPosesAndTransforms) {
  const auto pose_of = [](const char* type) {
    return [type](std::string_view cdr) { return text_of(read_ros_pose(cdr, type, "m")); };
  };
  check<ros::TransformStamped>({transform()}, pose_of(ros::TransformStamped::kType));
  check<ros::TFMessage>({{{transform()}}}, [](std::string_view cdr) {
    Elements elements("transforms");
    const std::vector<RosTransform> all = read_ros_transforms(cdr, "m", elements);
    if (elements.bad() > 0) {
      EXPECT_FALSE(is_known(all[0].T));
      throw InputError(elements.first());
    }
    return text_of(all[0]);
  });
  check<ros::PoseStamped>({{{{5, 7}, "map"}, pose()}}, pose_of(ros::PoseStamped::kType));
  ros::PoseWithCovarianceStamped with{{{5, 7}, "map"}, {pose(), {}}};
  with.pose.covariance[0] = 0.5;
  check<ros::PoseWithCovarianceStamped>({with}, pose_of(ros::PoseWithCovarianceStamped::kType));
}

TEST(MessageFields, OfOdometryAndTwists) {
  ros::Odometry odometry;
  odometry.header = {{5, 7}, "odom"};
  odometry.child_frame_id = "base";
  odometry.pose.pose = pose();
  odometry.twist.twist = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  check<ros::Odometry>({odometry}, [](std::string_view cdr) {
    return text_of(read_ros_pose(cdr, ros::Odometry::kType, "m")) +
           text_of(read_ros_motion(cdr, ros::Odometry::kType, "m"));
  });
  // A relay hands all of it on, whatever it is (CommandGate).
  check<ros::TwistStamped>({{{{5, 7}, "base"}, odometry.twist.twist}}, [](std::string_view cdr) {
    const auto m = ros::from_cdr<ros::TwistStamped>(cdr, "m");
    const ros::Twist& t = m.twist;
    return with_header(
        cdr, text(t.linear.x, t.linear.y, t.linear.z, t.angular.x, t.angular.y, t.angular.z));
  });
  // As odometry.
  const auto motion_of = [](const char* type) {
    return [type](std::string_view cdr) { return text_of(read_ros_motion(cdr, type, "m")); };
  };
  check<ros::TwistStamped>({{{{5, 7}, "base"}, odometry.twist.twist}},
                           motion_of(ros::TwistStamped::kType));
  check<ros::TwistWithCovarianceStamped>({{{{5, 7}, "base"}, odometry.twist}},
                                         motion_of(ros::TwistWithCovarianceStamped::kType));
}

TEST(MessageFields, OfBool) {
  check<ros::Bool>({{true}, {false}}, [](std::string_view cdr) {
    return text(ros::from_cdr<ros::Bool>(cdr, "m").data);
  });
}

TEST(MessageFields, OfStringAndClock) {
  check<ros::String>(
      {{"hold"}}, [](std::string_view cdr) { return ros::from_cdr<ros::String>(cdr, "m").data; });
  check<ros::Clock>({{{3, 5}}}, [](std::string_view cdr) {
    return text(ros::seconds(ros::from_cdr<ros::Clock>(cdr, "m").clock));
  });
}

/// By -1 or NaN filters say that they know nothing. Only the part that says so is refused.
TEST(MessageFields, VariancesThatSayThatNothingIsKnown) {
  for (const double none : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    for (const std::size_t n : {0, 7, 35}) {
      ros::Odometry m;
      m.pose.covariance[n] = none;
      EXPECT_THROW(read_ros_pose(ros::to_cdr(m), ros::Odometry::kType, "m"), InputError) << n;
      EXPECT_NO_THROW(read_ros_motion(ros::to_cdr(m), ros::Odometry::kType, "m")) << n;
      m = {};
      m.twist.covariance[n] = none;
      EXPECT_NO_THROW(read_ros_pose(ros::to_cdr(m), ros::Odometry::kType, "m")) << n;
      EXPECT_THROW(read_ros_motion(ros::to_cdr(m), ros::Odometry::kType, "m"), InputError) << n;
    }
  }
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
