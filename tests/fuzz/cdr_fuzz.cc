// SPDX-License-Identifier: Apache-2.0
// CDR bytes as a message of the type that the first byte says, and what is made of scans and
// clouds. What is read is written and read again: the same bytes.
#include <array>

#include "adapters/formats/datasets/ros_scan_messages.h"
#include "adapters/formats/ros/cdr.h"
#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/geometry_msgs.h"
#include "adapters/formats/ros/map_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/octomap_msgs.h"
#include "adapters/formats/ros/rcl_interfaces.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

namespace {

template <ros::Message T>
void there_and_back(std::string_view cdr) {
  const std::string bytes = ros::to_cdr(ros::from_cdr<T>(cdr, "message"));
  if (ros::to_cdr(ros::from_cdr<T>(bytes, "message")) == bytes) return;
  std::fprintf(stderr, "%s: written and read again it is another\n", T::kType);
  std::abort();
}

void scan(std::string_view cdr) {
  const RosLaserScan scan = read_ros_laser_scan(cdr, "message");
  const DepthScan rays = rays_of(scan);
  if (rays.hits.size() + rays.misses.size() <= scan.ranges.size()) return;
  std::fputs("more rays than beams\n", stderr);
  std::abort();
}

// The corpus names them by their place.
constexpr std::array kReaders = {
    there_and_back<ros::Bool>,
    there_and_back<ros::String>,
    there_and_back<ros::Twist>,
    there_and_back<ros::TwistStamped>,
    there_and_back<ros::TransformStamped>,
    there_and_back<ros::PoseStamped>,
    there_and_back<ros::Image>,
    there_and_back<ros::CompressedImage>,
    there_and_back<ros::CameraInfo>,
    there_and_back<ros::LaserScan>,
    there_and_back<ros::PointCloud2>,
    there_and_back<ros::Odometry>,
    there_and_back<ros::Path>,
    there_and_back<ros::OccupancyGrid>,
    there_and_back<ros::OccupancyGridUpdate>,
    there_and_back<ros::TFMessage>,
    there_and_back<ros::DiagnosticArray>,
    there_and_back<ros::Octomap>,
    there_and_back<ros::Log>,
    there_and_back<ros::MarkerArray>,
    scan,
    +[](std::string_view cdr) { read_ros_point_cloud(cdr, "message"); },
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view message = fuzz::text_of(data, size).substr(1);
  fuzz::read_or_refuse([&] { kReaders[data[0] % kReaders.size()](message); });
  return 0;
}
