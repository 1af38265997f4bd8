// SPDX-License-Identifier: Apache-2.0
#include "runtime/seen_floor.h"

#include <gtest/gtest.h>

#include "tests/perception/depth_scene.h"

namespace prospect::seen_floor_test {
namespace {

PinholeCamera small_camera() {
  PinholeCamera camera;
  camera.width = 80;
  camera.height = 60;
  camera.fx = camera.fy = 60.0;
  camera.cx = 39.5;
  camera.cy = 29.5;
  return camera;
}

// A camera mounted 0.4 m above B's origin, which is 0.05 m above the floor, pitched down.
TEST(SeenFloor, TellsHowFarTheMountIsOff) {
  const PinholeCamera camera = small_camera();
  CameraMount mount;
  mount.T_BC = CameraMount::forward_facing({0.1, 0.0, 0.4}, 0.0, 0.2);
  struct Row {
    double height, pitch, roll;
  };
  for (const Row& r : {Row{0.45, 0.2, 0.0}, Row{0.42, 0.2, 0.0}, Row{0.45, 0.25, -0.04}}) {
    const DepthImage image = test::DepthScene().render(
        camera, test::DepthScene::looking(0.0, 0.0, r.height, 0.3, r.pitch, r.roll), 0.002);
    const auto floor = seen_floor(image, camera, mount, 0.05, {0.2, 4.0});
    ASSERT_TRUE(floor) << r.height;
    EXPECT_NEAR(floor->stated_height, 0.45, 1e-9);
    EXPECT_NEAR(floor->stated_pitch, 0.2, 1e-9);
    EXPECT_NEAR(floor->stated_roll, 0.0, 1e-9);
    EXPECT_NEAR(floor->height, r.height, 0.01);
    EXPECT_NEAR(floor->pitch, r.pitch, 0.01);
    EXPECT_NEAR(floor->roll, r.roll, 0.01);
    EXPECT_GT(floor->sigma_height, 0.0);
  }
}

TEST(SeenFloor, NoneWhereNothingIsSeen) {
  const PinholeCamera camera = small_camera();
  EXPECT_FALSE(seen_floor(DepthImage(80, 60), camera, {}, 0.0, {0.2, 4.0}));
  EXPECT_FALSE(seen_floor(DepthImage(8, 6), camera, {}, 0.0, {0.2, 4.0}));
}

}  // namespace
}  // namespace prospect::seen_floor_test
