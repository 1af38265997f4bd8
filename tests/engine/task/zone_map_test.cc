// SPDX-License-Identifier: Apache-2.0
#include "engine/task/zone_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::zone_map_test {
namespace {

const Polygon kRoom = {{-3, -2}, {5, -2}, {5, 1}, {3, 1}, {3, 4}, {-3, 4}};
const Polygon kSquare = {{1, 0}, {2, 0}, {2, 1}, {1, 1}};
const Polygon kU = {{-2, 1}, {0.5, 1}, {0.5, 3}, {0, 3}, {0, 1.5}, {-1.5, 1.5}, {-1.5, 3}, {-2, 3}};

Zones zones() {
  Zones z;
  z.bound = kRoom;
  z.keep_out = {kSquare, kU};
  z.slow = {{{{-2, -2}, {0, -2}, {0, 0}, {-2, 0}}, 0.2},
            {{{-1, -2}, {0, -2}, {0, -1}, {-1, -1}}, 0.1}};
  return z;
}

TEST(Zones, EveryFaultIsALine) {
  EXPECT_TRUE(faults(zones()).empty());
  EXPECT_TRUE(faults(Zones()).empty());
  EXPECT_TRUE(Zones().empty());
  EXPECT_FALSE(zones().empty());
  Zones wrong = zones();
  wrong.bound->resize(2);
  wrong.keep_out[1][3].x() = std::numeric_limits<double>::infinity();
  wrong.slow[0].max_speed = 0.0;
  wrong.slow[1].max_speed = std::nan("");
  const std::vector<std::string> list = faults(wrong);
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[0], "bound: 2 corners; expected 3 to 1000");
  EXPECT_EQ(list[1].find("keep_out[1]: corner 4"), 0u) << list[1];
  EXPECT_EQ(list[2].find("slow[0]: max_speed is 0"), 0u) << list[2];
  EXPECT_EQ(list[3].find("slow[1]: max_speed is"), 0u) << list[3];
  EXPECT_THROW(ZoneMap{wrong}, std::invalid_argument);
}

TEST(ZoneMap, ForbiddenIsInAKeepOutOrBeyondTheBound) {
  const ZoneMap map(zones());
  ASSERT_EQ(map.num_forbidden(), 3);
  EXPECT_EQ(map.name(0), "zones.bound");
  EXPECT_EQ(map.name(2), "zones.keep_out[1]");
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> place(-5.0, 7.0);
  int forbidden = 0;
  for (int n = 0; n < 2000; ++n) {
    const Eigen::Vector2d p(place(random), place(random));
    const bool in = !contains(kRoom, p) || contains(kSquare, p) || contains(kU, p);
    const double d = map.distance(p);
    ASSERT_EQ(d < 0.0, in) << p.transpose();
    double least = map.distance(0, p);
    for (int part = 1; part < 3; ++part) least = std::min(least, map.distance(part, p));
    ASSERT_EQ(d, least);
    if (!in) {
      ASSERT_EQ(d, std::min({-signed_distance(kRoom, p), signed_distance(kSquare, p),
                             signed_distance(kU, p)}));
    }
    forbidden += in;
  }
  EXPECT_GT(forbidden, 500);
  Zones none;
  none.slow = zones().slow;
  EXPECT_EQ(ZoneMap(none).num_forbidden(), 0);
  EXPECT_EQ(ZoneMap(none).distance({0, 0}), std::numeric_limits<double>::infinity());
}

std::vector<RobotShape> shapes() {
  SphereSetShape spheres;
  spheres.spheres = {{{0.1, 0.05, 0.25}, 0.12}, {{-0.12, 0.0, 0.25}, 0.1}};
  ConvexShape hull;
  hull.vertices = {{0.2, 0.0, 0.1},  {-0.15, 0.12, 0.1}, {-0.15, -0.12, 0.1},
                   {0.1, 0.0, 0.45}, {-0.1, 0.05, 0.45}, {-0.1, -0.05, 0.45}};
  return {spheres, BoxShape{{0.02, 0.0, 0.3}, {0.5, 0.3, 0.3}},
          CylinderShape{{0.05, 0.0, 0.3}, 0.18, 0.4}, hull};
}

/// Points of the outline and within it, in B, about 4 mm apart.
std::vector<Eigen::Vector2d> points_of(const BodyOutline& body) {
  std::vector<Eigen::Vector2d> points;
  for (const Disc& disc : body.discs) {
    for (int k = 0; k < 300; ++k) {
      const double angle = 2.0 * M_PI * k / 300;
      for (const double share : {1.0, 0.5, 0.0}) {
        points.push_back(disc.center +
                         share * disc.radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      }
    }
  }
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& c : body.corners)
    middle += c / static_cast<double>(body.corners.size());
  for (std::size_t i = 0; i < body.corners.size(); ++i) {
    const Eigen::Vector2d a = body.corners[i], b = body.corners[(i + 1) % body.corners.size()];
    for (int k = 0; k < 100; ++k) {
      for (const double share : {1.0, 0.5, 0.0}) {
        points.push_back(middle + share * (a + (b - a) * k / 100.0 - middle));
      }
    }
  }
  return points;
}

TEST(ZoneMap, TheGapOfABodyAgreesWithItsPoints) {
  const ZoneMap map(zones());
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> place(-3.5, 5.5), angle(-4.0, 4.0);
  for (const RobotShape& shape : shapes()) {
    const BodyOutline body = body_outline(shape);
    const std::vector<Eigen::Vector2d> points = points_of(body);
    int apart = 0, overlapping = 0;
    for (int n = 0; n < 300; ++n) {
      const Pose pose{{place(random), place(random), 0.0}, angle(random)};
      const Eigen::Rotation2Dd R(pose.yaw);
      for (int part = 0; part < 3; ++part) {
        const double gap = map.gap(part, body, pose);
        double least = std::numeric_limits<double>::infinity();
        for (const Eigen::Vector2d& p : points) {
          least = std::min(least, map.distance(part, pose.position.head<2>() + R * p));
        }
        // Corners of a zone may stick into the body between its points.
        if (gap > 0.01) {
          ASSERT_NEAR(gap, least, 5e-3) << part;
          ++apart;
        } else if (least < -0.01) {
          ASSERT_LT(gap, 0.0) << part;
          ++overlapping;
        }
      }
    }
    EXPECT_GT(apart, 200);
    EXPECT_GT(overlapping, 20);
  }
  // A body about a whole keep-out, and a keep-out about a body.
  Zones small;
  small.keep_out = {{{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}}};
  const BodyOutline box = body_outline(BoxShape{{0, 0, 0.3}, {0.5, 0.4, 0.3}});
  EXPECT_LT(ZoneMap(small).gap(0, box, Pose{}), 0.0);
  small.keep_out = {{{-5, -5}, {5, -5}, {5, 5}, {-5, 5}}};
  EXPECT_LT(ZoneMap(small).gap(0, box, Pose{}), 0.0);
}

TEST(ZoneMap, SpeedsFallBeforeAZone) {
  const ZoneMap map(zones());
  EXPECT_EQ(map.speed_limit({-1.5, -0.5}), 0.2);
  EXPECT_EQ(map.speed_limit({-0.5, -1.5}), 0.1) << "the lower of two";
  EXPECT_EQ(map.speed_limit({0.1, -0.5}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(map.speed_limit({0.1, -0.5}, 0.1), 0.2);
  EXPECT_EQ(map.approach_speed({-1.5, -0.5}, 0.5, 0.05), 0.2);
  EXPECT_NEAR(map.approach_speed({0.85, -0.5}, 0.5, 0.05), std::sqrt(0.04 + 0.8), 1e-12);
  // Braking so, a robot is slow enough where the zone begins.
  double v = map.approach_speed({1.0, -0.5}, 0.5, 0.05), x = 1.0;
  while (x > 0.05) {
    x -= 1e-4 * v;
    v -= 1e-4 * 0.5;
  }
  EXPECT_LE(v, 0.2 + 1e-3);
}

TEST(ZoneWalk, KeepsTheMarginOrWhatItHas) {
  Zones z;
  z.keep_out = {{{1, -1}, {2, -1}, {2, 1}, {1, 1}}};
  const ZoneMap map(z);
  const BodyOutline disc = body_outline(CylinderShape{{0, 0, 0.3}, 0.2, 0.4});
  const auto at = [](double x, double yaw = 0.0) { return Pose{{x, 0.0, 0.0}, yaw}; };
  {
    ZoneWalk walk(map, disc, at(0.0), 0.05, 1.0);
    EXPECT_EQ(walk.margin(), 0.05);
    EXPECT_EQ(walk.step(at(0.74)), -1);
    EXPECT_EQ(walk.step(at(0.751)), 0);
  }
  {  // 2 cm away: it keeps half of that, or all.
    ZoneWalk half(map, disc, at(0.78), 0.05, 0.5), all(map, disc, at(0.78), 0.05, 1.0);
    EXPECT_NEAR(half.margin(), 0.01, 1e-4);
    EXPECT_EQ(half.step(at(0.789)), -1);
    EXPECT_EQ(half.step(at(0.7905)), 0);
    EXPECT_EQ(all.step(at(0.78, 1.0)), -1) << "it may turn on the spot";
    EXPECT_EQ(all.step(at(0.7805)), 0);
    EXPECT_EQ(all.step(at(0.7)), -1);
  }
  {  // In it: out, not deeper, and not in again.
    ZoneWalk walk(map, disc, at(0.9), 0.05, 1.0);
    EXPECT_EQ(walk.step(at(0.9, 2.0)), -1);
    EXPECT_EQ(walk.step(at(0.88)), -1);
    EXPECT_EQ(walk.step(at(0.881)), 0);
    EXPECT_EQ(walk.step(at(0.79)), -1);
    EXPECT_EQ(walk.step(at(0.82)), 0);
  }
}

TEST(ZoneWalk, TheBoundIsLeftByNoCorner) {
  Zones z;
  z.bound = Polygon{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const ZoneMap map(z);
  const BodyOutline box = body_outline(BoxShape{{0, 0, 0.3}, {0.8, 0.4, 0.3}});
  ZoneWalk walk(map, box, Pose{}, 0.01, 1.0);
  EXPECT_EQ(walk.step({{0.58, 0, 0}, 0.0}), -1);
  EXPECT_EQ(walk.step({{0.0, 0.58, 0}, 0.0}), -1);
  EXPECT_EQ(walk.step({{0.0, 0.65, 0}, M_PI / 2}), 0) << "lengthwise it sticks out";
  EXPECT_EQ(walk.step({{0.595, 0, 0}, 0.0}), 0) << "less than the margin is left";
}

}  // namespace
}  // namespace prospect::zone_map_test
