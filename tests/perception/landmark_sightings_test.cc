// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <unordered_map>
#include <vector>

#include "perception/odometry/stereo_odometry.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/rendered_room.h"

namespace prospect::landmark_sightings_test {
namespace {

using test::RenderedRoom;

StereoCamera camera() {
  StereoCamera c;
  c.left = {275.0, 275.0, 200.0, 150.0, 400.0, 300.0};
  return c;
}

// Fast enough that landmarks are lost, made and given up.
Eigen::Isometry3d pose(int k) {
  return RenderedRoom::looking(-1.5 + 0.08 * k, -0.5, 1.05, -0.2 + 0.04 * k);
}

TEST(LandmarkSightings, AreWhatTheFrameCountsAndWhereTheyMustBe) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const RenderedRoom room;
  StereoOdometry odometry(camera(), {}, pose(0));
  std::set<std::uint64_t> gone;
  int given_up = 0, missed = 0;
  for (int k = 0; k < 16; ++k) {
    const auto pair = room.render(camera(), pose(k), 2.0, static_cast<std::uint64_t>(k));
    const OdometryFrame frame = odometry.process(0.1 * k, pair.left.view(), pair.right.view());
    ASSERT_EQ(frame.state, Localization::kOk) << frame.reason;
    std::unordered_map<std::uint64_t, Eigen::Vector3d> positions;
    const auto map = odometry.landmarks();
    for (const Landmark& l : map->landmarks) positions[l.id] = l.position;
    std::set<std::uint64_t> ids;
    int tracked = 0, made = 0;
    for (const LandmarkSighting& s : odometry.sightings()) {
      EXPECT_TRUE(ids.insert(s.id).second) << "twice: " << s.id;
      EXPECT_FALSE(gone.contains(s.id)) << "back again: " << s.id;
      made += s.made;
      tracked += s.tracked && !s.made;
      missed += !s.tracked;
      EXPECT_TRUE(s.tracked || !s.made);
      EXPECT_GE(s.pixel.x(), -5.0);
      EXPECT_LE(s.pixel.x(), 405.0);
      // A tracked one that the map still has is there where the true camera sees it.
      if (s.tracked && positions.contains(s.id)) {
        const Eigen::Vector3d Y = pose(k).inverse() * positions[s.id];
        EXPECT_LT((camera().left.project(Y) - s.pixel).norm(), 6.0);
      }
    }
    EXPECT_EQ(made, frame.matched);
    if (k > 0) {
      EXPECT_EQ(tracked, frame.tracked);
    }
    for (const std::uint64_t id : odometry.given_up()) {
      EXPECT_TRUE(ids.contains(id));
      EXPECT_FALSE(positions.contains(id));
      gone.insert(id);
      ++given_up;
    }
  }
  EXPECT_GT(given_up, 10);
  EXPECT_GT(missed, 10);
}

TEST(LandmarkSightings, NoPoseNoSightings) {
  const RenderedRoom room;
  StereoOdometry odometry(camera(), {}, pose(0));
  EXPECT_TRUE(odometry.sightings().empty());
  const auto pair = room.render(camera(), pose(0), 2.0, 0);
  odometry.process(0.0, pair.left.view(), pair.right.view());
  EXPECT_FALSE(odometry.sightings().empty());
  const Image blank(400, 300, 90);
  EXPECT_EQ(odometry.process(0.1, blank.view(), blank.view()).state, Localization::kLost);
  EXPECT_TRUE(odometry.sightings().empty());
  EXPECT_TRUE(odometry.given_up().empty());
}

TEST(LandmarkSightings, SurvivalIsLearnedAndFallsWithTheHorizon) {
  NOT_UNDER_SANITIZERS("long sequences go the ways of short ones");
  const RenderedRoom room;
  StereoOdometry odometry(camera(), {}, pose(0));
  for (int k = 0; k < 10; ++k) {
    const auto pair = room.render(camera(), pose(k), 2.0, static_cast<std::uint64_t>(k));
    odometry.process(0.1 * k, pair.left.view(), pair.right.view());
  }
  const auto soon = odometry.landmarks(0.1), late = odometry.landmarks(3.0);
  ASSERT_EQ(soon->landmarks.size(), late->landmarks.size());
  ASSERT_GT(soon->landmarks.size(), 100u);
  for (std::size_t i = 0; i < soon->landmarks.size(); ++i) {
    EXPECT_LE(soon->landmarks[i].survival, 1.0);
    EXPECT_GT(soon->landmarks[i].survival, late->landmarks[i].survival);
    EXPECT_GE(late->landmarks[i].survival, 0.0);
  }
}

}  // namespace
}  // namespace prospect::landmark_sightings_test
