// SPDX-License-Identifier: Apache-2.0
#include "engine/features/unseen_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

namespace prospect::unseen_features_test {
namespace {

/// 6 m x 6 m about the origin, known to be free where x < 0.
GroundMap half_known_ground() {
  GroundMap ground(GridFrame{0.1, -30, -30, 60, 60});
  for (int i = -30; i < 0; ++i) {
    for (int j = -30; j < 30; ++j) ground.set({i, j}, CellState::kFree);
  }
  return ground;
}

double total(const std::vector<Landmark>& features) {
  double sum = 0.0;
  for (const Landmark& l : features) sum += l.multiplicity;
  return sum;
}

TEST(UnseenFeatures, StandForTheUnknownGroundInReach) {
  UnseenFeatureOptions options;
  options.density = 7.0;
  options.block = 0.5;
  options.range = 2.5;
  options.height = 0.4;
  options.max_blocks = 10000;
  const Pose pose{{0.0, 0.0, 0.0}, 1.0};
  const auto features = unseen_features(half_known_ground(), pose, options);
  // Half a disc of the range, in blocks.
  EXPECT_NEAR(total(features) / (7.0 * 0.5 * M_PI * 2.5 * 2.5), 1.0, 0.1);
  std::set<std::uint64_t> ids;
  double previous = -4.0;
  for (const Landmark& l : features) {
    EXPECT_GT(l.position.x(), 0.0);
    EXPECT_EQ(l.position.z(), 0.4);
    EXPECT_LE(l.position.head<2>().norm(), 2.5);
    EXPECT_EQ(l.survival, 1.0);
    ids.insert(l.id);
    const double azimuth = std::atan2(l.position.y(), l.position.x());
    EXPECT_GE(azimuth, previous);
    previous = azimuth;
  }
  EXPECT_EQ(ids.size(), features.size());
}

TEST(UnseenFeatures, WhatIsBeyondTheMapIsUnknown) {
  UnseenFeatureOptions options;
  options.range = 2.0;
  options.max_blocks = 10000;
  const Pose far{{50.0, 0.0, 0.0}, 0.0};
  const auto features = unseen_features(half_known_ground(), far, options);
  EXPECT_NEAR(total(features) / (options.density * M_PI * 4.0), 1.0, 0.6);
  EXPECT_TRUE(unseen_features(half_known_ground(), {{-2.0, 0.0, 0.0}, 0.0},
                              [] {
                                UnseenFeatureOptions near;
                                near.range = 0.5;
                                return near;
                              }())
                  .empty());
}

TEST(UnseenFeatures, AreFewerPastWhiteWalls) {
  GroundMap ground = half_known_ground();
  for (int i = -30; i < 0; ++i) ground.set({i, 10}, CellState::kOccupied);
  const LocalTexture white(ground, LandmarkMap{}, {0.0, 0.0});
  UnseenFeatureOptions options;
  options.max_blocks = 10000;
  const auto plain = unseen_features(ground, Pose{}, options);
  const auto local = unseen_features(ground, Pose{}, options, &white);
  ASSERT_EQ(plain.size(), local.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    ASSERT_EQ(plain[i].id, local[i].id);
    EXPECT_DOUBLE_EQ(local[i].multiplicity,
                     plain[i].multiplicity * white.relative(plain[i].position.head<2>()));
  }
  EXPECT_LT(total(local), 0.97 * total(plain));
}

TEST(UnseenFeatures, AreAsCrowdedAsTheirDensityIs) {
  UnseenFeatureOptions options;
  for (const Landmark& l : unseen_features(half_known_ground(), Pose{}, options)) {
    EXPECT_EQ(l.per_cell, 0.0);
  }
  options.image_cell = 0.07;
  for (const Landmark& l : unseen_features(half_known_ground(), Pose{}, options)) {
    EXPECT_DOUBLE_EQ(l.per_cell, 5.0 * 0.07 * 0.07);
  }
}

TEST(UnseenFeatures, TheNearestBlocksAreKept) {
  UnseenFeatureOptions options;
  options.max_blocks = 9;
  const auto few = unseen_features(half_known_ground(), Pose{}, options);
  options.max_blocks = 10000;
  const auto all = unseen_features(half_known_ground(), Pose{}, options);
  ASSERT_EQ(few.size(), 9u);
  double farthest = 0.0;
  std::set<std::uint64_t> kept;
  for (const Landmark& l : few) {
    farthest = std::max(farthest, l.position.head<2>().norm());
    kept.insert(l.id);
  }
  for (const Landmark& l : all) {
    if (kept.count(l.id)) continue;
    EXPECT_GE(l.position.head<2>().norm(), farthest - 1e-12);
  }
  options.max_blocks = 0;
  EXPECT_TRUE(unseen_features(half_known_ground(), Pose{}, options).empty());
}

TEST(UnseenFeatures, RefusesOptionsOutOfRange) {
  UnseenFeatureOptions options;
  options.density = -1.0;
  EXPECT_THROW(unseen_features(half_known_ground(), Pose{}, options), std::invalid_argument);
  options = {};
  options.block = 0.0;
  EXPECT_THROW(unseen_features(half_known_ground(), Pose{}, options), std::invalid_argument);
  options = {};
  options.image_cell = -1.0;
  EXPECT_THROW(unseen_features(half_known_ground(), Pose{}, options), std::invalid_argument);
  options = {};
  options.density = 0.0;
  EXPECT_TRUE(unseen_features(half_known_ground(), Pose{}, options).empty());
}

TEST(UnseenFeatures, TheNearestAreTheSameHoweverFarTheRange) {
  UnseenFeatureOptions options;
  options.block = 0.5;
  options.max_blocks = 60;
  const Pose pose{{-1.1, 0.7, 0.0}, 0.3};
  options.range = 9.0;
  const auto some = unseen_features(half_known_ground(), pose, options);
  ASSERT_EQ(some.size(), 60U);
  for (const double range : {20.0, 1e3, 1e6}) {
    options.range = range;
    const auto same = unseen_features(half_known_ground(), pose, options);
    ASSERT_EQ(same.size(), some.size());
    for (std::size_t i = 0; i < same.size(); ++i) EXPECT_EQ(same[i].id, some[i].id);
  }
}

}  // namespace
}  // namespace prospect::unseen_features_test
