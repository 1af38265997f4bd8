// SPDX-License-Identifier: Apache-2.0
#include "engine/features/local_texture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace prospect::local_texture_test {
namespace {

/// A corridor along x, 1 m wide: walls at j = 0 and j = 11, free between, i from 0 to 100.
GroundMap corridor() {
  GroundMap ground(GridFrame{0.1, 0, 0, 101, 12});
  for (int i = 0; i <= 100; ++i) {
    for (int j = 0; j < 12; ++j) {
      ground.set({i, j}, j == 0 || j == 11 ? CellState::kOccupied : CellState::kFree);
    }
  }
  return ground;
}

/// `per_metre` landmarks along both walls, from x = 0 to x = `end`.
LandmarkMap textured_to(double end, int per_metre) {
  LandmarkMap map;
  for (int n = 0; n < static_cast<int>(end * per_metre); ++n) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(n);
    l.position = {(n + 0.5) / per_metre, n % 2 == 0 ? 0.05 : 1.15, 0.5};
    map.landmarks.push_back(l);
  }
  return map;
}

// The sum over cells and landmarks, one by one.
double slow(const GroundMap& ground, const LandmarkMap& map, const Eigen::Vector2d& p,
            const LocalTextureOptions& o) {
  double wall = o.prior, found = 0.0, total = 0.0;
  const auto weight = [&](const Eigen::Vector2d& q) {
    return std::exp(-(q - p).norm() / o.length);
  };
  for (int k = 0; k < ground.frame().size(); ++k) {
    const Cell c = ground.frame().at(k);
    if (ground.state(c) != CellState::kOccupied) continue;
    total += 0.1;
    wall += 0.1 * weight(ground.frame().center(c));
  }
  for (const Landmark& l : map.landmarks) found += weight(l.position.head<2>());
  found *= total / static_cast<double>(map.landmarks.size());
  return std::min(1.0, (found + o.prior) / wall);
}

TEST(LocalTexture, IsThatOfWhatIsNear) {
  const GroundMap ground = corridor();
  const LandmarkMap map = textured_to(5.0, 20);
  const LocalTextureOptions options;
  const LocalTexture texture(ground, map, {0.0, 0.0});
  for (double x = -3.0; x < 13.0; x += 0.37) {
    const Eigen::Vector2d p(x, 0.6);
    EXPECT_NEAR(texture.relative(p), slow(ground, map, p, options), 0.06) << x;
  }
  EXPECT_EQ(texture.relative({2.0, 0.6}), 1.0) << "richer than on average";
  EXPECT_LT(texture.relative({9.0, 0.6}), 0.4);
  EXPECT_LT(texture.relative({10.5, 0.6}), 0.5) << "past the end of a white wall";
  EXPECT_EQ(texture.relative({30.0, 0.6}), 1.0) << "where nothing is known";
}

TEST(LocalTexture, WithoutLandmarksOnlyTheDistanceToWallsMatters) {
  const LocalTexture texture(corridor(), LandmarkMap{}, {0.0, 0.0});
  double last = 0.0;
  for (double x = 10.0; x < 20.0; x += 0.5) {
    const double s = texture.relative({x, 0.6});
    EXPECT_GT(s, 0.0);
    EXPECT_LE(s, 1.0);
    EXPECT_GE(s, last);
    last = s;
  }
  EXPECT_LT(texture.relative({5.0, 0.6}), 0.3);
}

TEST(LocalTexture, NothingKnownIsAverage) {
  const GroundMap empty(GridFrame{0.1, 0, 0, 16, 16});
  EXPECT_EQ(LocalTexture(empty, LandmarkMap{}, {0.0, 0.0}).relative({0.3, 0.3}), 1.0);
  // Landmarks without a wall, and some that are nowhere.
  LandmarkMap map = textured_to(1.0, 4);
  map.landmarks[0].position.x() = std::numeric_limits<double>::quiet_NaN();
  map.landmarks[1].position.x() = 1e300;
  EXPECT_EQ(LocalTexture(empty, map, {0.0, 0.0}).relative({0.3, 0.3}), 1.0);
  EXPECT_TRUE(std::isfinite(LocalTexture(corridor(), map, {0.0, 0.0}).relative({0.3, 0.3})));
}

TEST(LocalTexture, RefusesOptionsOutOfRange) {
  for (double LocalTextureOptions::*option :
       {&LocalTextureOptions::block, &LocalTextureOptions::length, &LocalTextureOptions::prior}) {
    LocalTextureOptions options;
    options.*option = 0.0;
    EXPECT_THROW(LocalTexture(corridor(), LandmarkMap{}, {0.0, 0.0}, options),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace prospect::local_texture_test
