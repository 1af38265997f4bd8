// SPDX-License-Identifier: Apache-2.0
#include "engine/maps/usable_landmarks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "tests/engine/landmark_faults.h"

namespace prospect::usable_landmarks_test {
namespace {

std::shared_ptr<LandmarkMap> sound_map(int count) {
  auto map = std::make_shared<LandmarkMap>();
  for (int i = 0; i < count; ++i) {
    Landmark l;
    l.id = static_cast<std::uint64_t>(i);
    l.position = {0.1 * i, 1.0, 0.5};
    map->landmarks.push_back(l);
  }
  return map;
}

TEST(UsableLandmarks, WhatIsSoundIsHandedOnAsItIs) {
  const auto map = sound_map(50);
  const UsableLandmarks usable = usable_landmarks(map);
  EXPECT_EQ(usable.map, map);
  EXPECT_EQ(usable.dropped, 0);
  EXPECT_EQ(usable.fault, "");
}

TEST(UsableLandmarks, EachFaultIsNamedAndItsLandmarkDropped) {
  for (const auto& [what, spoil] : test::landmark_faults()) {
    SCOPED_TRACE(what);
    for (const std::size_t at : {std::size_t{0}, std::size_t{7}, std::size_t{19}}) {
      const auto map = sound_map(20);
      spoil(map->landmarks[at]);
      const UsableLandmarks usable = usable_landmarks(map);
      EXPECT_EQ(usable.dropped, 1);
      ASSERT_EQ(usable.map->landmarks.size(), 19u);
      for (const Landmark& l : usable.map->landmarks) EXPECT_NE(l.id, at);
      EXPECT_THAT(usable.fault, testing::HasSubstr("landmark " + std::to_string(at) + ": "));
      EXPECT_THAT(usable.fault, testing::HasSubstr(what));
      EXPECT_THAT(usable.fault, testing::HasSubstr("; expected "));
    }
  }
}

TEST(UsableLandmarks, SeveralAreCountedAndTheFirstIsNamed) {
  const auto map = sound_map(30);
  map->landmarks[4].survival = -1.0;
  map->landmarks[5].multiplicity = 0.0;
  map->landmarks[29].position.x() = std::numeric_limits<double>::infinity();
  const UsableLandmarks usable = usable_landmarks(map);
  EXPECT_EQ(usable.dropped, 3);
  EXPECT_EQ(usable.map->landmarks.size(), 27u);
  EXPECT_THAT(usable.fault, testing::StartsWith("landmark 4: survival is -1"));
}

TEST(UsableLandmarks, WhatTheMapSaysOfTextureCountsOnlyIfItCanBe) {
  for (const double bad : {-1.0, std::nan(""), 1e9}) {
    auto map = sound_map(3);
    map->feature_density = bad;
    map->image_cell = bad;
    const UsableLandmarks usable = usable_landmarks(map);
    EXPECT_EQ(usable.dropped, 0);
    EXPECT_THAT(usable.fault, testing::StartsWith("feature_density is "));
    EXPECT_EQ(usable.map->feature_density, 0.0);
    EXPECT_EQ(usable.map->image_cell, 0.0);
    EXPECT_EQ(usable.map->landmarks.size(), 3u);
  }
}

TEST(UsableLandmarks, ANoiseOfTheOdometryThatCannotBeIsLeftOut) {
  auto map = sound_map(3);
  map->odometry_noise.emplace().yaw_per_metre = std::nan("");
  const UsableLandmarks usable = usable_landmarks(map);
  EXPECT_EQ(usable.dropped, 0);
  EXPECT_THAT(usable.fault, testing::HasSubstr("odometry_noise: yaw_per_metre is nan"));
  EXPECT_FALSE(usable.map->odometry_noise);
  EXPECT_EQ(usable.map->landmarks.size(), 3u);
  map->odometry_noise.emplace().yaw_per_metre = 0.01;
  EXPECT_EQ(usable_landmarks(map).map, map);
}

// Semi-definite ones are sound, however thin.
TEST(UsableLandmarks, CovariancesAreSoundUpToRounding) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int n = 0; n < 500; ++n) {
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
            .normalized();
    const double scale = std::pow(10.0, normal(random) * 3.0);
    Landmark l;
    const auto with = [&](double smallest) {
      const Eigen::Vector3d values(scale, n % 3 == 0 ? 0.0 : 0.3 * scale, smallest);
      l.covariance = turn * values.asDiagonal() * turn.inverse();
      return fault_of(l);
    };
    EXPECT_EQ(with(0.0), "");
    EXPECT_EQ(with(1e-7 * scale), "");
    EXPECT_NE(with(-1e-3 * scale), "");
  }
  Landmark exact;
  exact.covariance.setZero();
  EXPECT_EQ(fault_of(exact), "");
}

}  // namespace
}  // namespace prospect::usable_landmarks_test
