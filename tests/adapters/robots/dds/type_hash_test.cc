// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/type_hash.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav2_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/rosgraph_msgs.h"
#include "adapters/formats/ros/sensor_msgs.h"
#include "adapters/formats/ros/std_srvs.h"
#include "adapters/formats/ros/tf2_msgs.h"
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
       "RIHS01_86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"},
      {ros::definition_of<ros::CameraInfo>(),
       "RIHS01_b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275"},
      {ros::definition_of<ros::CompressedImage>(),
       "RIHS01_15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"},
      {ros::definition_of<ros::LaserScan>(),
       "RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
      {ros::definition_of<ros::Imu>(),
       "RIHS01_7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b"},
      {ros::definition_of<ros::PointCloud2>(),
       "RIHS01_9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"},
      {ros::definition_of<ros::Odometry>(),
       "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"},
      {ros::definition_of<ros::PoseStamped>(),
       "RIHS01_10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8"},
      {ros::definition_of<ros::PoseWithCovarianceStamped>(),
       "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e"},
      {ros::definition_of<ros::TransformStamped>(),
       "RIHS01_0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"},
      {ros::definition_of<ros::TFMessage>(),
       "RIHS01_e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"},
      {ros::definition_of<ros::TwistStamped>(),
       "RIHS01_5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64"},
      {ros::definition_of<ros::Twist>(),
       "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
      {ros::definition_of<ros::DiagnosticStatus>(),
       "RIHS01_b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4"},
      {ros::definition_of<ros::DiagnosticArray>(),
       "RIHS01_5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e"},
      {ros::definition_of<ros::Clock>(),
       "RIHS01_692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564"},
      {ros::definition_of<ros::TriggerRequest>(),
       "RIHS01_d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199"},
      {ros::definition_of<ros::TriggerResponse>(),
       "RIHS01_2d946c21e2fc3f1e9ca6986a8191d85fcc70097a8bb7771a053564bc47009cdf"},
      {ros::definition_of<ros::GoalStatusArray>(),
       "RIHS01_6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e"},
      {ros::definition_of<ros::CancelGoalRequest>(),
       "RIHS01_3d3c84653c1f96918086887e1dcb236faec88b81a5b14fd4cf4840065bcdf8af"},
      {ros::definition_of<ros::CancelGoalResponse>(),
       "RIHS01_35e682cf3f510e83c70a82a4aac888496dedee56773bf9d8e5e0aa81f9e1c960"},
      {ros::definition_of<ros::NavigateToPoseSendGoalRequest>(),
       "RIHS01_e9381f2acfe9fa8c4838a277d0cde28a93c483564827b9f13496b9c2092e4f09"},
      {ros::definition_of<ros::NavigateToPoseSendGoalResponse>(),
       "RIHS01_99f97fcbb07daf024df4b8c3f02f19ce7fa3183fcedfb76b8772a61a371a55fa"},
      {ros::definition_of<ros::NavigateToPoseGetResultRequest>(),
       "RIHS01_106d3457cf0db4c4a8d3373bab3ff6aa8ba8ad99ae6392ce9784830a7d04ac93"},
      {ros::definition_of<ros::NavigateToPoseGetResultResponse>(),
       "RIHS01_c59f178c377de5318919c00bdbf7884cb3b185acfdffceba6c9f161e0aa3cc81"},
      {ros::definition_of<ros::NavigateToPoseFeedbackMessage>(),
       "RIHS01_2c1b4ec1a0e3a53c9aa326aabe717670eeef0ff3d4c3351ff940613b2011728a"},
      {ros::definition_of<ros::Bool>(),
       "RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9"}};
  for (const auto& [definition, hash] : rows) {
    EXPECT_EQ(type_hash(definition), hash) << definition.front().name;
  }
}

TEST(DdsNames, AreThoseOfRos2) {
  EXPECT_EQ(dds_topic("/left/image_raw"), "rt/left/image_raw");
  EXPECT_EQ(dds_requests("/prospect/hold"), "rq/prospect/holdRequest");
  EXPECT_EQ(dds_replies("/prospect/hold"), "rr/prospect/holdReply");
  EXPECT_EQ(dds_type("std_srvs/srv/Trigger_Request"), "std_srvs::srv::dds_::Trigger_Request_");
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
