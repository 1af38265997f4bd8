// SPDX-License-Identifier: Apache-2.0
#include "runtime/range_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>

namespace prospect::range_check_test {
namespace {

/// Looks ahead from 0.3 m above B's origin.
RangeCamera ahead() {
  RangeCamera c;
  c.camera.width = 40;
  c.camera.height = 20;
  c.camera.fx = c.camera.fy = 20.0;
  c.camera.cx = 19.5;
  c.camera.cy = 9.5;
  c.mount.T_BC = Eigen::Isometry3d::Identity();
  c.mount.T_BC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  c.mount.T_BC.translation() = Eigen::Vector3d(0.0, 0.0, 0.3);
  c.range = {0.2, 4.0};
  c.stride = 2;
  return c;
}

DepthFrame wall_at(double z) {
  return {10.0, std::make_shared<const DepthImage>(40, 20, static_cast<float>(z))};
}

TEST(RangeFrame, HasARayForEachPixelOfTheStride) {
  const RangeFrame frame = range_frame(wall_at(2.0), ahead());
  ASSERT_EQ(frame.rays.size(), 200u);
  EXPECT_EQ(frame.stamp, 10.0);
  EXPECT_EQ(frame.origin.z(), 0.3);
  for (const RangeRay& ray : frame.rays) {
    EXPECT_EQ(ray.kind, RangeRay::Kind::kHit);
    EXPECT_NEAR(ray.point.x(), 2.0, 1e-6);
  }
  EXPECT_GT(frame.rays.front().point.y(), 1.0);  // up in the image and to the left
  EXPECT_GT(frame.rays.front().point.z(), 0.3);
}

TEST(RangeFrame, BeyondTheRangeIsClearAndWhatIsNotMeasuredIsInvalid) {
  EXPECT_EQ(range_frame(wall_at(9.0), ahead()).rays[0].kind, RangeRay::Kind::kClear);
  EXPECT_NEAR(range_frame(wall_at(9.0), ahead()).rays[0].point.x(), 4.0, 1e-6);
  for (const double z : {0.1, 0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(range_frame(wall_at(z), ahead()).rays[0].kind, RangeRay::Kind::kInvalid) << z;
  }
  RangeCamera other = ahead();
  other.camera.width = 41;
  EXPECT_TRUE(range_frame(wall_at(2.0), other).rays.empty());
}

TEST(RangeCheck, AsksOfWhatIsInTheInbox) {
  const ManualClock clock(10.0);
  SensorInboxOptions options;
  options.depth_in_runtime_clock = options.scan_in_runtime_clock = true;
  SensorInbox inbox(clock, options);
  const RangeStop stop;
  const RangeCameras cameras{{0, ahead()}};
  const auto look = range_check(inbox, stop, cameras);
  const Twist forward{{0.4, 0.0, 0.0}, 0.0};
  EXPECT_EQ(look(forward, 10.0).share, 1.0);  // nothing to look at
  inbox.depth(9.99, *wall_at(3.5).image);
  EXPECT_EQ(look(forward, 10.0).share, 1.0) << look(forward, 10.0).obstacle;
  inbox.depth(9.995, *wall_at(0.32).image);
  EXPECT_LT(look(forward, 10.0).share, 0.5);
  inbox.depth(9.996, DepthImage(40, 20));
  EXPECT_GT(look(forward, 10.0).share, 0.0) << "one image without depths decides nothing";
  EXPECT_LT(look(forward, 10.0).share, 0.5) << "what the one before has shown is there";
  inbox.depth(10.0, DepthImage(40, 20));  // covered
  EXPECT_EQ(look(forward, 10.0).share, 0.0);
  EXPECT_FALSE(look(forward, 10.0).obstacle.empty());
  // A scan that sees it where the depth image does not.
  SensorInbox other(clock, options);
  const auto look_at_scan = range_check(other, stop, cameras);
  DepthScan scan;
  scan.origin = {0.0, 0.0, 0.3};
  for (int k = -60; k <= 60; ++k) scan.hits.emplace_back(0.31, 0.005 * k, 0.3);
  other.scan(10.0, scan);
  EXPECT_LT(look_at_scan(forward, 10.0).share, 0.5);
  EXPECT_EQ(look_at_scan(forward, 10.0).obstacle, "") << "slower, but it may go on";
}

// A rear camera has nothing to say of driving ahead, and all of driving back.
TEST(RangeCheck, OfSeveralSensorsThoseDecideThatLookWhereTheBodyDrives) {
  const ManualClock clock(10.0);
  SensorInboxOptions options;
  options.depth_in_runtime_clock = options.scan_in_runtime_clock = true;
  SensorInbox inbox(clock, options);
  const RangeStop stop;
  RangeCamera back = ahead();
  back.mount.T_BC = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()) * back.mount.T_BC;
  const RangeCameras cameras{{0, ahead()}, {1, back}};
  const auto look = range_check(inbox, stop, cameras);
  const auto show = [&](double front, double rear) {
    for (const double stamp : {9.99, 10.0}) {
      inbox.observe(DepthFrame{stamp, wall_at(front).image, 0});
      inbox.observe(DepthFrame{stamp, wall_at(rear).image, 1});
    }
  };
  const Twist forward{{0.4, 0.0, 0.0}, 0.0}, backward{{-0.4, 0.0, 0.0}, 0.0};
  show(3.5, 3.5);
  EXPECT_EQ(look(forward, 10.0).share, 1.0) << "not slowed by who looks back";
  EXPECT_EQ(look(backward, 10.0).share, 1.0);
  show(3.5, 0.32);
  EXPECT_EQ(look(forward, 10.0).share, 1.0);
  EXPECT_LT(look(backward, 10.0).share, 0.5);
  show(0.32, 3.5);
  EXPECT_LT(look(forward, 10.0).share, 0.5);
  EXPECT_EQ(look(backward, 10.0).share, 1.0);
  const RangeCameras front_alone{{0, ahead()}};
  const auto one = range_check(inbox, stop, front_alone);
  EXPECT_LT(one(backward, 10.0).share, 0.5) << "blind";
}

}  // namespace
}  // namespace prospect::range_check_test
