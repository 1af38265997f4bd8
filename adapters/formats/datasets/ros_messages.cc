// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/ros_messages.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <utility>

#include "adapters/formats/datasets/camera_window.h"
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/number_text.h"
#include "adapters/formats/datasets/trajectory.h"
#include "adapters/formats/datasets/transform_tree.h"
#include "adapters/formats/files/input_error.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/std_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"

namespace prospect {
namespace {

struct RosEncoding {
  const char* name;
  int type;        ///< of OpenCV
  int conversion;  ///< of OpenCV, to blue, green, red or grey; -1: none
};
constexpr RosEncoding kRosEncodings[] = {
    {"mono8", CV_8UC1, -1},
    {"8UC1", CV_8UC1, -1},
    {"mono16", CV_16UC1, -1},
    {"16UC1", CV_16UC1, -1},
    {"32FC1", CV_32FC1, -1},
    {"bgr8", CV_8UC3, -1},
    {"8UC3", CV_8UC3, -1},
    {"rgb8", CV_8UC3, cv::COLOR_RGB2BGR},
    {"bgra8", CV_8UC4, -1},
    {"rgba8", CV_8UC4, cv::COLOR_RGBA2BGRA},
    {"bgr16", CV_16UC3, -1},
    {"rgb16", CV_16UC3, cv::COLOR_RGB2BGR},
    // OpenCV names a pattern by its second row's second and third pixel.
    {"bayer_rggb8", CV_8UC1, cv::COLOR_BayerBG2BGR},
    {"bayer_bggr8", CV_8UC1, cv::COLOR_BayerRG2BGR},
    {"bayer_gbrg8", CV_8UC1, cv::COLOR_BayerGR2BGR},
    {"bayer_grbg8", CV_8UC1, cv::COLOR_BayerGB2BGR},
    {"yuv422", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    {"uyvy", CV_8UC2, cv::COLOR_YUV2GRAY_UYVY},
    {"yuv422_yuy2", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2},
    {"yuyv", CV_8UC2, cv::COLOR_YUV2GRAY_YUY2}};

Eigen::Quaterniond quaternion_of(const ros::Quaternion& q) { return {q.w, q.x, q.y, q.z}; }
Eigen::Isometry3d isometry_of(const ros::Pose& pose, const std::string& name) {
  return checked_pose({pose.position.x, pose.position.y, pose.position.z},
                      quaternion_of(pose.orientation), name);
}

/// By -1 in front filters and trackers say that they know nothing; NaN says no more.
void check_variances(std::span<const double> covariance, std::initializer_list<std::size_t> of,
                     const char* what, const std::string& name) {
  for (const std::size_t n : of) {
    if (covariance[n] >= 0.0) continue;
    throw InputError(name + ": a variance of " + number_text(covariance[n]) + " says that " + what +
                     " is not known; expected none below 0");
  }
}

constexpr std::initializer_list<std::size_t> kPlanar = {0, 7, 35};  // x, y and yaw of six

RosTransform with_covariance(const ros::Header& header, const std::string& child,
                             const ros::PoseWithCovariance& pose, const std::string& name) {
  check_variances(pose.covariance, kPlanar, "the pose", name);
  RosTransform out{ros::seconds(header.stamp), header.frame_id, child,
                   isometry_of(pose.pose, name)};
  out.covariance =
      Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(pose.covariance.data());
  return out;
}

RosMotion motion_of(const ros::Header& header, const std::string& frame, const ros::Twist& twist,
                    const std::string& name) {
  RosMotion out{ros::seconds(header.stamp),
                frame,
                {twist.linear.x, twist.linear.y, twist.linear.z},
                {twist.angular.x, twist.angular.y, twist.angular.z}};
  if (!out.linear.allFinite() || !out.angular.allFinite()) {
    throw InputError(name + ": not a motion; expected finite numbers");
  }
  return out;
}

RosTransform transform_of(const ros::TransformStamped& m, const std::string& name) {
  if (without_slash(m.header.frame_id).empty() || without_slash(m.child_frame_id).empty()) {
    throw InputError(name + ": a transform from '" + m.child_frame_id + "' to '" +
                     m.header.frame_id + "'; expected names of frames");
  }
  const ros::Vector3& at = m.transform.translation;
  return {ros::seconds(m.header.stamp), m.header.frame_id, m.child_frame_id,
          checked_pose({at.x, at.y, at.z}, quaternion_of(m.transform.rotation), name)};
}

std::string_view view_of(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

RosHeader read_ros_header(std::string_view cdr, const std::string& name) {
  const auto header = ros::from_cdr<ros::Header>(cdr, name);
  return {ros::seconds(header.stamp), header.frame_id};
}

RawImage read_ros_image(std::string_view cdr, bool compressed, const std::string& name) {
  if (compressed) {
    const auto message = ros::from_cdr<ros::CompressedImage>(cdr, name);
    const std::string& format = message.format;
    std::string_view data = view_of(message.data);
    if (format.find("compressedDepth") != std::string::npos) {
      if (format.find("rvl") != std::string::npos) {
        throw InputError(name + ": depth compressed by RVL; expected PNG");
      }
      if (format.find("32FC1") != std::string::npos) {
        throw InputError(name + ": compressed depth of floats; expected 16UC1");
      }
    }
    // compressed_depth_image_transport puts a head of twelve bytes before the PNG, and not all that
    // write it say so in `format`.
    constexpr std::string_view kPng = "\x89PNG";
    constexpr std::size_t kHead = 12;
    if (data.size() > kHead && data.substr(kHead).starts_with(kPng)) data.remove_prefix(kHead);
    return decode_image(data, name);
  }
  const auto message = ros::from_cdr<ros::Image>(cdr, name);
  const auto height = message.height, width = message.width, step = message.step;
  const std::string& encoding = message.encoding;
  const bool big_endian = message.is_bigendian != 0;
  const std::string_view data = view_of(message.data);
  const RosEncoding* known = nullptr;
  std::string names;
  for (const RosEncoding& one : kRosEncodings) {
    if (encoding == one.name) known = &one;
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  }
  if (known == nullptr) {
    throw InputError(name + ": images in encoding '" + encoding + "'; expected one of: " + names);
  }
  const auto pixel = static_cast<std::uint64_t>(CV_ELEM_SIZE(known->type));
  if (width < 1 || height < 1 || width > 100'000 || height > 100'000 || step < width * pixel ||
      data.size() < std::uint64_t{step} * (height - 1) + width * pixel) {
    throw InputError(name + ": an image of " + std::to_string(width) + " x " +
                     std::to_string(height) + " pixels in " + std::to_string(data.size()) +
                     " bytes; expected all of its rows");
  }
  cv::Mat image(static_cast<int>(height), static_cast<int>(width), known->type,
                const_cast<char*>(data.data()), step);
  if (known->conversion >= 0) {
    cv::Mat converted;
    cv::cvtColor(image, converted, known->conversion);
    image = converted;
  }
  RawImage raw;
  raw.width = image.cols;
  raw.height = image.rows;
  raw.channels = image.channels();
  raw.kind = image.depth() == CV_8U    ? RawImage::Kind::k8
             : image.depth() == CV_16U ? RawImage::Kind::k16
                                       : RawImage::Kind::kFloat;
  const std::size_t row = image.elemSize() * static_cast<std::size_t>(image.cols);
  raw.bytes.resize(row * static_cast<std::size_t>(image.rows));
  for (int v = 0; v < image.rows; ++v) {
    std::memcpy(raw.bytes.data() + static_cast<std::size_t>(v) * row, image.ptr(v), row);
  }
  if (big_endian && raw.kind != RawImage::Kind::k8) {
    const auto size = static_cast<std::size_t>(raw.bytes_per_number());
    for (std::size_t i = 0; i + size <= raw.bytes.size(); i += size) {
      std::reverse(raw.bytes.begin() + static_cast<std::ptrdiff_t>(i),
                   raw.bytes.begin() + static_cast<std::ptrdiff_t>(i + size));
    }
  }
  return raw;
}

CameraInfo read_ros_camera_info(std::string_view cdr, const std::string& name) {
  const auto message = ros::from_cdr<ros::CameraInfo>(cdr, name);
  CameraInfo info;
  info.height = message.height;
  info.width = message.width;
  info.model = message.distortion_model;
  info.D = message.d;
  info.K.assign(message.k.begin(), message.k.end());
  info.R.assign(message.r.begin(), message.r.end());
  info.P.assign(message.p.begin(), message.p.end());
  if (info.K[0] == 0.0 && info.P[0] == 0.0) {
    throw InputError(name +
                     ": K and P are 0, by which a camera says that it is not calibrated; expected "
                     "a calibration");
  }
  for (const auto* numbers : {&info.D, &info.K, &info.R, &info.P}) {
    for (const double value : *numbers) {
      if (!std::isfinite(value)) {
        throw InputError(name + ": a calibration that is not finite; expected numbers");
      }
    }
  }
  const ros::RegionOfInterest& roi = message.roi;
  const auto number = [](std::uint32_t n) { return static_cast<double>(n); };
  return of_images(std::move(info),
                   {number(message.binning_x), number(message.binning_y), number(roi.x_offset),
                    number(roi.y_offset), number(roi.width), number(roi.height)},
                   name);
}

std::vector<RosTransform> read_ros_transforms(std::string_view cdr, const std::string& name,
                                              Elements& transforms) {
  std::vector<RosTransform> out;
  ros::TFMessage message;
  try {
    message = ros::from_cdr<ros::TFMessage>(cdr, name);
  } catch (const InputError& error) {
    transforms.read([&] { throw InputError(error); });
    return out;
  }
  for (const ros::TransformStamped& one : message.transforms) {
    out.push_back(
        {ros::seconds(one.header.stamp), one.header.frame_id, one.child_frame_id, unknown_pose()});
    transforms.read([&] { out.back() = transform_of(one, name); });
  }
  return out;
}

bool is_ros_pose(const std::string& type) {
  return type == ros::Odometry::kType || type == ros::PoseStamped::kType ||
         type == ros::PoseWithCovarianceStamped::kType || type == ros::TransformStamped::kType;
}

RosTransform read_ros_pose(std::string_view cdr, const std::string& type, const std::string& name) {
  if (type == ros::TransformStamped::kType) {
    return transform_of(ros::from_cdr<ros::TransformStamped>(cdr, name), name);
  }
  if (type == ros::PoseStamped::kType) {
    const auto m = ros::from_cdr<ros::PoseStamped>(cdr, name);
    return {ros::seconds(m.header.stamp), m.header.frame_id, "", isometry_of(m.pose, name)};
  }
  if (type == ros::PoseWithCovarianceStamped::kType) {
    const auto m = ros::from_cdr<ros::PoseWithCovarianceStamped>(cdr, name);
    return with_covariance(m.header, "", m.pose, name);
  }
  const auto m = ros::from_cdr<ros::Odometry>(cdr, name);
  return with_covariance(m.header, m.child_frame_id, m.pose, name);
}

RosMotion read_ros_motion(std::string_view cdr, const std::string& type, const std::string& name) {
  if (type == ros::TwistStamped::kType) {
    const auto m = ros::from_cdr<ros::TwistStamped>(cdr, name);
    return motion_of(m.header, m.header.frame_id, m.twist, name);
  }
  if (type == ros::TwistWithCovarianceStamped::kType) {
    const auto m = ros::from_cdr<ros::TwistWithCovarianceStamped>(cdr, name);
    check_variances(m.twist.covariance, kPlanar, "the motion", name);
    return motion_of(m.header, m.header.frame_id, m.twist.twist, name);
  }
  const auto m = ros::from_cdr<ros::Odometry>(cdr, name);
  check_variances(m.twist.covariance, kPlanar, "the motion", name);
  return motion_of(m.header, m.child_frame_id, m.twist.twist, name);
}

RosImu read_ros_imu(std::string_view cdr, const std::string& name) {
  const auto m = ros::from_cdr<ros::Imu>(cdr, name);
  const RosHeader header{ros::seconds(m.header.stamp), m.header.frame_id};
  const ros::Vector3 &w = m.angular_velocity, &a = m.linear_acceleration;
  const ImuSample sample{header.stamp, {w.x, w.y, w.z}, {a.x, a.y, a.z}};
  if (!(header.stamp > 0.0)) {
    throw InputError(name + ": a sample without a stamp; expected the time of its measurement");
  }
  if (!sample.finite()) {
    throw InputError(name + ": a sample that is not finite; expected numbers");
  }
  check_variances(m.angular_velocity_covariance, {0, 4, 8}, "the turn", name);
  return {header, sample};
}

}  // namespace prospect
