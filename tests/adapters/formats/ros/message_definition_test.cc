// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/ros/message_definition.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/std_msgs.h"

namespace prospect::message_definition_test {
namespace {

TEST(MessageDefinition, TextIsThatOfTheStandard) {
  const std::string line(80, '=');
  EXPECT_EQ(ros::definition_text(ros::definition_of<ros::OccupancyGrid>()),
            "std_msgs/Header header\n"
            "nav_msgs/MapMetaData info\n"
            "int8[] data\n" +
                line +
                "\nMSG: builtin_interfaces/Time\n"
                "int32 sec\n"
                "uint32 nanosec\n" +
                line +
                "\nMSG: geometry_msgs/Point\n"
                "float64 x\nfloat64 y\nfloat64 z\n" +
                line +
                "\nMSG: geometry_msgs/Pose\n"
                "geometry_msgs/Point position\n"
                "geometry_msgs/Quaternion orientation\n" +
                line +
                "\nMSG: geometry_msgs/Quaternion\n"
                "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n" +
                line +
                "\nMSG: nav_msgs/MapMetaData\n"
                "builtin_interfaces/Time map_load_time\n"
                "float32 resolution\n"
                "uint32 width\nuint32 height\n"
                "geometry_msgs/Pose origin\n" +
                line +
                "\nMSG: std_msgs/Header\n"
                "builtin_interfaces/Time stamp\n"
                "string frame_id\n");
  EXPECT_THAT(ros::definition_text(ros::definition_of<ros::DiagnosticArray>()),
              ::testing::HasSubstr("byte level\n"));
  EXPECT_THAT(ros::definition_text(ros::definition_of<ros::CameraInfo>()),
              ::testing::HasSubstr("float64[] d\nfloat64[9] k\n"));
}

TEST(MessageDefinition, TextThatIsHashed) {
  EXPECT_EQ(ros::hashed_text(ros::definition_of<ros::Header>()),
            "{\"type_description\": {\"type_name\": \"std_msgs/msg/Header\", \"fields\": ["
            "{\"name\": \"stamp\", \"type\": {\"type_id\": 1, \"capacity\": 0, "
            "\"string_capacity\": 0, \"nested_type_name\": \"builtin_interfaces/msg/Time\"}}, "
            "{\"name\": \"frame_id\", \"type\": {\"type_id\": 17, \"capacity\": 0, "
            "\"string_capacity\": 0, \"nested_type_name\": \"\"}}]}, "
            "\"referenced_type_descriptions\": ["
            "{\"type_name\": \"builtin_interfaces/msg/Time\", \"fields\": ["
            "{\"name\": \"sec\", \"type\": {\"type_id\": 6, \"capacity\": 0, "
            "\"string_capacity\": 0, \"nested_type_name\": \"\"}}, "
            "{\"name\": \"nanosec\", \"type\": {\"type_id\": 7, \"capacity\": 0, "
            "\"string_capacity\": 0, \"nested_type_name\": \"\"}}]}]}");
}

}  // namespace
}  // namespace prospect::message_definition_test
