#include "engine/frontiers/frontier_worth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace prospect::frontier_worth_test {
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

class Worth : public ::testing::Test {
 protected:
  Worth() { worth_.map_changed(kFrame, {}, {}); }

  void look(const std::vector<Frontier>& f, const Pose& pose, int times) {
    for (const Frontier& one : f) {
      for (const Cell c : one.cells) map_[c] = 0;
    }
    for (int k = 0; k < times; ++k) worth_.look(map_, f, pose, clock_ += 0.5);
  }

  Grid<std::uint8_t> map_ = Grid<std::uint8_t>(kFrame, 1);  // nonzero: seen through
  FrontierWorth worth_{FrontierWorthOptions{}};
  double clock_ = 0.0;
};

TEST_F(Worth, ALookThatResolvesNothingLowersTheTrustInWhatWasInView) {
  const std::vector<Frontier> f{frontier(50, 50, 8), frontier(50, 5, 8), frontier(95, 50, 4)};
  look(f, at(3.2, 5.0, 0.0), 3);
  // The first cell hides the others of its row; to the side and out of range are not in view.
  EXPECT_EQ(worth_.trust({50, 50}), 0.125);
  EXPECT_EQ(worth_.trust({52, 50}), 1.0);
  EXPECT_EQ(worth_.trust({50, 5}), 1.0);
  EXPECT_EQ(worth_.trust({95, 50}), 1.0);
  // What others of its cluster promise more than it is led to instead.
  std::vector<float> ranges;
  worth_.look_ranges(f[0], ranges);
  ASSERT_EQ(ranges.size(), 8U);
  EXPECT_EQ(ranges[0], 0.0F);
  for (std::size_t n = 1; n < ranges.size(); ++n) EXPECT_EQ(ranges[n], 4.0F);
}

TEST_F(Worth, ALookFromFarTellsLess) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  look(f, at(2.05, 5.05, 0.0), 1);  // 3 m of 4 m
  EXPECT_NEAR(worth_.trust({50, 50}), std::sqrt(0.5), 1e-6);
  look(f, at(1.25, 5.05, 0.0), 10);  // 3.8 m: not in view
  EXPECT_NEAR(worth_.trust({50, 50}), std::sqrt(0.5), 1e-6);
}

TEST_F(Worth, WhatALookDidNotShowMustBeLookedAtFromNearer) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  std::vector<float> ranges;
  look(f, at(1.55, 5.05, 0.0), 1);  // from 3.5 m
  worth_.look_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.75 * 3.5, 1e-6);
  look(f, at(4.95, 5.05, 0.0), 1);  // from 0.1 m
  worth_.look_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.3, 1e-6);
  look(f, at(1.55, 5.05, 0.0), 1);  // from far again: that says nothing new
  worth_.look_ranges(f[0], ranges);
  EXPECT_NEAR(ranges[0], 0.3, 1e-6);
  // New ground beside it may open the view.
  worth_.map_changed(kFrame, {{51, 50}}, {{51, 50}});
  worth_.look_ranges(f[0], ranges);
  EXPECT_EQ(ranges[0], 4.0F);
}

TEST_F(Worth, AnObstacleOrTheUnknownHidesAFrontier) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{40, 50}] = 0;
  look(f, at(3.25, 5.05, 0.0), 6);
  EXPECT_EQ(worth_.trust({50, 50}), 1.0);
  map_[{40, 50}] = 1;
  look(f, at(3.25, 5.05, M_PI), 6);  // looking away
  EXPECT_EQ(worth_.trust({50, 50}), 1.0);
  look(f, at(3.25, 5.05, 2.0 * M_PI + 0.3), 1);
  EXPECT_EQ(worth_.trust({50, 50}), 0.5);
}

TEST_F(Worth, ALookFromAViewpointCountsWhateverLineLeadsThere) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{45, 50}] = 0;  // the line between the middles is blocked, another may not be
  worth_.look(map_, f, at(4.05, 5.05, 0.0), 1.0, Cell{50, 50});
  EXPECT_EQ(worth_.trust({50, 50}), 0.5);
  worth_.look(map_, f, at(4.05, 5.05, M_PI), 2.0, Cell{50, 50});  // looking away
  EXPECT_EQ(worth_.trust({50, 50}), 0.5);
}

TEST_F(Worth, FastReplanningDoesNotCountALookTwice) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  map_[{50, 50}] = 0;
  for (int k = 0; k < 12; ++k) worth_.look(map_, f, at(3.2, 5.05, 0.0), 0.1 * k);
  EXPECT_EQ(worth_.trust({50, 50}), 0.125);  // looks at 0, 0.4, 0.8; the fourth is at 1.2
}

TEST_F(Worth, NewGroundNearbyRenewsTheTrust) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  look(f, at(3.2, 5.05, 0.0), 4);
  worth_.map_changed(kFrame, {{53, 50}, {50, 47}}, {{53, 50}, {50, 47}});
  EXPECT_EQ(worth_.trust({50, 50}), 0.0625) << "three cells away";
  worth_.map_changed(kFrame, {{52, 52}}, {{52, 52}});
  EXPECT_EQ(worth_.trust({50, 50}), 1.0);
}

// Noise flips a cell for ever.
TEST_F(Worth, FlickeringCellsRenewItLessEachTime) {
  const std::vector<Frontier> f{frontier(50, 50, 1)};
  double most = 1.0;
  for (int k = 0; k < 6; ++k) {
    look(f, at(3.2, 5.05, 0.0), 8);
    worth_.map_changed(kFrame, {}, {{51, 50}});
    EXPECT_LE(worth_.trust({50, 50}), 0.5 * most);
    most = worth_.trust({50, 50});
  }
  EXPECT_LT(most, 0.02);
  EXPECT_EQ(worth_.trust({60, 60}), 1.0) << "nor does it raise trust";
}

TEST_F(Worth, AFailedVisitLowersItAroundTheTarget) {
  const Frontier f = frontier(20, 50, 30);
  worth_.visit_failed({25, 50}, f.cells, 0.1);
  EXPECT_NEAR(worth_.trust({25, 50}), 0.5, 1e-6);
  EXPECT_NEAR(worth_.trust({35, 50}), 0.5, 1e-6);
  EXPECT_EQ(worth_.trust({36, 50}), 1.0);
}

TEST_F(Worth, AMapThatGrowsKeepsWhatWasLearned) {
  worth_.visit_failed({25, 50}, {{25, 50}}, 0.1);
  worth_.map_changed({0.1, -40, -40, 200, 200}, {}, {});
  EXPECT_NEAR(worth_.trust({25, 50}), 0.5, 1e-6);
  EXPECT_EQ(worth_.trust({-30, -30}), 1.0);
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

std::vector<Frontier> measured(const GroundMap& map, FrontierWorth& worth) {
  Traversability t{TraversabilityOptions{}};
  t.update(map);
  FrontierDetector detector{FrontierOptions{}};
  detector.update(t);
  worth.map_changed(t.frame(), {}, {});
  detector.find_viewpoints(
      t, [&](const Frontier& one, std::vector<float>& ranges) { worth.look_ranges(one, ranges); });
  std::vector<Frontier> f = detector.frontiers();
  worth.measure(t, f);
  return f;
}

TEST(FrontierWorthArea, ADoorPromisesARoomAndASlitNothing) {
  double before = 0.0;
  for (const int opening : {2, 4, 6, 10, 20}) {
    SCOPED_TRACE(opening);
    FrontierWorth worth{FrontierWorthOptions{}};
    const auto f = measured(room(opening), worth);
    ASSERT_EQ(f.size(), 1U);
    EXPECT_EQ(f[0].area, worth.yield(f[0].promise) * f[0].promise);
    if (opening <= 2) {
      EXPECT_EQ(f[0].promise, 0.0);
    }
    if (opening >= 6) {
      EXPECT_GT(f[0].promise, before);
    }
    if (opening == 10) {  // about a half disc of steps, 1 m
      EXPECT_NEAR(f[0].promise, 1.3, 0.3);
    }
    before = f[0].promise;
  }
}

TEST(FrontierWorthArea, IsAtMostAViewAndFallsWithTheTrust) {
  GroundMap map(GridFrame{0.1, 0, 0, 200, 200});
  for (int j = 50; j < 150; ++j) {
    for (int i = 50; i < 150; ++i) map.set({i, j}, CellState::kFree);
  }
  FrontierWorth worth{FrontierWorthOptions{}};
  auto f = measured(map, worth);
  ASSERT_EQ(f.size(), 1U);
  const double view = 0.5 * 16.0 * 1.047;
  EXPECT_NEAR(f[0].promise, view, 1e-9);
  EXPECT_NEAR(f[0].area, view, 1e-9);
  for (const Cell c : f[0].cells) worth.visit_failed(c, {c}, 0.1);
  f = measured(map, worth);
  EXPECT_NEAR(f[0].promise, view, 1e-9);
  EXPECT_NEAR(f[0].area, 0.5 * view, 1e-5);
}

TEST(FrontierWorthArea, LearnsWhatFrontiersOfItsSizeHaveShown) {
  FrontierWorth worth{FrontierWorthOptions{}};
  EXPECT_EQ(worth.yield(0.3), 0.5);
  EXPECT_EQ(worth.yield(3.0), 1.0);
  for (int k = 0; k < 30; ++k) worth.learn(0.3, 0.3, 0.0);
  EXPECT_NEAR(worth.yield(0.3), 0.05, 0.01);
  EXPECT_EQ(worth.yield(0.6), 0.5) << "nothing was learned of those";
  EXPECT_EQ(worth.yield(3.0), 1.0);
  for (int k = 0; k < 30; ++k) worth.learn(0.3, 0.3, 5.0);
  EXPECT_NEAR(worth.yield(0.3), 1.0, 0.01) << "at most what it promised";
  worth.learn(0.3, 0.0, 1.0);
  worth.learn(0.3, 0.3, std::nan(""));
  EXPECT_NEAR(worth.yield(0.3), 1.0, 0.01);
}

TEST(FrontierWorthArea, RefusesOptionsByName) {
  const auto refused = [](auto change) -> std::string {
    FrontierWorthOptions o;
    change(o);
    try {
      FrontierWorth worth(o);
      return "";
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
  };
  using O = FrontierWorthOptions;
  EXPECT_NE(refused([](O& o) { o.depth = -1.0; }).find("depth"), std::string::npos);
  EXPECT_NE(refused([](O& o) { o.failed_look = 1.0; }).find("failed_look"), std::string::npos);
  EXPECT_NE(refused([](O& o) { o.failed_visit = 0.0; }).find("failed_visit"), std::string::npos);
  EXPECT_NE(refused([](O& o) { o.visit_radius = std::nan(""); }).find("visit_radius"),
            std::string::npos);
  EXPECT_NE(refused([](O& o) { o.look_margin = 4.0; }).find("look_margin"), std::string::npos);
  EXPECT_EQ(refused([](O&) {}), "");
}

}  // namespace
}  // namespace prospect::frontier_worth_test
