// SPDX-License-Identifier: Apache-2.0
#include "adapters/formats/datasets/transform_tree.h"

#include <gtest/gtest.h>

#include <cmath>

namespace prospect::transform_tree_test {
namespace {

Eigen::Isometry3d at(double x, double y, double yaw) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, 0.0;
  T.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return T;
}

/// map -> odom (jumps at 10 s) -> base -> lidar, and base -> camera.
TransformTree robot() {
  TransformTree tree;
  for (int k = 0; k <= 20; ++k) tree.add("map", "odom", 0.5 * k, at(k < 20 ? 1.0 : 2.0, 0.0, 0.5));
  for (int k = 0; k <= 10; ++k) tree.add("odom", "base", k, at(2.0 * k, 0.0, 0.2 * k));
  tree.add_static("base", "/lidar", at(0.3, 0.0, M_PI));
  tree.add_static("base", "camera", at(0.2, 0.1, 0.0));
  return tree;
}

TEST(TransformTree, EachLinkIsInterpolatedAtTheStamp) {
  const TransformTree tree = robot();
  const auto T = tree.find("map", "lidar", 3.25);
  ASSERT_TRUE(T);
  EXPECT_TRUE(T->isApprox(at(1.0, 0.0, 0.5) * at(6.5, 0.0, 0.65) * at(0.3, 0.0, M_PI), 1e-9));
  // Between the last transforms of odom it changes, of the base it goes on.
  const auto late = tree.find("/map", "/base", 9.75);
  ASSERT_TRUE(late);
  EXPECT_TRUE(late->isApprox(at(1.5, 0.0, 0.5) * at(19.5, 0.0, 1.95), 1e-9));
  EXPECT_TRUE(tree.find("odom", "base", 4.0)->isApprox(at(8.0, 0.0, 0.8), 1e-12));
}

TEST(TransformTree, UpDownAndAcross) {
  const TransformTree tree = robot();
  EXPECT_TRUE(tree.find("lidar", "camera", -5.0)
                  ->isApprox(at(0.3, 0.0, M_PI).inverse() * at(0.2, 0.1, 0.0), 1e-9))
      << "static transforms hold at all times";
  EXPECT_TRUE(tree.find("base", "odom", 2.5)->isApprox(at(5.0, 0.0, 0.5).inverse(), 1e-9));
  EXPECT_TRUE(tree.find("elsewhere", "elsewhere", 0.0)->isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_FALSE(tree.find("map", "elsewhere", 2.0));
  EXPECT_EQ(tree.root("lidar"), "map");
  EXPECT_EQ(tree.parent("/base"), "odom");
  EXPECT_TRUE(tree.moves("map", "lidar"));
  EXPECT_FALSE(tree.moves("camera", "lidar"));
  EXPECT_FALSE(tree.moves("camera", "elsewhere"));
}

TEST(TransformTree, TheNearestInTimeIsHeld) {
  TransformTree tree;
  tree.add_static("base", "camera", at(0.2, 0.0, 0.0));
  for (int k = 0; k <= 10; ++k) tree.add("odom", "base", k, at(2.0 * k, 0.0, 0.0));
  EXPECT_NEAR(tree.nearest("odom", "camera", 3.4, 0.5)->translation().x(), 6.2, 1e-12);
  EXPECT_NEAR(tree.nearest("odom", "camera", 10.3, 0.5)->translation().x(), 20.2, 1e-12);
  EXPECT_FALSE(tree.nearest("odom", "camera", 10.7, 0.5));
  EXPECT_FALSE(tree.nearest("odom", "elsewhere", 3.0, 0.5));
  tree.forget_before(4.5);
  EXPECT_FALSE(tree.nearest("odom", "base", 4.0, 0.5));
  EXPECT_NEAR(tree.nearest("odom", "base", 5.0, 0.5)->translation().x(), 10.0, 1e-12);
  tree.forget_before(100.0);
  EXPECT_NEAR(tree.nearest("odom", "base", 10.0, 0.5)->translation().x(), 20.0, 1e-12)
      << "the newest stays";
  EXPECT_TRUE(tree.nearest("base", "camera", -5.0, 0.0));
}

TEST(TransformTree, NothingIsKnownOutsideOrInALongGap) {
  TransformTree tree(1.0);
  for (const double t : {0.0, 0.9, 3.0, 3.5, 2.0}) tree.add("odom", "base", t, at(t, 0.0, 0.0));
  EXPECT_FALSE(tree.find("odom", "base", -0.01));
  EXPECT_FALSE(tree.find("odom", "base", 3.51));
  EXPECT_FALSE(tree.find("odom", "base", 1.5)) << "1.1 s between transforms";
  EXPECT_TRUE(tree.find("odom", "base", 3.0));
  EXPECT_NEAR(tree.find("odom", "base", 2.5)->translation().x(), 2.5, 1e-12)
      << "what comes late takes its place";
}

TEST(TransformTree, WhatContradictsTheTreeIsRefused) {
  TransformTree tree = robot();
  EXPECT_FALSE(tree.add("world", "base", 5.0, at(9.0, 9.0, 0.0))) << "a second parent";
  EXPECT_FALSE(tree.add_static("lidar", "map", at(0.0, 0.0, 0.0))) << "a ring";
  EXPECT_FALSE(tree.add_static("map", "map", at(0.0, 0.0, 0.0)));
  EXPECT_TRUE(tree.find("odom", "base", 5.0)->isApprox(at(10.0, 0.0, 1.0), 1e-9));
  EXPECT_EQ(tree.root("base"), "map");
  EXPECT_TRUE(tree.add("odom", "base", 5.0, at(9.0, 9.0, 0.0))) << "said twice: the first stays";
  EXPECT_TRUE(tree.find("odom", "base", 5.0)->isApprox(at(10.0, 0.0, 1.0), 1e-9));
}

TEST(TransformTree, TheNewestStampIsThatOfTheLinkThatIsBehind) {
  TransformTree tree;
  EXPECT_FALSE(tree.newest_stamp("map", "base"));
  tree.add_static("base", "lidar", at(0.3, 0.0, 0.0));
  EXPECT_FALSE(tree.newest_stamp("base", "lidar")) << "none moves";
  tree.add("odom", "base", 3.0, at(1.0, 0.0, 0.0));
  EXPECT_FALSE(tree.newest_stamp("map", "lidar"));
  tree.add("map", "odom", 4.0, at(2.0, 0.0, 0.0));  // stamped ahead
  EXPECT_EQ(tree.newest_stamp("map", "lidar"), 3.0);
  tree.add("odom", "base", 5.0, at(1.0, 0.0, 0.0));
  EXPECT_EQ(tree.newest_stamp("map", "lidar"), 4.0) << "its publisher has ended";
  EXPECT_EQ(tree.newest_stamp("lidar", "odom"), 5.0);
}

}  // namespace
}  // namespace prospect::transform_tree_test
