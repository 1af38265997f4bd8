// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/dds/dds_publisher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "adapters/formats/ros/diagnostic_msgs.h"
#include "adapters/formats/ros/nav_msgs.h"
#include "adapters/formats/ros/octomap_msgs.h"
#include "adapters/formats/ros/tf2_msgs.h"
#include "adapters/formats/ros/visualization_msgs.h"
#include "adapters/formats/worlds/octree_file.h"
#include "engine/planner/planner.h"
#include "models/unicycle.h"
#include "tests/adapters/dds_pair.h"

namespace prospect::dds_publisher_test {
namespace {

using test::kPatience;
using test::within;
using ::testing::HasSubstr;

/// The newest message of each topic.
class Listener {
 public:
  explicit Listener(const DdsOptions::Output& o) : node_(test::dds_test_address("rviz")) {
    hear<ros::Path>(o.path, kReliableQos);
    hear<ros::OccupancyGrid>(o.map, kLatchedQos);
    hear<ros::Octomap>(o.octomap, kLatchedQos);
    hear<ros::MarkerArray>(o.markers, kReliableQos);
    hear<ros::DiagnosticArray>(o.diagnostics, kReliableQos);
    hear<ros::TFMessage>("/tf", kTransformQos);
    odometry_ = node_.advertise<ros::Odometry>("/odom", kReliableQos);
    node_.start();
  }
  bool has_all() {
    const std::lock_guard lock(mutex_);
    return newest_.size() == 6;
  }
  /// At (1, 0), looking ahead.
  void odometry() {
    ros::Odometry m;
    m.header.stamp = {5, 0};
    m.child_frame_id = "base_link";
    m.pose.pose.position.x = 1.0;
    node_.publish(odometry_, m);
  }
  /// Its views are of bytes that are kept here.
  template <typename T>
  T newest(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return ros::from_cdr<T>(newest_.at(topic), topic);
  }

 private:
  template <typename T>
  void hear(const std::string& topic, const DdsQos& qos) {
    node_.subscribe(topic, ros::definition_of<T>(), qos,
                    [this](std::string_view cdr, const std::string& name) {
                      const std::lock_guard lock(mutex_);
                      newest_[name] = cdr;
                    });
  }
  std::mutex mutex_;
  std::map<std::string, std::string> newest_;
  DdsNode node_;  // its thread ends first
  int odometry_ = -1;
};

TEST(DdsPublisher, TellsTheOtherNodesWhatTheMissionDoes) {
  DdsOptions options;
  options.command.dead_man = 0.5;
  options.output.map_period = 0.1;
  options.output.odom_transform = true;
  const SteadyClock clock;
  DdsNode node(test::dds_test_address("prospect"));
  const DdsTransforms transforms(node);
  const DdsBase base(options, node, transforms, clock);
  const auto model = std::make_shared<const Unicycle>();
  DriveRequests requests;
  DdsPublisher publisher(options, node, base, clock, model, requests);
  node.start();

  Belief belief;
  belief.set_stamps(clock.now());
  belief.pose = {{2.0, 3.0, 0.0}, M_PI_2};
  auto tree = std::make_shared<octomap::OcTree>(0.1);
  tree->updateNode(octomap::point3d(0.05F, 0.05F, 0.05F), true);
  tree->updateNode(octomap::point3d(0.35F, 0.05F, 0.05F), false);
  tree->updateInnerOccupancy();
  belief.octree = tree;
  auto ground = std::make_shared<GroundMap>(GridFrame{0.1, -16, 0, 16, 16});
  ground->set({-16, 0}, CellState::kOccupied);
  ground->set({-15, 1}, CellState::kFree);
  belief.ground = ground;
  auto landmarks = std::make_shared<LandmarkMap>();
  landmarks->landmarks.resize(3);
  belief.landmarks = landmarks;
  Plan plan;
  plan.stamp = belief.stamp;
  plan.why = "exploring";
  plan.kind = PlanKind::kOptimised;
  plan.goal = Goal{{4.0, 5.0}, 0.0};
  plan.states = {Eigen::Vector3d(2.0, 3.0, 0.0), Eigen::Vector3d(2.0, 3.5, 0.0)};
  MissionStep step;
  step.belief = &belief;
  step.plan = &plan;

  Listener listener(options.output);
  ASSERT_TRUE(within(
      kPatience, [&] { return listener.has_all(); },
      [&] {
        listener.odometry();
        publisher.on_belief(belief);
        publisher.on_step(step);
      }));
  const auto path = listener.newest<ros::Path>(options.output.path);
  EXPECT_EQ(path.header.frame_id, "map");
  ASSERT_EQ(path.poses.size(), 2u);
  EXPECT_EQ(path.poses[1].pose.position.y, 3.5);
  EXPECT_NEAR(ros::seconds(path.poses[1].header.stamp) - ros::seconds(path.header.stamp), plan.dt,
              1e-6);

  const auto grid = listener.newest<ros::OccupancyGrid>(options.output.map);
  EXPECT_EQ(grid.info.width, 16u);
  EXPECT_NEAR(grid.info.origin.position.x, -1.6, 1e-12);
  ASSERT_EQ(grid.data.size(), 256u);
  EXPECT_EQ(grid.data[0], 100);
  EXPECT_EQ(grid.data[17], 0);
  EXPECT_EQ(grid.data[1], -1);

  const auto octomap = listener.newest<ros::Octomap>(options.output.octomap);
  EXPECT_EQ(octomap.id, "OcTree");
  const std::string file =
      "# Octomap OcTree binary file\nid OcTree\nsize " + std::to_string(tree->size()) +
      "\nres 0.1\ndata\n" +
      std::string(reinterpret_cast<const char*>(octomap.data.data()), octomap.data.size());
  const auto read = parse_octree(file, "octomap");
  EXPECT_TRUE(read->isNodeOccupied(read->search(0.05, 0.05, 0.05)));
  EXPECT_FALSE(read->isNodeOccupied(read->search(0.35, 0.05, 0.05)));

  // map -> odom turns by a quarter, so that odom's (1, 0) is at (2, 3).
  const auto tf = listener.newest<ros::TFMessage>("/tf");
  ASSERT_EQ(tf.transforms.size(), 2u);
  EXPECT_EQ(tf.transforms[0].header.frame_id, "map");
  EXPECT_EQ(tf.transforms[0].child_frame_id, "odom");
  EXPECT_NEAR(tf.transforms[0].transform.translation.x, 2.0, 1e-9);
  EXPECT_NEAR(tf.transforms[0].transform.translation.y, 2.0, 1e-9);
  EXPECT_NEAR(tf.transforms[0].transform.rotation.z, M_SQRT1_2, 1e-9);
  EXPECT_EQ(tf.transforms[1].child_frame_id, "base_link");
  EXPECT_EQ(tf.transforms[1].transform.translation.x, 1.0);

  // With each pose, whether a step comes of it or not.
  belief.pose.position.x() = 7.0;
  publisher.on_belief(belief);
  EXPECT_TRUE(within(kPatience, [&] {
    const auto newest = listener.newest<ros::TFMessage>("/tf");
    return std::abs(newest.transforms[0].transform.translation.x - 7.0) < 1e-9;
  }));

  const auto markers = listener.newest<ros::MarkerArray>(options.output.markers);
  ASSERT_EQ(markers.markers.size(), 3u);
  EXPECT_EQ(markers.markers[0].ns, "target");
  EXPECT_EQ(markers.markers[0].pose.position.x, 4.0);
  EXPECT_EQ(markers.markers[1].points.size(), 2u);
  EXPECT_EQ(markers.markers[2].points.size(), 3u);

  const auto diagnostics = listener.newest<ros::DiagnosticArray>(options.output.diagnostics);
  ASSERT_EQ(diagnostics.status.size(), 3u);
  EXPECT_EQ(diagnostics.status[0].message, "exploring");
  EXPECT_EQ(diagnostics.status[0].level, ros::DiagnosticStatus::kOk);
  EXPECT_EQ(diagnostics.status[2].message, "all fit");
}

}  // namespace
}  // namespace prospect::dds_publisher_test
