// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontier_utility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::frontier_utility_test {
namespace {

const GridFrame kFrame{0.1, 0, 0, 100, 100};

Frontier frontier(int i, int j, int n) {
  Frontier f;
  for (int k = 0; k < n; ++k) f.cells.push_back({i + k, j});
  f.length = 0.1 * n;
  f.active = true;
  return f;
}

Pose at(double x, double y, double yaw) { return {{x, y, 0.0}, yaw}; }

class Utility : public ::testing::Test {
 protected:
  Utility() { utility_.map_changed(kFrame, {}, {}); }

  void observation(const std::vector<Frontier>& f, const Pose& pose, int times) {
    for (const Frontier& one : f) {
      for (const Cell c : one.cells) map_[c] = 0;
    }
    for (int k = 0; k < times; ++k) utility_.observation(map_, f, pose, clock_ += 0.5);
  }

  Grid<std::uint8_t> map_ = Grid<std::uint8_t>(kFrame, 1);  // nonzero: seen through
  FrontierUtility utility_{FrontierUtilityOptions{}};
  double clock_ = 0.0;
};

TEST_F(Utility, AnObservationThatResolvesNothingLowersTheConfidenceInWhatWasInView) {
  const std::vector<Frontier> f{frontier(50, 50, 8), frontier(50, 5, 8), frontier(95, 50, 4)};
  observation(f, at(3.2, 5.0, 0.0), 3);
  // The first cell hides the others of its row; to the side and out of range are not in view.
  EXPECT_EQ(utility_.confidence({50, 50}), 0.125);
  EXPECT_EQ(utility_.confidence({52, 50}), 1.0);
  EXPECT_EQ(utility_.confidence({50, 5}), 1.0);
  EXPECT_EQ(utility_.confidence({95, 50}), 1.0);
  // What others of its cluster promise more than it is led to instead.
  std::vector<float> ranges;
  utility_.view_ranges(f[0], ranges);
  ASSERT_EQ(ranges.size(), 8U);
  EXPECT_EQ(ranges[0], 0.0F);
  for (std::size_t n = 1; n < ranges.size(); ++n) EXPECT_EQ(ranges[n], 4.0F);
}

TEST_F(Utility, ALookFromFarTellsLess) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  observation(f, at(2.05, 5.05, 0.0), 1);  // 3 m of 4 m
  EXPECT_NEAR(utility_.confidence({50, 50}), std::sqrt(0.5), 1e-6);
  observation(f, at(1.25, 5.05, 0.0), 10);  // 3.8 m: not in view
  EXPECT_NEAR(utility_.confidence({50, 50}), std::sqrt(0.5), 1e-6);
}

TEST_F(Utility, WhatAnObservationDidNotShowMustBeObservedFromNearer) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  std::vector<float> ranges;
  observation(f, at(1.55, 5.05, 0.0), 1);  // from 3.5 m
  utility_.view_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.75 * 3.5, 1e-6);
  observation(f, at(4.95, 5.05, 0.0), 1);  // from 0.1 m
  utility_.view_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.3, 1e-6);
  observation(f, at(1.55, 5.05, 0.0), 1);  // from far again: that says nothing new
  utility_.view_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.3, 1e-6);
  // New ground beside it may open the view.
  utility_.map_changed(kFrame, {{51, 50}}, {{51, 50}});
  utility_.view_ranges(f[0], ranges);
  EXPECT_EQ(ranges[0], 4.0F);
}

TEST_F(Utility, AnObstacleOrTheUnknownHidesAFrontier) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{40, 50}] = 0;
  observation(f, at(3.25, 5.05, 0.0), 6);
  EXPECT_EQ(utility_.confidence({50, 50}), 1.0);
  map_[{40, 50}] = 1;
  observation(f, at(3.25, 5.05, M_PI), 6);  // looking away
  EXPECT_EQ(utility_.confidence({50, 50}), 1.0);
  observation(f, at(3.25, 5.05, 2.0 * M_PI + 0.3), 1);
  EXPECT_EQ(utility_.confidence({50, 50}), 0.5);
}

TEST_F(Utility, ALookFromAViewpointCountsWhateverLineLeadsThere) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{45, 50}] = 0;  // the line between the middles is blocked, another may not be
  utility_.observation(map_, f, at(4.05, 5.05, 0.0), 1.0, Cell{50, 50});
  EXPECT_EQ(utility_.confidence({50, 50}), 0.5);
  utility_.observation(map_, f, at(4.05, 5.05, M_PI), 2.0, Cell{50, 50});  // looking away
  EXPECT_EQ(utility_.confidence({50, 50}), 0.5);
}

TEST_F(Utility, FastReplanningDoesNotCountALookTwice) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{50, 50}] = 0;
  for (int k = 0; k < 12; ++k) utility_.observation(map_, f, at(3.2, 5.05, 0.0), 0.1 * k);
  EXPECT_EQ(utility_.confidence({50, 50}), 0.125);  // looks at 0, 0.4, 0.8; the fourth is at 1.2
}

TEST_F(Utility, NewGroundNearbyRenewsTheConfidence) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  observation(f, at(3.2, 5.05, 0.0), 4);
  utility_.map_changed(kFrame, {{53, 50}, {50, 47}}, {{53, 50}, {50, 47}});
  EXPECT_EQ(utility_.confidence({50, 50}), 0.0625) << "three cells away";
  utility_.map_changed(kFrame, {{52, 52}}, {{52, 52}});
  EXPECT_EQ(utility_.confidence({50, 50}), 1.0);
}

// Noise flips a cell for ever.
TEST_F(Utility, FlickeringCellsRenewItLessEachTime) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  double most = 1.0;
  for (int k = 0; k < 6; ++k) {
    observation(f, at(3.2, 5.05, 0.0), 8);
    utility_.map_changed(kFrame, {}, {{51, 50}});
    EXPECT_LE(utility_.confidence({50, 50}), 0.5 * most);
    most = utility_.confidence({50, 50});
  }
  EXPECT_LT(most, 0.02);
  EXPECT_EQ(utility_.confidence({60, 60}), 1.0) << "nor does it raise trust";
}

TEST_F(Utility, AFailedVisitLowersItAroundTheTarget) {
  const Frontier f = frontier(20, 50, 30);
  utility_.visit_failed({25, 50}, f.cells, 0.1);
  EXPECT_NEAR(utility_.confidence({25, 50}), 0.5, 1e-6);
  EXPECT_NEAR(utility_.confidence({35, 50}), 0.5, 1e-6);
  EXPECT_EQ(utility_.confidence({36, 50}), 1.0);
}

TEST_F(Utility, AMapThatGrowsKeepsWhatWasLearned) {
  utility_.visit_failed({25, 50}, {{25, 50}}, 0.1);
  utility_.map_changed({0.1, -40, -40, 200, 200}, {}, {});
  EXPECT_NEAR(utility_.confidence({25, 50}), 0.5, 1e-6);
  EXPECT_EQ(utility_.confidence({-30, -30}), 1.0);
}

/// A known room of 4 m by 4 m in unknown space, its east wall open over `opening` cells.
GroundMap room(int opening) {
  GroundMap map(GridFrame{0.1, 0, 0, 100, 64});
  for (int j = 10; j < 50; ++j) {
    for (int i = 10; i < 50; ++i) {
      const bool wall =
          i == 10 || j == 10 || j == 49 || (i == 49 && !(j >= 25 && j < 25 + opening));
      if (i == 49 && !wall) continue;  // unknown
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

std::vector<Frontier> measured(const GroundMap& map, FrontierUtility& utility) {
  Traversability t{TraversabilityOptions{}};
  t.update(map);
  FrontierDetector detector{FrontierOptions{}};
  detector.update(t);
  utility.map_changed(t.frame(), {}, {});
  detector.find_viewpoints(t, [&](const Frontier& one, std::vector<float>& ranges) {
    utility.view_ranges(one, ranges);
  });
  std::vector<Frontier> f = detector.frontiers();
  utility.measure(t, f);
  return f;
}

TEST(FrontierUtilityArea, ADoorIsExpectedToShowARoomAndASlitNothing) {
  double before = 0.0;
  for (const int opening : {2, 4, 6, 10, 20}) {
    SCOPED_TRACE(opening);
    FrontierUtility utility{FrontierUtilityOptions{}};
    const auto f = measured(room(opening), utility);
    ASSERT_EQ(f.size(), 1U);
    EXPECT_EQ(f[0].area, utility.yield(f[0].expected_gain) * f[0].expected_gain);
    if (opening <= 2) {
      EXPECT_EQ(f[0].expected_gain, 0.0);
    }
    if (opening >= 6) {
      EXPECT_GT(f[0].expected_gain, before);
    }
    if (opening == 10) {  // about a half disc of steps, 1 m
      EXPECT_NEAR(f[0].expected_gain, 1.3, 0.3);
    }
    before = f[0].expected_gain;
  }
}

TEST(FrontierUtilityArea, IsAtMostAViewAndFallsWithTheConfidence) {
  GroundMap map(GridFrame{0.1, 0, 0, 200, 200});
  for (int j = 50; j < 150; ++j) {
    for (int i = 50; i < 150; ++i) map.set({i, j}, CellState::kFree);
  }
  FrontierUtility utility{FrontierUtilityOptions{}};
  auto f = measured(map, utility);
  ASSERT_EQ(f.size(), 1U);
  const double view = 0.5 * 16.0 * 1.047;
  EXPECT_NEAR(f[0].expected_gain, view, 1e-9);
  EXPECT_NEAR(f[0].area, view, 1e-9);
  for (const Cell c : f[0].cells) utility.visit_failed(c, {c}, 0.1);
  f = measured(map, utility);
  EXPECT_NEAR(f[0].expected_gain, view, 1e-9);
  EXPECT_NEAR(f[0].area, 0.5 * view, 1e-5);
}

TEST(FrontierUtilityArea, LearnsWhatFrontiersOfItsSizeHaveShown) {
  FrontierUtility utility{FrontierUtilityOptions{}};
  EXPECT_EQ(utility.yield(0.3), 0.5);
  EXPECT_EQ(utility.yield(3.0), 1.0);
  for (int k = 0; k < 30; ++k) utility.learn(0.3, 0.3, 0.0);
  EXPECT_NEAR(utility.yield(0.3), 0.05, 0.01);
  EXPECT_EQ(utility.yield(0.6), 0.5) << "nothing was learned of those";
  EXPECT_EQ(utility.yield(3.0), 1.0);
  for (int k = 0; k < 30; ++k) utility.learn(0.3, 0.3, 5.0);
  EXPECT_NEAR(utility.yield(0.3), 1.0, 0.01) << "at most what it promised";
  utility.learn(0.3, 0.0, 1.0);
  utility.learn(0.3, 0.3, std::nan(""));
  EXPECT_NEAR(utility.yield(0.3), 1.0, 0.01);
}

TEST(FrontierUtilityArea, RefusesOptionsByName) {
  const auto refused = [](auto change) -> std::string {
    FrontierUtilityOptions o;
    change(o);
    try {
      FrontierUtility utility(o);
      return "";
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
  };
  using O = FrontierUtilityOptions;
  EXPECT_NE(refused([](O& o) { o.depth = -1.0; }).find("depth"), std::string::npos);
  EXPECT_NE(refused([](O& o) { o.failed_observation = 1.0; }).find("failed_observation"),
            std::string::npos);
  EXPECT_NE(refused([](O& o) { o.failed_visit = 0.0; }).find("failed_visit"), std::string::npos);
  EXPECT_NE(refused([](O& o) { o.visit_radius = std::nan(""); }).find("visit_radius"),
            std::string::npos);
  EXPECT_NE(refused([](O& o) { o.view_margin = 4.0; }).find("view_margin"), std::string::npos);
  EXPECT_EQ(refused([](O&) {}), "");
}

}  // namespace
}  // namespace prospect::frontier_utility_test
