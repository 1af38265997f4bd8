// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/simulator/people.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "adapters/formats/files/not_built_in.h"
#include "adapters/robots/simulator/depth_camera.h"
#include "adapters/robots/simulator/world_mesh.h"
#include "tests/adapters/box_room.h"

namespace prospect::people_test {
namespace {

class PeopleTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      const SceneRenderer renderer(person_mesh(1));
    } catch (const NotBuiltIn& absent) {
      GTEST_SKIP() << absent.what();
    }
  }
};

TEST_F(PeopleTest, AreSeenWhereNothingHidesThem) {
  World world = test::box_room(8.0, 6.0, 2.4);
  test::fill(world, {4.0, 3.0, 0.0}, {4.2, 6.0, 2.4});  // a wall across the left half
  world.start.position = {1.0, 3.0, 0.0};
  const FeatureField field(
      world, [&](int i, int j, int k) { return texture_density(world, i, j, k, 1); }, 1);
  const SceneRenderer scene(world_mesh(world, field));
  const auto body = std::make_shared<const SceneRenderer>(person_mesh(1));
  const PinholeCamera camera;
  const Eigen::Isometry3d T_WC = camera_pose(world.start, CameraMount());
  const std::vector<float> empty = scene.intensity(camera, T_WC);
  std::vector<float> no_incidence;
  const DepthImage empty_depth = scene.depth(camera, T_WC, 1, &no_incidence);
  const auto place = [&](double x, double y) {
    return Person{Eigen::Isometry3d(Eigen::Translation3d(x, y, 0.0)), body};
  };
  struct Seen {
    int grey = 0, nearer = 0;
    double nearest = std::numeric_limits<double>::infinity();
  };
  const auto seen = [&](const std::vector<Person>& people) {
    std::vector<float> grey = empty, incidence = no_incidence;
    DepthImage depth = empty_depth;
    draw_people(people, scene, camera, T_WC, 1, grey);
    draw_people(people, camera, T_WC, 1, depth, incidence);
    Seen s;
    for (std::size_t n = 0; n < grey.size(); ++n) {
      s.grey += grey[n] != empty[n];
      EXPECT_FALSE(depth.depth[n] > empty_depth.depth[n]);
      if (!(depth.depth[n] < empty_depth.depth[n])) continue;
      ++s.nearer;
      EXPECT_LE(incidence[n], 1.001f);
      s.nearest = std::min(s.nearest, static_cast<double>(depth.depth[n]));
    }
    return s;
  };
  const Seen before = seen({place(3.0, 3.0)});
  EXPECT_NEAR(before.nearest, 2.0 - 0.12, 0.01);
  // 1.8 m by 0.4 m, 2 m away: what of it lies in the image.
  EXPECT_GT(before.nearer, 20000);
  EXPECT_LT(before.nearer, 60000);
  EXPECT_NEAR(before.grey, before.nearer, 0.02 * before.nearer);
  EXPECT_EQ(seen({place(5.5, 4.0)}).nearer, 0) << "behind the wall";
  EXPECT_EQ(seen({place(5.5, 4.0)}).grey, 0);
  EXPECT_EQ(seen({place(0.2, 3.0)}).nearer, 0) << "behind the camera";
  EXPECT_EQ(seen({place(3.0, 3.0), place(3.6, 3.0)}).grey,
            seen({place(3.6, 3.0), place(3.0, 3.0)}).grey);
  EXPECT_GT(seen({place(1.4, 3.0)}).nearer, 100000) << "before the camera's nose";
}

}  // namespace
}  // namespace prospect::people_test
