// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/message_fields.h"

#include <string_view>

#include "adapters/formats/ros/action_msgs.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/nav2_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/rosgraph_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/std_msgs.h"
#include "adapters/formats/ros/std_srvs.h"
#include "adapters/formats/ros/tf2_msgs.h"

namespace prospect {
namespace {

using enum FieldUse;

constexpr FieldRule kCameraInfo[] = {
    {"header.stamp.sec", kNotNeeded,
     "a calibration holds for all images; one that changes is told"},
    {"header.stamp.nanosec", kNotNeeded, "as its seconds"},
    {"header.frame_id", kUsed},
    {"height", kUsed},
    {"width", kUsed},
    {"distortion_model", kUsed},
    {"d", kUsed},
    {"k", kUsed},
    {"r", kUsed},
    {"p", kUsed},
    {"binning_x", kUsed},
    {"binning_y", kUsed},
    {"roi.x_offset", kUsed},
    {"roi.y_offset", kUsed},
    {"roi.height", kUsed},
    {"roi.width", kUsed},
    {"roi.do_rectify", kNotNeeded, "K and P of the window are the same either way"},
};

constexpr FieldRule kImage[] = {
    {"header.stamp.sec", kUsed},
    {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},
    {"height", kUsed},
    {"width", kUsed},
    {"encoding", kUsed},
    {"is_bigendian", kUsed},
    {"step", kUsed},
    {"data", kUsed},
};

constexpr FieldRule kLaserScan[] = {
    {"header.stamp.sec", kUsed}, {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},  {"angle_min", kUsed},
    {"angle_max", kChecked},     {"angle_increment", kUsed},
    {"time_increment", kUsed},   {"scan_time", kChecked},
    {"range_min", kUsed},        {"range_max", kUsed},
    {"ranges", kUsed},           {"intensities", kNotNeeded, "a range is a range, however bright"},
};

constexpr const char* kNoAttitude = "a turn is measured, no attitude";
constexpr FieldRule kImu[] = {
    {"header.stamp.sec", kUsed},
    {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},
    {"orientation.x", kNotNeeded, kNoAttitude},
    {"orientation.y", kNotNeeded, kNoAttitude},
    {"orientation.z", kNotNeeded, kNoAttitude},
    {"orientation.w", kNotNeeded, kNoAttitude},
    {"orientation_covariance", kNotNeeded, kNoAttitude},
    {"angular_velocity.x", kUsed},
    {"angular_velocity.y", kUsed},
    {"angular_velocity.z", kUsed},
    {"angular_velocity_covariance", kChecked},
    {"linear_acceleration.x", kUsed},
    {"linear_acceleration.y", kUsed},
    {"linear_acceleration.z", kUsed},
    {"linear_acceleration_covariance", kNotNeeded,
     "it tells a sensor that hangs from one that is well"},
};

constexpr FieldRule kPointCloud2[] = {
    {"header.stamp.sec", kUsed},
    {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},
    {"height", kUsed},
    {"width", kUsed},
    {"fields.name", kUsed},
    {"fields.offset", kUsed},
    {"fields.datatype", kUsed},
    {"fields.count", kRefused},
    {"is_bigendian", kRefused},
    {"point_step", kUsed},
    {"row_step", kUsed},
    {"data", kUsed},
    {"is_dense", kNotNeeded, "points that are not finite are left out either way"},
};

constexpr FieldRule kCompressedImage[] = {
    {"header.stamp.sec", kUsed},
    {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},
    {"format", kChecked},
    {"data", kUsed},
};

constexpr FieldRule kTransformStamped[] = {
    {"header.stamp.sec", kUsed},        {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},         {"child_frame_id", kUsed},
    {"transform.translation.x", kUsed}, {"transform.translation.y", kUsed},
    {"transform.translation.z", kUsed}, {"transform.rotation.x", kUsed},
    {"transform.rotation.y", kUsed},    {"transform.rotation.z", kUsed},
    {"transform.rotation.w", kUsed},
};

constexpr FieldRule kTransforms[] = {
    {"transforms.header.stamp.sec", kUsed},        {"transforms.header.stamp.nanosec", kUsed},
    {"transforms.header.frame_id", kUsed},         {"transforms.child_frame_id", kUsed},
    {"transforms.transform.translation.x", kUsed}, {"transforms.transform.translation.y", kUsed},
    {"transforms.transform.translation.z", kUsed}, {"transforms.transform.rotation.x", kUsed},
    {"transforms.transform.rotation.y", kUsed},    {"transforms.transform.rotation.z", kUsed},
    {"transforms.transform.rotation.w", kUsed},
};

constexpr FieldRule kPoseStamped[] = {
    {"header.stamp.sec", kUsed},   {"header.stamp.nanosec", kUsed}, {"header.frame_id", kUsed},
    {"pose.position.x", kUsed},    {"pose.position.y", kUsed},      {"pose.position.z", kUsed},
    {"pose.orientation.x", kUsed}, {"pose.orientation.y", kUsed},   {"pose.orientation.z", kUsed},
    {"pose.orientation.w", kUsed},
};

constexpr FieldRule kPoseWithCovarianceStamped[] = {
    {"header.stamp.sec", kUsed},        {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},         {"pose.pose.position.x", kUsed},
    {"pose.pose.position.y", kUsed},    {"pose.pose.position.z", kUsed},
    {"pose.pose.orientation.x", kUsed}, {"pose.pose.orientation.y", kUsed},
    {"pose.pose.orientation.z", kUsed}, {"pose.pose.orientation.w", kUsed},
    {"pose.covariance", kUsed},
};

constexpr FieldRule kOdometry[] = {
    {"header.stamp.sec", kUsed},        {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},         {"child_frame_id", kUsed},
    {"pose.pose.position.x", kUsed},    {"pose.pose.position.y", kUsed},
    {"pose.pose.position.z", kUsed},    {"pose.pose.orientation.x", kUsed},
    {"pose.pose.orientation.y", kUsed}, {"pose.pose.orientation.z", kUsed},
    {"pose.pose.orientation.w", kUsed}, {"pose.covariance", kUsed},
    {"twist.twist.linear.x", kUsed},    {"twist.twist.linear.y", kUsed},
    {"twist.twist.linear.z", kUsed},    {"twist.twist.angular.x", kUsed},
    {"twist.twist.angular.y", kUsed},   {"twist.twist.angular.z", kUsed},
    {"twist.covariance", kChecked},
};

constexpr FieldRule kTwistStamped[] = {
    {"header.stamp.sec", kUsed}, {"header.stamp.nanosec", kUsed}, {"header.frame_id", kUsed},
    {"twist.linear.x", kUsed},   {"twist.linear.y", kUsed},       {"twist.linear.z", kUsed},
    {"twist.angular.x", kUsed},  {"twist.angular.y", kUsed},      {"twist.angular.z", kUsed},
};

constexpr FieldRule kTwistWithCovarianceStamped[] = {
    {"header.stamp.sec", kUsed},      {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},       {"twist.twist.linear.x", kUsed},
    {"twist.twist.linear.y", kUsed},  {"twist.twist.linear.z", kUsed},
    {"twist.twist.angular.x", kUsed}, {"twist.twist.angular.y", kUsed},
    {"twist.twist.angular.z", kUsed}, {"twist.covariance", kChecked},
};

constexpr FieldRule kBool[] = {
    {"data", kUsed},
};

constexpr FieldRule kString[] = {
    {"data", kUsed},
};

constexpr FieldRule kNavigateToPose[] = {
    {"goal_id.uuid", kUsed},
    {"goal.pose.header.stamp.sec", kUsed},
    {"goal.pose.header.stamp.nanosec", kUsed},
    {"goal.pose.header.frame_id", kUsed},
    {"goal.pose.pose.position.x", kUsed},
    {"goal.pose.pose.position.y", kUsed},
    {"goal.pose.pose.position.z", kUsed},
    {"goal.pose.pose.orientation.x", kUsed},
    {"goal.pose.pose.orientation.y", kUsed},
    {"goal.pose.pose.orientation.z", kUsed},
    {"goal.pose.pose.orientation.w", kUsed},
    {"goal.behavior_tree", kRefused},
};

constexpr FieldRule kGetResult[] = {
    {"goal_id.uuid", kUsed},
};

constexpr FieldRule kCancelGoal[] = {
    {"goal_info.goal_id.uuid", kUsed},
    {"goal_info.stamp.sec", kUsed},
    {"goal_info.stamp.nanosec", kUsed},
};

constexpr FieldRule kTrigger[] = {
    {"structure_needs_at_least_one_member", kNotNeeded, "what is asked for is the service's name"},
};

constexpr FieldRule kClock[] = {
    {"clock.sec", kUsed},
    {"clock.nanosec", kUsed},
};

}  // namespace

std::span<const FieldRule> fields_of(const char* type) {
  const std::string_view name = type;
  if (name == ros::CameraInfo::kType) return kCameraInfo;
  if (name == ros::Image::kType) return kImage;
  if (name == ros::CompressedImage::kType) return kCompressedImage;
  if (name == ros::LaserScan::kType) return kLaserScan;
  if (name == ros::PointCloud2::kType) return kPointCloud2;
  if (name == ros::Imu::kType) return kImu;
  if (name == ros::TransformStamped::kType) return kTransformStamped;
  if (name == ros::TFMessage::kType) return kTransforms;
  if (name == ros::PoseStamped::kType) return kPoseStamped;
  if (name == ros::PoseWithCovarianceStamped::kType) return kPoseWithCovarianceStamped;
  if (name == ros::Odometry::kType) return kOdometry;
  if (name == ros::TwistStamped::kType) return kTwistStamped;
  if (name == ros::TwistWithCovarianceStamped::kType) return kTwistWithCovarianceStamped;
  if (name == ros::Bool::kType) return kBool;
  if (name == ros::String::kType) return kString;
  if (name == ros::Clock::kType) return kClock;
  if (name == ros::NavigateToPoseSendGoalRequest::kType) return kNavigateToPose;
  if (name == ros::NavigateToPoseGetResultRequest::kType) return kGetResult;
  if (name == ros::CancelGoalRequest::kType) return kCancelGoal;
  if (name == ros::TriggerRequest::kType) return kTrigger;
  return {};
}

}  // namespace prospect
