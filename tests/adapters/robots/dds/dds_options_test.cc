// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "adapters/formats/files/input_error.h"

namespace prospect::dds_options_test {
namespace {

using ::testing::HasSubstr;

DdsOptions read(const std::string& text) {
  const std::string path = ::testing::TempDir() + "dds_options_test.yaml";
  std::ofstream(path) << text;
  return read_dds_options(path);
}
std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(DdsOptions, ReadsWhatIsGivenAndKeepsTheRest) {
  const DdsOptions o = read(
      "domain: 7\n"
      "frames: {base: base_footprint}\n"
      "stereo: {left: /cam/left, compressed: true}\n"
      "depth: {image: none}\n"
      "scan: /scan\n"
      "emergency_stop: /stop\n"
      "emergency_stop_age: 0.3\n"
      "emergency_stop_publishers: 2\n"
      "command: {stamped: none, plain: /cmd_vel, dead_man: 0.5, speed: 0.6, relay_age: arrival}\n"
      "output: {octomap: none}\n");
  EXPECT_EQ(o.address.domain, 7);
  EXPECT_EQ(o.frames.base, "base_footprint");
  EXPECT_EQ(o.frames.map, "map");
  EXPECT_EQ(o.stereo.left, "/cam/left");
  EXPECT_EQ(o.stereo.right, DdsOptions().stereo.right);
  EXPECT_TRUE(o.stereo.compressed);
  EXPECT_EQ(o.depth.image, "");
  EXPECT_EQ(o.depth.info, "");
  EXPECT_EQ(o.emergency_stop, "/stop");
  EXPECT_EQ(o.emergency_stop_contract.publishers, 2);
  EXPECT_EQ(o.emergency_stop_contract.max_age, 0.3);
  EXPECT_FALSE(o.emergency_stop_contract.latched);
  EXPECT_EQ(o.scan, "/scan");
  EXPECT_EQ(o.command.stamped, "");
  EXPECT_EQ(o.command.plain, "/cmd_vel");
  EXPECT_EQ(o.command.dead_man, 0.5);
  EXPECT_EQ(o.command.limits.speed, 0.6);
  EXPECT_FALSE(o.command.limits.yaw_rate.has_value());
  EXPECT_EQ(o.command.relay_age, DdsOptions::RelayAge::kArrival);
  EXPECT_EQ(DdsOptions().command.relay_age, DdsOptions::RelayAge::kStamp);
  EXPECT_EQ(o.output.octomap, "");
  EXPECT_EQ(o.output.map, "/map");
}

TEST(DdsOptions, DepthSensorsBesidesTheFirst) {
  const std::string rest = "command: {dead_man: 0.5}\n";
  const DdsOptions o = read(
      "more_depth: [{image: /rear/image_rect_raw, info: /rear/camera_info, max_range: 3},\n"
      " {scan: /scan_low}, {point_cloud: /points}]\n" +
      rest);
  ASSERT_EQ(o.more_depth.size(), 3u);
  EXPECT_EQ(o.more_depth[0].depth.image, "/rear/image_rect_raw");
  EXPECT_TRUE(o.more_depth[0].depth.rectified) << "by its name";
  EXPECT_EQ(o.more_depth[0].depth.max_range, 3.0);
  EXPECT_EQ(o.more_depth[1].scan, "/scan_low");
  EXPECT_EQ(o.more_depth[1].depth.image + o.more_depth[1].depth.info, "");
  EXPECT_EQ(o.more_depth[2].point_cloud, "/points");
  EXPECT_THAT(refusal("more_depth: [{}]\n" + rest), HasSubstr("expected one of them"));
  EXPECT_THAT(refusal("more_depth: [{scan: /a, point_cloud: /b}]\n" + rest),
              HasSubstr("expected one of them"));
  EXPECT_THAT(refusal("more_depth: [{image: /a}]\n" + rest), HasSubstr("expected a topic"));
  EXPECT_THAT(refusal("scan: /a\nmore_depth: [{scan: /a}]\n" + rest), HasSubstr("another meaning"));
  EXPECT_THAT(refusal("stereo: {right: none, right_info: none}\n" + rest),
              HasSubstr("one camera measures no depth"));
}

TEST(DdsOptions, ARobotMayBeInANamespace) {
  const std::string rest = "command: {dead_man: 0.5}\n";
  for (const char* name : {"a200/x", "/a200/x", "/a200/x/"}) {
    const DdsOptions o = read("namespace: " + std::string(name) +
                              "\nscan: sensors/scan\nodometry: /odom\n"
                              "output: {map: none, path: plan}\n" +
                              rest);
    EXPECT_EQ(o.tf, "/a200/x/tf");
    EXPECT_EQ(o.tf_static, "/a200/x/tf_static");
    EXPECT_EQ(o.stereo.left, "/a200/x/left/image_rect");
    EXPECT_EQ(o.scan, "/a200/x/sensors/scan");
    EXPECT_EQ(o.odometry, "/odom");
    EXPECT_EQ(o.command.stamped, "/a200/x/cmd_vel");
    EXPECT_EQ(o.command.plain, "");
    EXPECT_EQ(o.output.map, "");
    EXPECT_EQ(o.output.path, "/a200/x/plan");
  }
  const DdsOptions o = read("tf: /n/tf\ntf_static: /n/tf_static\n" + rest);
  EXPECT_EQ(o.tf, "/n/tf");
  EXPECT_EQ(o.tf_static, "/n/tf_static");
  EXPECT_EQ(o.odometry, "/odom");
  EXPECT_EQ(read(rest).tf, "/tf");
  EXPECT_THAT(refusal("namespace: a b\n" + rest), HasSubstr("yaml:1: namespace"));
  EXPECT_THAT(refusal("tf: none\n" + rest), HasSubstr("yaml:1: tf"));
}

TEST(DdsOptions, ARobotThatIsToldItsPoseNeedsNoCameras) {
  const std::string rest = "command: {dead_man: 0.5}\nscan: /scan\n";
  const DdsOptions tf = read("pose: {from: tf}\n" + rest);
  EXPECT_EQ(tf.pose_source, DdsOptions::PoseSource::kTf);
  EXPECT_FALSE(tf.has_stereo());
  EXPECT_TRUE(tf.tells_view());
  EXPECT_EQ(tf.stereo.left + tf.stereo.left_info + tf.stereo.right + tf.stereo.right_info, "");
  EXPECT_EQ(tf.depth.image + tf.depth.info, "");
  // Who localizes it says where odom is, and publishes a map of its own.
  EXPECT_FALSE(tf.output.transforms);
  EXPECT_EQ(tf.output.map, "/prospect/map");
  const DdsOptions topic = read(
      "frames: {base: base}\n"
      "pose: {from: topic, topic: /vicon/pose, type: PoseStamped, frame: marker, sigma: 0.002}\n"
      "output: {transforms: true, map: /map}\n"
      "depth: {image: /d/image}\n" +
      rest);
  EXPECT_EQ(topic.pose.topic, "/vicon/pose");
  EXPECT_EQ(topic.pose.type, "geometry_msgs/msg/PoseStamped");
  EXPECT_EQ(topic.pose.frame, "marker");
  EXPECT_EQ(topic.pose.sigma, 0.002);
  EXPECT_EQ(topic.depth.image, "/d/image");
  EXPECT_TRUE(topic.output.transforms);
  EXPECT_EQ(topic.output.map, "/map");
  EXPECT_EQ(read("frames: {base: b}\npose: {from: topic, topic: /p}\n" + rest).pose.frame, "b");
  EXPECT_EQ(tf.odometry, "/odom");
  EXPECT_EQ(read("pose: {from: tf}\nodometry: none\n" + rest).odometry, "") << "poses suffice";
  const DdsOptions camera = read("pose: {from: tf}\ncommand: {dead_man: 0.5}\n");
  EXPECT_EQ(camera.depth.image, DdsOptions().depth.image) << "a depth camera and a pose";
  EXPECT_TRUE(read(rest).has_stereo());
  const DdsOptions wheels = read("pose: {from: wheels}\ncommand: {dead_man: 0.5}\n");
  EXPECT_FALSE(wheels.has_stereo() || wheels.is_told_its_pose());
  EXPECT_EQ(wheels.depth.image, DdsOptions().depth.image);
  EXPECT_TRUE(wheels.output.transforms) << "nobody else says where odom is";
  EXPECT_EQ(wheels.output.map, "/map");
}

// Ranges come from something else, and what localizes it are not its features.
TEST(DdsOptions, OneCameraWithAPoseOfAnotherMeasuresNoRanges) {
  const std::string pose = "command: {dead_man: 0.5}\npose: {from: tf}\n";
  EXPECT_THAT(refusal(pose + "depth: {image: none}\n"),
              HasSubstr("nothing measures ranges; expected depth.image, scan or point_cloud"));
  const std::string camera = "stereo: {left: /camera/image_rect, right: none, right_info: none}\n";
  EXPECT_THAT(refusal(pose + camera + "scan: /scan\n"), HasSubstr("pose.from says that it is not"));
  EXPECT_THAT(refusal("command: {dead_man: 0.5}\n" + camera),
              HasSubstr("one camera measures no depth; expected its pair, or pose.from with what "
                        "measures ranges"));
  EXPECT_FALSE(read(pose + "scan: /scan\n").has_stereo());
}

TEST(DdsOptions, OfVelocitiesAloneNobodyKnowsWhereOdomIs) {
  const std::string rest = "command: {dead_man: 0.5}\nodometry_type: TwistStamped\n";
  EXPECT_EQ(read(rest).odometry_type, "geometry_msgs/msg/TwistStamped");
  EXPECT_FALSE(read(rest).output.transforms);
  EXPECT_TRUE(read(rest + "output: {transforms: true, odom_transform: true}\n").output.transforms);
  EXPECT_THAT(refusal(rest + "output: {transforms: true}\n"),
              HasSubstr("yaml:3: output.transforms: odometry tells no pose"));
  EXPECT_THAT(refusal("command: {dead_man: 0.5}\nodometry_type: Twist\n"),
              HasSubstr("expected one of: Odometry, TwistStamped, TwistWithCovarianceStamped"));
}

TEST(DdsOptions, NamesTheLineOfWhatIsWrong) {
  struct Row {
    const char *text, *expected;
  };
  const Row rows[] = {
      {"domain: 1\n", "command.dead_man"},
      {"command: {dead_man: 0.5}\ndoman: 1\n", "yaml:2: unknown key 'doman'"},
      {"command: {dead_man: 0.5}\nodometry: odom\n", "yaml:2: "},
      {"command: {dead_man: 0.5}\nodometry: odom\n", "expected a name of ROS 2"},
      {"command: {dead_man: 0.5}\nodometry: /cmd_vel\n", "has another meaning already"},
      {"command:\n  dead_man: 0.5\n  stamped: none\n", "yaml:3: "},
      {"command: {dead_man: 0}\n", "yaml:1: "},
      {"command: {dead_man: 0.5}\ndepth: {image: none}\n", "nothing measures ranges"},
      {"command: {dead_man: 0.5}\nscan: /s\npoint_cloud: /p\n", "expected one of them"},
      {"command: {dead_man: 0.5}\ndomain: 233\n", "yaml:2: "},
      {"command: {dead_man: 0.5}\nmounts: urdf\n", "yaml:2: "},
      {"command: {dead_man: 0.5}\nemergency_stop_age: 1\n", "there is no emergency_stop"},
      {"command: {dead_man: 0.5}\nemergency_stop: /s\nemergency_stop_age: .inf\n", "yaml:3: "},
      {"command: {dead_man: 0.5}\nemergency_stop: /s\nemergency_stop_publishers: 0\n", "yaml:3: "},
      {"command: {dead_man: 0.5}\npose: {from: tf}\nstereo: {left: /l}\n",
       "yaml:3: stereo: given, though"},
      {"command: {dead_man: 0.5}\npose: {from: topic}\n", "yaml:2: pose.from: no topic"},
      {"command: {dead_man: 0.5}\npose: {from: tf, topic: /p}\n", "yaml:2: pose.topic: from is tf"},
      {"command: {dead_man: 0.5}\npose: {from: tf, type: Odometry}\n", "yaml:2: pose.type: from"},
      {"command: {dead_man: 0.5}\npose: {topic: /p}\n", "yaml:2: pose.topic: from is stereo"},
      {"command: {dead_man: 0.5}\npose: {from: gps}\n",
       "expected one of: stereo, wheels, tf, topic"},
      {"command: {dead_man: 0.5}\npose: {from: tf}\noutput: {transforms: true}\n",
       "yaml:3: output.transforms: the pose comes from tf"},
      {"command: {dead_man: 0.5}\nodometry: none\n", "yaml:2: odometry: it is none"},
      {"command: {dead_man: 0.5}\npose: {from: wheels}\nodometry: none\n", "yaml:3: odometry: it"},
      {"command: {dead_man: 0.5}\npose: {from: tf}\nodometry: none\nodometry_frame: tf\n",
       "yaml:4: odometry_frame: there is no odometry"},
      {"command: {dead_man: 0.5}\npose: {from: topic, topic: /p}\nodometry: none\n"
       "output: {odom_transform: true}\n",
       "yaml:4: output.odom_transform: there is no odometry"},
      {"command: {dead_man: 0.5}\nframes: {base: \"\"}\n", "yaml:2: frames.base: it is empty"},
      {"command: {dead_man: 0.5}\nframes: {map: /a, base: a}\n",
       "yaml:2: frames.map: 'a' is frames.map and frames.base; expected two"},
      {"command: {dead_man: 0.5}\nframes: {base: odom}\n",
       "yaml:2: frames.base: 'odom' is frames."},
      {"command: {dead_man: 0.5}\nframes: {odom: map}\n", "yaml:2: frames.odom: 'map' is frames."},
      {"command: {dead_man: 0.5, relay_age: never}\n", "expected one of: stamp, arrival"},
  };
  for (const Row& row : rows) EXPECT_THAT(refusal(row.text), HasSubstr(row.expected)) << row.text;
  EXPECT_THAT(refusal("command: {dead_man: 0.5}\nodometry: /" + std::string(247, 'a') + "\n"),
              HasSubstr("yaml:2: odometry: 248 characters; expected at most 247"));
}

TEST(DdsOptions, OfTheSamplePackageAreRead) {
  const std::string config =
      std::string(PROSPECT_SOURCE_DIR) + "/share/ros2/prospect_robot/config/";
  const DdsOptions o = read_dds_options(config + "robot.yaml");
  EXPECT_EQ(o.command.relay, "/prospect/cmd_vel");
  EXPECT_TRUE(o.mounts_from_tf);
  EXPECT_FALSE(read_dds_options(config + "lidar.yaml").has_stereo());
}

}  // namespace
}  // namespace prospect::dds_options_test
