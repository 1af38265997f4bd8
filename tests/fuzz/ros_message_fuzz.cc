// SPDX-License-Identifier: Apache-2.0
// Messages of ROS 2, of the type that the first byte says.
#include "adapters/formats/datasets/elements.h"
#include "adapters/formats/datasets/ros_messages.h"
#include "tests/fuzz/fuzz_target.h"

using namespace prospect;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes = fuzz::text_of(data, size);
  if (size == 0) return 0;
  const std::string_view message = bytes.substr(1);
  fuzz::read_or_refuse([&] {
    Elements transforms("transforms");
    switch (data[0] % 7) {
      case 0:
        return static_cast<void>(read_ros_image(message, false, "message"));
      case 1:
        return static_cast<void>(read_ros_image(message, true, "message"));
      case 2:
        return static_cast<void>(read_ros_camera_info(message, "message"));
      case 3:
        return static_cast<void>(read_ros_transforms(message, "message", transforms));
      case 4:
        return static_cast<void>(read_ros_pose(message, "nav_msgs/msg/Odometry", "message"));
      case 5:
        return static_cast<void>(read_ros_motion(message, ros::Odometry::kType, "message"));
      default:
        return static_cast<void>(read_ros_header(message, "message"));
    }
  });
  return 0;
}
