// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_transforms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "adapters/formats/ros/tf2_msgs.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_transforms_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

/// A robot's state publisher at the other end.
class Publisher {
 public:
  Publisher() : node_(test::dds_test_address("state")) {
    fixed_ = node_.advertise<ros::TFMessage>("/robot/tf_static", kStaticTransformQos);
    moving_ = node_.advertise<ros::TFMessage>("/robot/tf", kTransformQos);
    node_.start();
  }
  void fixed(const std::string& parent, const std::string& child, double x) {
    node_.publish(fixed_, message(parent, child, x, 0.0));
  }
  void moving(const std::string& parent, const std::string& child, double x, double stamp) {
    node_.publish(moving_, message(parent, child, x, stamp));
  }

 private:
  static ros::TFMessage message(const std::string& parent, const std::string& child, double x,
                                double stamp) {
    ros::TransformStamped t;
    t.header = {ros::time_of(stamp), parent};
    t.child_frame_id = child;
    t.transform.translation.x = x;
    t.transform.rotation.w = 1.0;
    return {{t}};
  }
  DdsNode node_;
  int fixed_ = -1, moving_ = -1;
};

TEST(DdsTransforms, AHeadThatTurnsIsWhereItWasThen) {
  DdsNode node(test::dds_test_address("prospect"));
  DdsTransforms transforms(node, "/robot/tf", "/robot/tf_static");
  node.start();
  Publisher publisher;
  const auto known = [&](const char* from, double stamp) {
    return transforms.find("base_link", from, stamp).has_value();
  };
  EXPECT_FALSE(known("camera", 10.0));
  ASSERT_TRUE(within(
      kPatience, [&] { return known("camera", 10.0) && known("camera", 10.1); },
      [&] {
        publisher.fixed("head", "camera", 0.1);
        publisher.moving("base_link", "head", 1.0, 10.0);
        publisher.moving("base_link", "head", 2.0, 10.1);
      }));
  double x = transforms.find("base_link", "camera", 10.01)->translation().x();
  EXPECT_NEAR(x, 1.1, 1e-12);
  x = transforms.find("base_link", "camera", 10.25)->translation().x();
  EXPECT_NEAR(x, 2.1, 1e-12) << "the newest, while a newer one is under way";
  EXPECT_FALSE(known("camera", 10.5)) << "nobody has said where it is then";
  EXPECT_FALSE(known("camera", 9.5));
  EXPECT_FALSE(known("lidar", 10.0));
  EXPECT_NEAR(transforms.newest("base_link", "camera")->translation().x(), 2.1, 1e-12);

  transforms.hold("base_link", "camera");
  const auto ahead = [&] { return transforms.newest("base_link", "camera")->translation().x(); };
  EXPECT_EQ(transforms.moved(50.0), "");
  ASSERT_TRUE(within(
      kPatience, [&] { return ahead() > 2.11; },
      [&] { publisher.moving("base_link", "head", 2.05, 20.0); }));
  EXPECT_EQ(transforms.moved(50.1), "") << "one that is wrong among others decides nothing";
  ASSERT_TRUE(within(
      kPatience, [&] { return ahead() < 2.11; },
      [&] { publisher.moving("base_link", "head", 2.0, 20.1); }));
  EXPECT_EQ(transforms.moved(50.6), "");
  ASSERT_TRUE(within(
      kPatience, [&] { return ahead() > 2.11; },
      [&] { publisher.moving("base_link", "head", 2.05, 20.2); }));
  EXPECT_EQ(transforms.moved(50.7), "");
  EXPECT_THAT(transforms.moved(51.3), HasSubstr("'camera' has moved in 'base_link'"));
  EXPECT_FALSE(known("camera", 10.1)) << "what is long over is dropped";
}

}  // namespace
}  // namespace prospect::dds_transforms_test
