#include "adapters/formats/datasets/message_fields.h"

#include <string_view>

#include "adapters/formats/ros/sensor_msgs.h"

namespace prospect {
namespace {

using enum FieldUse;

constexpr MessageField kCameraInfo[] = {
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

constexpr MessageField kImage[] = {
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

constexpr MessageField kLaserScan[] = {
    {"header.stamp.sec", kUsed},
    {"header.stamp.nanosec", kUsed},
    {"header.frame_id", kUsed},
    {"angle_min", kUsed},
    {"angle_max", kNotNeeded, "follows from angle_min, angle_increment and the number of ranges"},
    {"angle_increment", kUsed},
    {"time_increment", kUsed},
    {"scan_time", kNotNeeded, "the stamps say when scans are"},
    {"range_min", kUsed},
    {"range_max", kUsed},
    {"ranges", kUsed},
    {"intensities", kNotNeeded, "a range is a range, however bright"},
};

constexpr MessageField kPointCloud2[] = {
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

}  // namespace

std::span<const MessageField> fields_of(const char* type) {
  const std::string_view name = type;
  if (name == ros::CameraInfo::kType) return kCameraInfo;
  if (name == ros::Image::kType) return kImage;
  if (name == ros::LaserScan::kType) return kLaserScan;
  if (name == ros::PointCloud2::kType) return kPointCloud2;
  return {};
}

}  // namespace prospect
