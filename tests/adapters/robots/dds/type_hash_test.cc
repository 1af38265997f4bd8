#include "adapters/robots/dds/type_hash.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "adapters/robots/dds/dds_names.h"

namespace prospect::type_hash_test {
namespace {

TEST(TypeHash, IsTheOneThatRos2Publishes) {
  const std::vector<std::pair<std::vector<ros::MessageDefinition>, std::string>> rows = {
      {ros::definition_of<ros::String>(),
       "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
      {ros::definition_of<ros::Header>(),
       "RIHS01_f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"},
      {ros::definition_of<ros::Image>(),
       "RIHS01_d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
      {ros::definition_of<ros::OccupancyGrid>(),
       "RIHS01_8d348150c12913a31ee0ec170fbf25089e4745d17035792a1ba94d6f0bc0cfc7"},
      {ros::definition_of<ros::MarkerArray>(),
       "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"}};
  for (const auto& [definition, hash] : rows) {
    EXPECT_EQ(type_hash(definition), hash) << definition.front().name;
  }
}

TEST(DdsNames, AreThoseOfRos2) {
  EXPECT_EQ(dds_topic("/left/image_raw"), "rt/left/image_raw");
  EXPECT_EQ(dds_type("sensor_msgs/msg/Image"), "sensor_msgs::msg::dds_::Image_");
  EXPECT_EQ(ros_type("sensor_msgs::msg::dds_::Image_"), "sensor_msgs/msg/Image");
  EXPECT_EQ(ros_type("Image"), "Image");
  for (const char* good : {"/a", "/left/image_raw", "/_x/y2"}) EXPECT_EQ(topic_problem(good), "");
  for (const char* bad : {"", "/", "a", "/a/", "/a//b", "/2a", "/a/2", "/a b", "/a.b"}) {
    EXPECT_NE(topic_problem(bad), "") << bad;
  }
}

}  // namespace
}  // namespace prospect::type_hash_test
