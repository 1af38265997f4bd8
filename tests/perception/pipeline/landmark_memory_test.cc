// SPDX-License-Identifier: Apache-2.0
#include "perception/pipeline/landmark_memory.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/features/landmarks_per_cell.h"

namespace prospect::landmark_memory_test {
namespace {

Landmark landmark_at(std::uint64_t id, double x, double y) {
  Landmark l;
  l.id = id;
  l.position = {x, y, 0.55};
  return l;
}

LandmarkMap row_of_landmarks(std::uint64_t first, int count, double x) {
  LandmarkMap map;
  for (int i = 0; i < count; ++i) {
    map.landmarks.push_back(landmark_at(first + static_cast<std::uint64_t>(i), x, 0.05 + 0.5 * i));
  }
  return map;
}

TEST(LandmarkMemory, HoldsWhatTheOdometryHasForgotten) {
  LandmarkMemory memory;
  memory.add(row_of_landmarks(1, 10, 0.05));
  LandmarkMap now = row_of_landmarks(100, 5, 3.05);
  now.feature_density = 7.5;
  memory.add(now);
  const auto all = memory.with_remembered(now);
  ASSERT_EQ(all->landmarks.size(), 15u);
  EXPECT_EQ(all->feature_density, 7.5);
  EXPECT_EQ(all->landmarks[0].id, 100u) << "those of now first";
}

TEST(LandmarkMemory, FollowsWhatTheMapIsCorrectedBy) {
  LandmarkMemory memory;
  memory.add(row_of_landmarks(1, 10, 0.05));
  const PlanarMove move{Eigen::Vector2d(1.0, 0.0), 0.5 * M_PI};
  memory.follow(PlaceMoves({{Eigen::Vector2d::Zero(), move, 0.0}}));
  const auto all = memory.with_remembered({});
  ASSERT_EQ(all->landmarks.size(), 10u);
  for (const Landmark& l : all->landmarks) {
    EXPECT_LT((l.position -
               move(Eigen::Vector3d(0.05, 0.05 + 0.5 * (static_cast<double>(l.id) - 1.0), 0.55)))
                  .norm(),
              1e-12);
    EXPECT_LT((l.creation_direction - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  }
}

TEST(LandmarkMemory, OnePlaceCountsOnce) {
  LandmarkMemory memory;
  memory.add(row_of_landmarks(1, 10, 0.05));
  // Found again under other names, a little beside; and one that has moved keeps its name.
  LandmarkMap now = row_of_landmarks(100, 10, 0.06);
  EXPECT_EQ(memory.with_remembered(now)->landmarks.size(), 10u);
  now.landmarks.assign(1, landmark_at(1, 5.0, 5.0));
  EXPECT_EQ(memory.with_remembered(now)->landmarks.size(), 10u);
}

// Those of now and those of before share the cells of the next image.
TEST(LandmarkMemory, NotesHowCrowdedTheyAre) {
  LandmarkMemory memory;
  memory.add(row_of_landmarks(1, 10, 0.05));
  LandmarkMap now = row_of_landmarks(100, 10, 0.45);
  now.image_cell = 0.07;
  const auto all = memory.with_remembered(now);
  ASSERT_EQ(all->landmarks.size(), 20u);
  EXPECT_EQ(all->image_cell, 0.07);
  LandmarkMap alone = now;
  note_landmarks_per_cell(alone);
  for (std::size_t i = 0; i < now.landmarks.size(); ++i) {
    EXPECT_GE(all->landmarks[i].per_cell,
              alone.landmarks[i].per_cell + 0.07 * 0.07 * 0.9 / (M_PI * 0.25) - 1e-12)
        << "its twin 0.4 m away";
  }
}

TEST(LandmarkMemory, ForgetsWhatWasSeenLongAgo) {
  LandmarkMemory memory(100);
  for (int i = 0; i < 20; ++i) {
    memory.add(row_of_landmarks(static_cast<std::uint64_t>(1000 * i), 10, 0.05 + i));
  }
  EXPECT_LE(memory.size(), 100u);
  EXPECT_GE(memory.size(), 80u);
  const auto map = memory.with_remembered({});
  for (const Landmark& l : map->landmarks) EXPECT_GT(l.position.x(), 9.0);
}

}  // namespace
}  // namespace prospect::landmark_memory_test
