// SPDX-License-Identifier: Apache-2.0
#include "engine/task/body_outline.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "engine/task/polygon.h"

namespace prospect::body_outline_test {
namespace {

TEST(BodyOutline, IsTheProjectionOfEachShape) {
  SphereSetShape spheres;
  spheres.spheres = {{{0.1, 0.0, 0.3}, 0.1}, {{-0.1, 0.2, 0.2}, 0.15}};
  const BodyOutline two = body_outline(spheres);
  ASSERT_EQ(two.discs.size(), 2u);
  EXPECT_EQ(two.discs[1].center, Eigen::Vector2d(-0.1, 0.2));
  EXPECT_EQ(two.discs[1].radius, 0.15);
  EXPECT_TRUE(two.corners.empty());

  const BodyOutline disc = body_outline(CylinderShape{{0.1, 0.0, 0.3}, 0.2, 0.4});
  ASSERT_EQ(disc.discs.size(), 1u);
  EXPECT_EQ(disc.discs[0].radius, 0.2);

  const BodyOutline box = body_outline(BoxShape{{0.1, 0.0, 0.3}, {0.6, 0.4, 0.3}});
  ASSERT_EQ(box.corners.size(), 4u);
  EXPECT_NEAR(area(box.corners), 0.24, 1e-12);
  EXPECT_TRUE(contains(box.corners, {0.39, 0.19}));
  EXPECT_FALSE(contains(box.corners, {-0.21, 0.0}));

  // A square below and a point above: what is within the outline does not count.
  ConvexShape hull;
  hull.vertices = {
      {0.2, 0.2, 0.1}, {-0.2, 0.2, 0.1}, {-0.2, -0.2, 0.1}, {0.2, -0.2, 0.1}, {0.05, 0.0, 0.5}};
  const BodyOutline square = body_outline(hull);
  ASSERT_EQ(square.corners.size(), 4u);
  EXPECT_NEAR(area(square.corners), 0.16, 1e-12);
  EXPECT_THROW(body_outline(CylinderShape{{0, 0, 0}, -1.0, 0.4}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::body_outline_test
