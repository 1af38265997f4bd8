#include "benchmarks/single_frontier_guide.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace prospect::single_frontier_guide_test {
namespace {

constexpr double kResolution = 0.1;

/// A corridor along x, 2 m wide, walls on both sides. Its west end, 2.5 m from the robot, opens on
/// unknown space over a gap of `west_cells`; its east end, 4 m away, over all of its width.
GroundMap corridor(int west_cells) {
  GroundMap map(GridFrame{kResolution, -60, -40, 160, 80});
  for (int j = -11; j <= 10; ++j) {
    for (int i = -25; i < 40; ++i) {
      const bool wall = j == -11 || j == 10 || (i == -25 && (j < -5 || j >= -5 + west_cells));
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

ExplorationGuideOptions guide_options() {
  ExplorationGuideOptions options;
  // Only frontiers at arm's length have viewpoints, so that distances are those of the path.
  options.frontiers.sensor_range = 1.3;
  options.memory.sensor_range = 1.3;
  return options;
}

bool leads_west(const Guidance& guidance) {
  EXPECT_TRUE(guidance.target.has_value());
  return guidance.target && guidance.target->viewpoint.x() < 0.0;
}

TEST(SingleFrontierGuide, DistancesAndLengthsAreThoseOfTheMap) {
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  guide.update(corridor(8), Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0);
  ASSERT_EQ(guide.options().size(), 2U);
  const FrontierOption* west = &guide.options()[0];
  const FrontierOption* east = &guide.options()[1];
  if (west->length > east->length) std::swap(west, east);
  EXPECT_NEAR(west->length, 0.8, 1e-9);
  EXPECT_NEAR(east->length, 2.0, 1e-9);
  // The way to a viewpoint and looking from there: never less than the way to where looking is
  // nearly free, never more than driving all the way at the price of narrow and unknown cells.
  EXPECT_GT(west->distance, 1.7);
  EXPECT_LT(west->distance, 2.5 * 1.5);
  EXPECT_GT(east->distance, 3.2);
  EXPECT_LT(east->distance, 4.0 * 1.5);
  EXPECT_NEAR(east->distance - west->distance, 1.5, 0.5);
}

TEST(SingleFrontierGuide, EachRuleLeadsToItsOwnChoice) {
  const Pose pose{{0.05, 0.05, 0.0}, 0.0};
  // 1.5 m farther, 1.2 m longer: 3 * 1.5 > 1.2, so both rules go west.
  EXPECT_TRUE(leads_west(*SingleFrontierGuide(FrontierRule::kNearest, guide_options())
                              .update(corridor(8), pose, 0.0)));
  EXPECT_TRUE(leads_west(*SingleFrontierGuide(FrontierRule::kCostUtility, guide_options())
                              .update(corridor(8), pose, 0.0)));
  // From 0.7 m further east the ends are about equally far, the west still a little nearer; the
  // longer one in the east is now worth it.
  const Pose between{{0.65, 0.05, 0.0}, 0.0};
  EXPECT_TRUE(leads_west(*SingleFrontierGuide(FrontierRule::kNearest, guide_options())
                              .update(corridor(8), between, 0.0)));
  EXPECT_FALSE(leads_west(*SingleFrontierGuide(FrontierRule::kCostUtility, guide_options())
                               .update(corridor(8), between, 0.0)));
}

TEST(SingleFrontierGuide, TheCostToGoLeadsToTheChosenFrontierAlone) {
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  const auto guidance = guide.update(corridor(8), Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0);
  const CostToGo& V = *guidance->cost_to_go;
  for (double x = -1.0; x < 3.5; x += 0.5) {
    EXPECT_LT(V.value(x, 0.05), V.value(x + 0.5, 0.05)) << "at x = " << x;
  }
}

TEST(SingleFrontierGuide, NearestHoldsItsChoiceUntilItIsResolved) {
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  GroundMap map = corridor(8);
  EXPECT_TRUE(leads_west(*guide.update(map, Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0)));
  EXPECT_EQ(guide.choices(), 1);
  // The east is nearer now, but the west is not resolved.
  EXPECT_TRUE(leads_west(*guide.update(map, Pose{{2.05, 0.05, 0.0}, 0.0}, 0.5)));
  EXPECT_EQ(guide.choices(), 1);
  for (int j = -6; j < 5; ++j) map.set({-26, j}, CellState::kOccupied);
  EXPECT_FALSE(leads_west(*guide.update(map, Pose{{2.05, 0.05, 0.0}, 0.0}, 1.0)));
  EXPECT_EQ(guide.choices(), 2);
}

TEST(SingleFrontierGuide, CostUtilityChoosesAnewEveryThreeSeconds) {
  SingleFrontierGuide guide(FrontierRule::kCostUtility, guide_options());
  const GroundMap map = corridor(8);
  EXPECT_TRUE(leads_west(*guide.update(map, Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0)));
  const Pose east{{2.05, 0.05, 0.0}, 0.0};
  EXPECT_TRUE(leads_west(*guide.update(map, east, 2.5)));
  EXPECT_EQ(guide.choices(), 1);
  EXPECT_FALSE(leads_west(*guide.update(map, east, 3.0)));
  EXPECT_EQ(guide.choices(), 2);
}

TEST(SingleFrontierGuide, NothingLeftIsDone) {
  GroundMap map = corridor(0);
  for (int j = -11; j <= 10; ++j) map.set({39, j}, CellState::kOccupied);
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  const auto guidance = guide.update(map, Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0);
  EXPECT_TRUE(guidance->facts.exhausted);
  EXPECT_FALSE(guidance->target.has_value());
}

TEST(SingleFrontierGuide, ANarrowGapIsTriedBeforeDone) {
  // A doorway of three cells, 0.15 m of clearance in its middle: it takes 0.21 m, or 0.11 m when
  // relaxed. Beyond it, unknown space that cannot be seen from here.
  GroundMap map = corridor(0);
  for (int j = -11; j <= 10; ++j) {
    map.set({39, j}, CellState::kOccupied);
    if (j < 2 || j > 4) map.set({20, j}, CellState::kOccupied);
  }
  for (int j = -5; j < 5; ++j) map.set({39, j}, CellState::kFree);
  const Pose pose{{0.05, 0.05, 0.0}, 0.0};
  for (const FrontierRule rule : {FrontierRule::kNearest, FrontierRule::kCostUtility}) {
    SingleFrontierGuide guide(rule, guide_options());
    const auto guidance = guide.update(map, pose, 0.0);
    EXPECT_FALSE(guidance->facts.exhausted);
    EXPECT_EQ(guidance->facts.search, Search::kNarrowPassages);
    ASSERT_TRUE(guidance->target.has_value());
    EXPECT_GT(guidance->target->viewpoint.x(), 2.1) << "beyond the doorway";
    ExplorationGuideOptions strict = guide_options();
    strict.relaxed_slack = 0.0;
    EXPECT_TRUE(SingleFrontierGuide(rule, strict).update(map, pose, 0.0)->facts.exhausted);
  }
}

TEST(SingleFrontierGuide, AFrontierThatCannotBeReachedAnyMoreIsGivenUp) {
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  GroundMap map = corridor(8);
  const Pose pose{{0.05, 0.05, 0.0}, 0.0};
  EXPECT_TRUE(leads_west(*guide.update(map, pose, 0.0)));
  for (int j = -11; j <= 10; ++j) map.set({-8, j}, CellState::kOccupied);
  EXPECT_FALSE(leads_west(*guide.update(map, pose, 0.5)));
  EXPECT_EQ(guide.choices(), 2);
}

TEST(SingleFrontierGuide, APoseThatIsNotFiniteGivesTheLastGuidance) {
  SingleFrontierGuide guide(FrontierRule::kNearest, guide_options());
  const GroundMap map = corridor(8);
  const auto first = guide.update(map, Pose{{0.05, 0.05, 0.0}, 0.0}, 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(guide.update(map, Pose{{nan, 0.0, 0.0}, 0.0}, 0.5), first);
}

}  // namespace
}  // namespace prospect::single_frontier_guide_test
