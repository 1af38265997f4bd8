#include "engine/exploration_guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "ground_worlds.h"
#include "models/make_model.h"
#include "simplest_driver.h"

namespace prospect::exploration_guide_test {
namespace {

// Cells that a robot from `start` can see: within 3.7 m of a cell that it can drive to, by a free
// line of the true plan.
int visible_cells(const test::GroundWorld& world, Cell start) {
  GroundMap map(world.truth.frame);
  for (int k = 0; k < world.truth.frame.size(); ++k) {
    map.set(world.truth.frame.at(k), world.truth.data[static_cast<std::size_t>(k)]);
  }
  Traversability t{TraversabilityOptions{}};
  t.update(map);
  Grid<std::uint8_t> seen(world.truth.frame, 0), driven(world.truth.frame, 0);
  std::vector<Cell> stack{start};
  driven[start] = 1;
  GroundMap sight(world.truth.frame);
  while (!stack.empty()) {
    const Cell c = stack.back();
    stack.pop_back();
    if ((c.i + c.j) % 4 == 0) {
      const Eigen::Vector2d p = world.truth.frame.center(c);
      world.sense({{p.x(), p.y(), 0.0}, 0.0}, 3.5, 2.0 * M_PI, sight);
    }
    for (const Cell n :
         {Cell{c.i - 1, c.j}, Cell{c.i + 1, c.j}, Cell{c.i, c.j - 1}, Cell{c.i, c.j + 1}}) {
      if (!t.passable(n) || driven[n] != 0) continue;
      driven[n] = 1;
      stack.push_back(n);
    }
  }
  return sight.free_cells();
}

struct Mission {
  bool done = false;
  double coverage = 0.0;
  int steps = 0;
  double p50 = 0.0, p95 = 0.0;
  int retries = 0;
};

// With the simplest driver.
Mission explore(const test::GroundWorld& world, Cell start, const ExplorationGuideOptions& options,
                int limit) {
  GroundMap map(GridFrame{world.truth.frame.resolution, start.i, start.j, 1, 1});
  ExplorationGuide guide(options);
  const Eigen::Vector2d p0 = world.truth.frame.center(start);
  Pose pose{{p0.x(), p0.y(), 0.0}, 0.0};
  std::vector<double> times;
  Mission mission;
  for (; mission.steps < limit; ++mission.steps) {
    world.sense(pose, 4.0, 1.05, map);
    const auto g = guide.update(map, pose, 0.5 * mission.steps);
    times.push_back(g->milliseconds);
    mission.retries = std::max(mission.retries, g->retries_used);
    if (g->facts.exhausted) {
      mission.done = true;
      break;
    }
    if (!g->target) continue;  // reactivated: sources appear with the next update
    test::follow(*g, pose);
  }
  mission.coverage = static_cast<double>(map.free_cells()) / visible_cells(world, start);
  std::sort(times.begin(), times.end());
  mission.p50 = times[times.size() / 2];
  mission.p95 = times[times.size() * 95 / 100];
  return mission;
}

TEST(ExplorationGuide, LeadsTheSimplestDriverThroughWholeBuildings) {
  std::mt19937_64 random(11);
  for (const int boxes : {0, 25, 60}) {
    const auto world = test::GroundWorld::rooms(12.0, 0.1, boxes, random);
    const Cell start = world.open_cell(4, random);
    const Mission m = explore(world, start, ExplorationGuideOptions{}, 6000);
    EXPECT_TRUE(m.done) << boxes;
    EXPECT_GT(m.coverage, 0.99) << boxes;
    RecordProperty("p50_ms", std::to_string(m.p50));
    RecordProperty("p95_ms", std::to_string(m.p95));
  }
}

TEST(ExplorationGuide, TheSameHistoryGivesTheSameBits) {
  std::mt19937_64 random(12);
  const auto world = test::GroundWorld::rooms(12.0, 0.1, 20, random);
  ExplorationGuide a{ExplorationGuideOptions{}}, b{ExplorationGuideOptions{}};
  GroundMap map(GridFrame{0.1, 0, 0, 1, 1});
  for (int step = 0; step < 20; ++step) {
    const Cell c = world.open_cell(3, random);
    const Eigen::Vector2d p = world.truth.frame.center(c);
    const Pose pose{{p.x(), p.y(), 0.0}, 0.3 * step};
    world.sense(pose, 4.0, 1.05, map);
    const auto ga = a.update(map, pose, 0.5 * step), gb = b.update(map, pose, 0.5 * step);
    ASSERT_EQ(ga->cost_to_go->cells().data, gb->cost_to_go->cells().data);
    ASSERT_EQ(ga->target.has_value(), gb->target.has_value());
    if (ga->target) {
      ASSERT_EQ(ga->target->viewpoint, gb->target->viewpoint);
      const Frontier& f = ga->frontiers[static_cast<std::size_t>(ga->target->frontier)];
      EXPECT_TRUE(f.active && f.reachable);
    }
  }
}

// What a robot hands over that projects its own map at each step: the part that is known, in a map
// made anew. Another time it comes with other revisions, another frame, or twice.
TEST(ExplorationGuide, AMapProjectedAnewLeadsWhereOneThatIsKeptDoes) {
  std::mt19937_64 random(13);
  const auto world = test::GroundWorld::rooms(12.0, 0.1, 20, random);
  const Cell start = world.open_cell(4, random);
  GroundMap map(GridFrame{0.1, start.i, start.j, 1, 1});
  ExplorationGuide kept{ExplorationGuideOptions{}}, anew{ExplorationGuideOptions{}};
  const Eigen::Vector2d p0 = world.truth.frame.center(start);
  Pose pose{{p0.x(), p0.y(), 0.0}, 0.0};
  double explored = 0.0;
  for (int step = 0; step < 150; ++step) {
    world.sense(pose, 4.0, 1.05, map);
    int low[2] = {1 << 20, 1 << 20}, high[2] = {-(1 << 20), -(1 << 20)};
    for (int k = 0; k < map.frame().size(); ++k) {
      const Cell c = map.frame().at(k);
      if (!map.explored(c)) continue;
      low[0] = std::min(low[0], c.i), high[0] = std::max(high[0], c.i);
      low[1] = std::min(low[1], c.j), high[1] = std::max(high[1], c.j);
    }
    // Some maps are wider for no reason, the next is not.
    const int spare = step % 7 == 3 ? 40 : 0;
    GroundMap projected(GridFrame{0.1, low[0] - spare, low[1], high[0] - low[0] + 1 + 2 * spare,
                                  high[1] - low[1] + 1});
    for (int k = projected.frame().size() - 1; k >= 0; --k) {
      const Cell c = projected.frame().at(k);
      projected.set(c, map.state(c), map.see_through(c));
    }
    const auto a = kept.update(map, pose, 0.5 * step);
    const auto b = anew.update(projected, pose, 0.5 * step);
    ASSERT_EQ(a->explored_area, b->explored_area) << step;
    ASSERT_EQ(a->facts.exhausted, b->facts.exhausted) << step;
    ASSERT_EQ(a->facts.stalled_for, b->facts.stalled_for) << step;
    ASSERT_EQ(a->cost_to_go->cells().data, b->cost_to_go->cells().data) << step;
    ASSERT_EQ(a->frontiers.size(), b->frontiers.size());
    ASSERT_EQ(a->target.has_value(), b->target.has_value());
    if (a->target) {
      ASSERT_EQ(a->target->viewpoint, b->target->viewpoint);
      test::follow(*a, pose);
    }
    explored = b->explored_area;
  }
  EXPECT_GT(explored, 60.0);
}

TEST(ExplorationGuide, BeginsAnewOnAMapOfAnotherPlaceOrResolution) {
  std::mt19937_64 random(14);
  ExplorationGuide guide{ExplorationGuideOptions{}};
  double stamp = 0.0;
  for (const double r : {0.1, 0.05, 0.1}) {
    const auto world = test::GroundWorld::rooms(8.0, r, 5, random);
    const Cell start = world.open_cell(6, random);
    const Eigen::Vector2d p = world.truth.frame.center(start);
    Pose pose{{p.x(), p.y(), 0.0}, 0.0};
    GroundMap map(world.truth.frame);
    ExplorationGuide fresh{ExplorationGuideOptions{}};
    for (int step = 0; step < 10; ++step, stamp += 0.5) {
      world.sense(pose, 4.0, 1.05, map);
      const auto g = guide.update(map, pose, stamp), f = fresh.update(map, pose, stamp);
      ASSERT_EQ(g->explored_area, f->explored_area);
      ASSERT_EQ(g->facts.exhausted, f->facts.exhausted);
      ASSERT_EQ(g->cost_to_go->cells().data, f->cost_to_go->cells().data);
      if (g->target) test::follow(*g, pose);
    }
  }
}

// A snapshot handed out does not change under its holder.
TEST(ExplorationGuide, GuidanceIsImmutable) {
  GroundMap map(GridFrame{0.1, 0, 0, 64, 64});
  for (int j = 10; j < 40; ++j) {
    for (int i = 10; i < 40; ++i) map.set({i, j}, CellState::kFree);
  }
  ExplorationGuide guide{ExplorationGuideOptions{}};
  const auto first = guide.update(map, {{2.0, 2.0, 0.0}, 0.0}, 0.0);
  const auto cells = first->cost_to_go->cells().data;
  const auto frontiers = first->frontiers.size();
  for (int j = 10; j < 40; ++j) map.set({25, j}, CellState::kOccupied);
  guide.update(map, {{2.0, 2.0, 0.0}, 0.0}, 0.5);
  EXPECT_EQ(first->cost_to_go->cells().data, cells);
  EXPECT_EQ(first->frontiers.size(), frontiers);
}

bool narrow(const Guidance& g) { return g.facts.search == Search::kNarrowPassages; }

TEST(ExplorationGuide, FrontiersBehindAWallAreActiveButNotReachable) {
  GroundMap map(GridFrame{0.1, 0, 0, 96, 64});
  for (int j = 5; j < 50; ++j) {
    for (int i = 5; i < 90; ++i) {
      const bool rim = i < 7 || j < 7 || j > 47 || (i > 38 && i < 42);
      map.set({i, j}, rim ? CellState::kOccupied : CellState::kFree);
    }
  }
  ExplorationGuide guide(ExplorationGuideOptions{});
  const auto g = guide.update(map, {{2.0, 2.0, 0.0}, 0.0}, 0.0);
  int active = 0, reachable = 0;
  for (const Frontier& f : g->frontiers) active += f.active, reachable += f.reachable;
  EXPECT_EQ(active, 1);
  EXPECT_EQ(reachable, 0);
  EXPECT_FALSE(g->target.has_value());
  EXPECT_TRUE(g->facts.exhausted);
}

// Two closed rooms, joined by a doorway of `door` cells. The far end of the second is unknown, too
// far from the first to be seen from there.
GroundMap two_rooms(int door) {
  GroundMap map(GridFrame{0.1, 0, 0, 160, 64});
  for (int j = 5; j < 50; ++j) {
    for (int i = 5; i < 110; ++i) {
      const bool in_door = j >= 25 && j < 25 + door;
      const bool wall = i < 7 || j < 7 || j > 47 || (i > 38 && i < 42 && !in_door);
      map.set({i, j}, wall ? CellState::kOccupied : CellState::kFree);
    }
  }
  return map;
}

TEST(ExplorationGuide, ADoorwayTooNarrowForTheHardRadiusIsTriedBeforeDone) {
  const Pose pose{{2.0, 2.0, 0.0}, 0.0};
  // Cells, and the clearance in the middle: 0.05, 0.05, 0.15, 0.15, 0.25 m. It takes 0.21 m, or
  // 0.11 m when relaxed.
  for (int door = 1; door <= 5; ++door) {
    SCOPED_TRACE(door);
    const GroundMap map = two_rooms(door);
    ExplorationGuide guide(ExplorationGuideOptions{});
    const auto g = guide.update(map, pose, 0.0);
    const bool open = door >= 3;
    EXPECT_EQ(g->facts.exhausted, !open);
    ASSERT_EQ(g->target.has_value(), open);
    EXPECT_EQ(narrow(*g), door < 5) << "also a passage that stays shut has been asked about twice";
    if (open) {
      EXPECT_GT(g->target->viewpoint.x(), 4.2) << "beyond the door";
      EXPECT_GT(g->target->looks_at.x(), 10.5);
      EXPECT_TRUE(std::isfinite(g->cost_to_go->value(2.0, 2.0)));
    }
  }
  ExplorationGuideOptions strict = ExplorationGuideOptions{};
  strict.relaxed_slack = 0.0;
  ExplorationGuide guide(strict);
  EXPECT_TRUE(guide.update(two_rooms(3), pose, 0.0)->facts.exhausted);
}

// geb079, seed 6: by area a robot turned into a gap of 0.4 m, 0.04 m wider than itself, with half
// of a wide corridor unseen, touched what was beside it and was enclosed.
TEST(ExplorationGuide, AreasBeyondNarrowPlacesCountForNothing) {
  // Three rooms, open at both ends. To the west a door of 0.5 m, which leaves 0.04 m more than it
  // takes, to the east, and farther, one of 0.8 m.
  GroundMap map(GridFrame{0.1, 0, 0, 192, 64});
  for (int j = 5; j < 50; ++j) {
    for (int i = 5; i < 150; ++i) {
      const bool west = i > 38 && i < 42 && (j < 25 || j >= 30);
      const bool east = i > 98 && i < 102 && (j < 25 || j >= 33);
      map.set({i, j}, j < 7 || j > 47 || west || east ? CellState::kOccupied : CellState::kFree);
    }
  }
  const auto leads = [&](double kappa_area, double ample_room, double x) {
    ExplorationGuideOptions options = ExplorationGuideOptions{};
    options.kappa_area = kappa_area;
    options.ample_room = ample_room;
    const auto g = ExplorationGuide(options).update(map, {{x, 2.75, 0.0}, 0.0}, 0.0);
    return g->target ? g->target->looks_at.x() : -1.0;
  };
  EXPECT_LT(leads(0.0, 0.1, 5.0), 1.0) << "the nearest";
  EXPECT_LT(leads(4.0, 0.0, 5.0), 1.0) << "both promise alike";
  EXPECT_GT(leads(4.0, 0.1, 5.0), 14.0) << "what a wide way leads to";
  // On its way through the narrow door the robot belongs to the side that is nearer.
  EXPECT_LT(leads(4.0, 0.1, 3.8), 1.0);

  // Narrow places are led to when they are what is left.
  for (int j = 5; j < 50; ++j) map.set({149, j}, CellState::kOccupied);
  EXPECT_LT(leads(4.0, 0.1, 5.0), 1.0);
}

// fr_079, seed 6: walls that a drifting estimate drew shut a robot up in a nook, and the mission
// ended as explored with nine tenths seen.
TEST(ExplorationGuide, SaysWhetherTheRobotIsCutOffFromWhereItWas) {
  const auto from_second_to_first_room = [](ExplorationGuide& guide, double lost_until) {
    std::shared_ptr<const Guidance> g;
    double t = 0.0;
    for (double x = 8.0; x > 2.05; x -= 0.25, t += 0.5) {
      GuideAttention attention;
      attention.looked = x <= lost_until;
      g = guide.update(two_rooms(10), {{x, 3.0, 0.0}, 0.0}, t, attention);
      EXPECT_FALSE(g->facts.exhausted);
      EXPECT_FALSE(g->facts.cut_off);
    }
    return g;
  };
  const Pose inside{{2.0, 3.0, 0.0}, 0.0};
  GroundMap shut = two_rooms(10);
  for (int j = 25; j < 35; ++j) shut.set({40, j}, CellState::kOccupied);

  ExplorationGuide guide(ExplorationGuideOptions{});
  from_second_to_first_room(guide, 8.0);
  const auto g = guide.update(shut, inside, 100.0);
  EXPECT_TRUE(g->facts.exhausted);
  EXPECT_TRUE(g->facts.cut_off);

  // Where it was lost, it does not know that it has been.
  ExplorationGuide lost(ExplorationGuideOptions{});
  from_second_to_first_room(lost, 4.0);
  EXPECT_FALSE(lost.update(shut, inside, 100.0)->facts.cut_off);

  // A robot in a wall, as drawn, is joined to nothing.
  for (int j = 15; j < 45; ++j) {
    for (int i = 7; i < 38; ++i) shut.set({i, j}, CellState::kOccupied);
  }
  const auto in_wall = guide.update(shut, inside, 101.0);
  EXPECT_TRUE(in_wall->facts.exhausted);
  EXPECT_TRUE(in_wall->facts.cut_off);

  // One that came from nowhere else has explored what it could reach.
  ExplorationGuide here(ExplorationGuideOptions{});
  const auto done = here.update(two_rooms(0), inside, 0.0);
  EXPECT_TRUE(done->facts.exhausted);
  EXPECT_FALSE(done->facts.cut_off);
}

// Else every part of every frontier behind the gap would be given up in turn, 8 s each.
TEST(ExplorationGuide, AGapThatCannotBePassedIsClosedAndTriedOnceMore) {
  const GroundMap map = two_rooms(3);
  ExplorationGuide guide(ExplorationGuideOptions{});
  const Pose pose{{3.0, 2.65, 0.0}, 0.0};  // held up before the doorway
  double done = 0.0;
  for (double t = 0.0; t < 30.0 && done == 0.0; t += 0.5) {
    const auto g = guide.update(map, pose, t);
    EXPECT_EQ(g->target.has_value(), t < 16.0) << t;
    if (g->facts.exhausted) done = t;
  }
  EXPECT_EQ(done, 16.0);
  EXPECT_FALSE(guide.traversability().passable({40, 26}));
}

TEST(ExplorationGuide, AShortFrontierIsLookedAtBeforeNothingIsLeft) {
  // A room with a window of 1 to 3 cells in its east wall, and nothing else left to see.
  for (int window = 1; window <= 3; ++window) {
    SCOPED_TRACE(window);
    GroundMap map(GridFrame{0.1, 0, 0, 60, 60});
    for (int j = 5; j < 55; ++j) {
      for (int i = 5; i < 50; ++i) {
        const bool edge = i == 5 || j == 5 || i == 49 || j == 54;
        const bool open = i == 49 && j >= 30 && j < 30 + window;
        map.set({i, j}, edge && !open ? CellState::kOccupied : CellState::kFree);
      }
    }
    const Pose pose{{2.0, 2.0, 0.0}, 3.0};  // looks away
    ExplorationGuide guide(ExplorationGuideOptions{});
    const auto g = guide.update(map, pose, 0.0);
    EXPECT_EQ(g->target.has_value(), window >= 2) << "0.2 m on";
    EXPECT_EQ(narrow(*g), window < 2) << "short frontiers come before narrow passages";
    ExplorationGuideOptions strict = ExplorationGuideOptions{};
    strict.relaxed_length = strict.frontiers.min_length;
    ExplorationGuide never(strict);
    EXPECT_TRUE(never.update(map, pose, 0.0)->facts.exhausted);
  }
}

// A cell that noise fills in a narrow passage, for a moment, is not the end.
TEST(ExplorationGuide, SaysForHowLongNothingWasReachable) {
  GroundMap map = two_rooms(7);
  const Pose pose{{2.0, 2.0, 0.0}, 0.0};
  ExplorationGuide guide{ExplorationGuideOptions{}};
  double t = 0.0;
  EXPECT_FALSE(guide.update(map, pose, t)->facts.exhausted);
  const auto shut = [&](bool closed) {
    for (int j = 20; j < 35; ++j) {
      if (map.state({40, j}) == CellState::kUnknown) continue;
      map.set({40, j}, closed ? CellState::kOccupied : two_rooms(7).state({40, j}));
    }
  };
  shut(true);
  for (int n = 0; n < 4; ++n) {
    const auto g = guide.update(map, pose, t += 0.5);
    EXPECT_TRUE(g->facts.exhausted);
    EXPECT_EQ(g->facts.exhausted_for, 0.5 * n);
    EXPECT_FALSE(g->target.has_value());
  }
  shut(false);
  EXPECT_FALSE(guide.update(map, pose, t += 0.5)->facts.exhausted);
  // Not counting the time in which the robot retreats.
  shut(true);
  for (int n = 0; n < 20; ++n) {
    const auto g = guide.update(map, pose, t += 0.5, {.pursued = n < 4 || n >= 10});
    EXPECT_EQ(g->facts.exhausted_for, 0.5 * (n < 4 ? n : std::max(3, n - 6))) << n;
  }
}

// An estimate that drifts draws new frontiers for ever. A tenth more of the building has more than
// a low yield.
TEST(ExplorationGuide, SaysWhenLowYieldFrontiersTakeTooLong) {
  for (const int grown_rows : {0, 2, 12}) {
    SCOPED_TRACE(grown_rows);
    GroundMap map = two_rooms(7);
    const Pose pose{{2.0, 2.0, 0.0}, 0.0};
    ExplorationGuideOptions options = ExplorationGuideOptions{};
    options.low_yield.share = 0.7;
    options.low_yield.least = 60.0;
    ExplorationGuide guide(options);
    double t = 0.0;
    for (; t < 100.0; t += 0.5) {
      // An ordinary frontier for 100 s, which noise keeps alive; then only a short one.
      map.set({110, 20 + static_cast<int>(t) % 20}, CellState::kFree);
      const auto g = guide.update(map, pose, t, {.looked = false, .pursued = false});
      ASSERT_FALSE(g->facts.exhausted) << t;
    }
    for (int j = 7; j < 48; ++j) {
      for (int i = 42; i < 125; ++i) {
        if (map.frame().contains({i, j}) && map.state({i, j}) == CellState::kUnknown) {
          map.set({i, j}, CellState::kOccupied);
        }
      }
    }
    for (int j = 26; j < 29; ++j) map.set({110, j}, CellState::kUnknown);
    const double begin = t, growth = t + 30.0;
    double done = 0.0;
    for (; t < 400.0 && done == 0.0; t += 0.5) {
      if (t == growth) {
        for (int j = 50; j < 50 + grown_rows; ++j) {
          for (int i = 5; i < 110; ++i) map.set({i, j}, CellState::kFree);
        }
      }
      const auto g = guide.update(map, pose, t, {.looked = false, .pursued = false});
      if (g->facts.yield_too_low) {
        EXPECT_TRUE(g->target.has_value());
        done = t;
      }
    }
    // 0.7 of 100 s; after 30 s of them at least 60 s more.
    EXPECT_NEAR(done, grown_rows == 12 ? growth + 60.0 : 1.7 * begin, 1.0);
  }
}

// A robot that is lost adds nothing to its map, so nothing that it faces can be resolved; one that
// recovers turns and retreats, so it comes no nearer to its target.
TEST(ExplorationGuide, ALostRobotGivesNothingUp) {
  const GroundMap map = two_rooms(7);
  const Pose pose{{3.0, 2.65, 0.0}, 0.0};
  ExplorationGuide lost{ExplorationGuideOptions{}}, well{ExplorationGuideOptions{}};
  int given_up = 0;
  for (double t = 0.0; t < 60.0; t += 0.5) {
    const auto g = lost.update(map, pose, t, {.looked = false, .pursued = false});
    EXPECT_FALSE(g->facts.exhausted);
    EXPECT_EQ(g->suppressed_cells, 0);
    EXPECT_EQ(g->facts.stalled_for, 0.0);
    given_up = std::max(given_up, well.update(map, pose, t)->suppressed_cells);
  }
  EXPECT_GT(given_up, 0);
  // Once it pursues again, the clock runs on from where it was held.
  for (double t = 60.0; t < 67.5; t += 0.5) {
    const auto g = lost.update(map, pose, t, {.looked = false});
    EXPECT_EQ(g->suppressed_cells, 0);
    EXPECT_FALSE(g->facts.exhausted);
    EXPECT_EQ(g->facts.stalled, g->facts.stalled_for >= 3.0);
  }
  EXPECT_GT(lost.update(map, pose, 67.5, {.looked = false})->suppressed_cells, 0);
}

/// A free strip along x, 11 m by 2 m, with unknown space at both ends; landmarks on its walls west
/// of x = 5.5 only.
struct HalfWhiteStrip {
  Belief belief;
  GroundMap map{GridFrame{0.1, 0, 0, 130, 40}};

  HalfWhiteStrip() {
    auto voxels = std::make_shared<VoxelGrid>(map.frame(), 0.0, 1.2);
    LandmarkMap landmarks;
    for (int i = 10; i < 120; ++i) {
      for (int j = 10; j < 31; ++j) {
        const CellState state = j == 10 || j == 30 ? CellState::kOccupied : CellState::kFree;
        map.set({i, j}, state);
        for (int k = 0; k < 12; ++k) voxels->set(i, j, k, state);
        if (state != CellState::kOccupied || i > 55) continue;
        Landmark l;
        l.id = static_cast<std::uint64_t>(1000 * i + j);
        l.position = {0.1 * i + 0.05, j == 10 ? 1.1 : 3.0, 0.5};
        l.creation_direction = {0.0, j == 10 ? 1.0 : -1.0, 0.0};
        landmarks.landmarks.push_back(l);
      }
    }
    belief.voxels = voxels;
    belief.ground = std::make_shared<const GroundMap>(map);
    belief.landmarks = std::make_shared<const LandmarkMap>(landmarks);
  }
};

TEST(ExplorationGuide, AWayOnWhichNothingIsSeenIsDearer) {
  const HalfWhiteStrip strip;
  ExplorationGuideOptions options = ExplorationGuideOptions{};
  options.frontiers.sensor_range = options.memory.sensor_range = 1.5;
  RobotDescription robot;
  robot.model = make_model("unicycle");
  FeatureOutlook outlook({.blocks_per_update = 10000}, robot, with_landmarks_made_anew());
  outlook.update(strip.belief, 0.0);
  // Nearer to the white end.
  const Pose pose{{7.3, 2.0, 0.0}, 0.0};
  const auto leads_east = [&](double lambda, const FeatureOutlook* seen) {
    options.cost_to_go.lambda = lambda;
    ExplorationGuide guide(options);
    std::shared_ptr<const Guidance> g;
    for (int n = 0; n < 3; ++n) {
      g = guide.update(strip.map, pose, 0.1 * n, {.looked = false}, seen);
    }
    EXPECT_TRUE(g->target.has_value());
    return g->target && g->target->viewpoint.x() > 6.5;
  };
  EXPECT_TRUE(leads_east(0.0, &outlook));
  EXPECT_TRUE(leads_east(3.0, nullptr));
  EXPECT_FALSE(leads_east(3.0, &outlook));
  EXPECT_TRUE(leads_east(0.05, &outlook)) << "dearer, not closed";
}

TEST(ExplorationGuide, ATargetThatCostTheLocalizationIsPutOff) {
  const HalfWhiteStrip strip;
  ExplorationGuideOptions options = ExplorationGuideOptions{};
  options.frontiers.sensor_range = options.memory.sensor_range = 1.5;
  ExplorationGuide guide(options);
  const Pose pose{{7.3, 2.0, 0.0}, 0.0};
  const auto east = [](const Guidance& g) { return g.target && g.target->viewpoint.x() > 6.5; };
  ASSERT_TRUE(east(*guide.update(strip.map, pose, 0.0)));
  const GuideAttention lost{.looked = false, .pursued = false, .got_lost = true};
  const auto put_off = guide.update(strip.map, pose, 0.1, lost);
  EXPECT_TRUE(put_off->target.has_value());
  EXPECT_FALSE(east(*put_off));
  EXPECT_GT(put_off->suppressed_cells, 0);
  // It stays so, until the other way is gone, too.
  EXPECT_FALSE(east(*guide.update(strip.map, pose, 0.2)));
  guide.update(strip.map, pose, 0.3, lost);
  EXPECT_TRUE(east(*guide.update(strip.map, pose, 0.4)));
}

TEST(ExplorationGuide, GoesBackToTheStrictRadiiWhenSomethingNewWasExplored) {
  const ExplorationGuideOptions options;
  GroundMap map = two_rooms(3);
  ExplorationGuide guide(options);
  Pose pose{{2.0, 2.0, 0.0}, 0.0};
  double stamp = 0.0;
  ASSERT_TRUE(narrow(*guide.update(map, pose, stamp)));
  // Beyond the door the strict radii would do, but nothing was explored yet.
  pose.position.x() = 6.0;
  for (int n = 0; n < 3; ++n) {
    const auto g = guide.update(map, pose, stamp += 0.5);
    EXPECT_TRUE(narrow(*g));
    EXPECT_TRUE(g->target.has_value());
  }
  // Two columns of 41 cells: 0.82 m^2 of the 1 m^2.
  ASSERT_EQ(options.memory.retry_area, 1.0);
  const auto explore_column = [&](int i) {
    for (int j = 7; j < 48; ++j) map.set({i, j}, CellState::kFree);
  };
  explore_column(110);
  explore_column(111);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(narrow(*guide.update(map, pose, stamp += 0.5)));
  explore_column(112);
  guide.update(map, pose, stamp += 0.5);
  const auto g = guide.update(map, pose, stamp += 0.5);
  EXPECT_FALSE(narrow(*g));
  ASSERT_TRUE(g->target.has_value());
  EXPECT_FALSE(g->facts.exhausted);
  EXPECT_FALSE(guide.traversability().passable({40, 26})) << "the doorway is shut again";
  // The result is that of a guide that has always been strict.
  ExplorationGuide fresh(options);
  const auto f = fresh.update(map, pose, 0.0);
  EXPECT_FALSE(narrow(*f));
  EXPECT_EQ(f->frontiers.size(), g->frontiers.size());
  EXPECT_EQ(f->explored_area, g->explored_area);
  // Back in the first room it is needed again.
  pose.position.x() = 2.0;
  const auto back = guide.update(map, pose, stamp += 0.5);
  EXPECT_TRUE(narrow(*back));
  EXPECT_TRUE(back->target.has_value());
}

TEST(ExplorationGuide, ABonusRuleDecidesWhichFrontiersAreLedTo) {
  // A free strip with unknown space at both ends; the robot is nearer to the west.
  GroundMap map(GridFrame{0.1, 0, 0, 120, 40});
  for (int j = 10; j < 31; ++j) {
    for (int i = 10; i < 100; ++i) {
      map.set({i, j}, j == 10 || j == 30 ? CellState::kOccupied : CellState::kFree);
    }
  }
  const Pose pose{{4.0, 2.0, 0.0}, 0.0};
  ExplorationGuideOptions options = ExplorationGuideOptions{};
  options.frontiers.sensor_range = options.memory.sensor_range = 1.5;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  int asked = 0;
  const auto only = [&](bool east, bool after_refusal) {
    return [&asked, east, after_refusal](const BonusQuestion& question) {
      ++asked;
      std::vector<double> bonus;
      for (const Frontier& f : question.detector.frontiers()) {
        const bool there = question.detector.frame().center(f.cells.front()).x() > 5.5;
        const bool refused = after_refusal && !question.unreached;
        bonus.push_back(there == east && !refused ? 0.0 : -kInfinity);
      }
      return bonus;
    };
  };
  for (const bool east : {false, true}) {
    for (const bool after_refusal : {false, true}) {
      asked = 0;
      ExplorationGuide guide(options);
      const auto g = guide.update(map, pose, 0.0, {}, nullptr, only(east, after_refusal));
      ASSERT_TRUE(g->target.has_value());
      EXPECT_EQ(g->target->viewpoint.x() > 5.5, east);
      EXPECT_EQ(asked, after_refusal ? 2 : 1);
      for (const Frontier& f : g->frontiers) EXPECT_EQ(f.active, f.reachable);
    }
  }
  ExplorationGuide guide(options);
  const auto none = [](const BonusQuestion& question) {
    return std::vector<double>(question.detector.frontiers().size(), -kInfinity);
  };
  EXPECT_TRUE(guide.update(map, pose, 0.0, {}, nullptr, none)->facts.exhausted);
}

TEST(ExplorationGuide, ByAreaARoomFartherOffComesBeforeASliverNearBy) {
  // A closed room of 6 m by 4 m, the robot in its middle; 2 m west of it the floor along the wall
  // is unknown over 2 m, two cells wide, and 2.5 m east a door of 1 m has unknown ground behind it.
  GroundMap map = test::known_room(96, [](int j) { return j >= 22 && j < 32; });
  for (int j = 16; j < 36; ++j) {
    for (const int i : {8, 9}) map.set({i, j}, CellState::kUnknown);
  }
  const Pose pose{{3.3, 2.7, 0.0}, 0.5 * M_PI};
  for (const double kappa_area : {0.0, 2.5}) {
    ExplorationGuideOptions options = ExplorationGuideOptions{};
    options.kappa_area = kappa_area;
    options.frontiers.sensor_range = options.memory.sensor_range = 1.5;
    ExplorationGuide guide(options);
    const auto g = guide.update(map, pose, 0.0);
    ASSERT_TRUE(g->target.has_value());
    EXPECT_EQ(g->target->looks_at.x() > 6.0, kappa_area > 0.0);
  }
}

// What is left when the strict rules lead nowhere is slivers, and what a drifting estimate drew.
TEST(ExplorationGuide, AreasCountUnderTheStrictRulesOnly) {
  // A closed room with two spots too short for the strict rules, one by the wall near the robot,
  // which promises nothing, and one of 0.04 m^2 on the open floor, 3 m away.
  GroundMap map = test::known_room(96, [](int) { return false; });
  for (const int j : {20, 21}) map.set({8, j}, CellState::kUnknown);
  for (const int j : {26, 27}) {
    for (const int i : {50, 51}) map.set({i, j}, CellState::kUnknown);
  }
  const Pose pose{{2.0, 2.1, 0.0}, 0.5 * M_PI};
  ExplorationGuideOptions options = ExplorationGuideOptions{};
  options.kappa_area = 90.0;  // 3.5 m for the second
  const auto weaker = ExplorationGuide(options).update(map, pose, 0.0);
  ASSERT_TRUE(weaker->target.has_value());
  EXPECT_LT(weaker->target->looks_at.x(), 2.0);
  options.frontiers.min_length = options.relaxed_length;
  const auto strict = ExplorationGuide(options).update(map, pose, 0.0);
  ASSERT_TRUE(strict->target.has_value());
  EXPECT_GT(strict->target->looks_at.x(), 4.0);
}

TEST(ExplorationGuide, DegenerateMapsAndPoses) {
  const double nan = std::nan("");
  for (const int kind : {0, 1, 2}) {
    GroundMap map(GridFrame{0.1, 0, 0, 32, 32});
    for (int k = 0; kind > 0 && k < 1024; ++k) {
      map.set({k % 32, k / 32}, kind == 1 ? CellState::kOccupied : CellState::kFree);
    }
    ExplorationGuide guide(ExplorationGuideOptions{});
    for (const Pose& pose :
         {Pose{{1.6, 1.6, 0.0}, 0.0}, Pose{{nan, 0.0, 0.0}, 0.0}, Pose{{1e300, 0.0, 0.0}, 0.0},
          Pose{{5e4, -5e4, 0.0}, 1.0}, Pose{{0.0, 0.0, 0.0}, nan}}) {
      const auto g = guide.update(map, pose, 1.0);
      ASSERT_NE(g, nullptr);
      ASSERT_NE(g->cost_to_go, nullptr);
      EXPECT_TRUE(std::isfinite(g->cost_to_go->value(1.6, 1.6)));
    }
    const auto g = guide.update(map, {{1.6, 1.6, 0.0}, 0.0}, 2.0);
    // Nothing seen yet is not done; all occupied is.
    EXPECT_EQ(g->facts.exhausted, kind == 1);
    EXPECT_EQ(g->target.has_value(), kind == 2);
  }
}

// Lesson 5, end to end: a frontier that no look resolves is left after four looks, and comes back
// with a change.
TEST(ExplorationGuide, AFrontierThatNoLookResolvesIsGivenUpAndTriedAgain) {
  GroundMap map(GridFrame{0.1, 0, 0, 64, 64});
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 64; ++i) {
      const bool rim = i < 2 || j < 2 || i > 61 || j > 61;
      map.set({i, j}, rim ? CellState::kOccupied : CellState::kFree);
    }
  }
  for (int k = 0; k < 8; ++k) map.set({61, 28 + k}, CellState::kUnknown);
  ExplorationGuide guide(ExplorationGuideOptions{});
  const Pose pose{{4.0, 3.2, 0.0}, 0.0};
  int step = 0, retries = 0;
  std::vector<int> active;
  for (; step < 40; ++step) {
    const auto g = guide.update(map, pose, 0.5 * step);
    active.push_back(g->target.has_value());
    retries = g->retries_used;
    if (g->facts.exhausted) break;
  }
  EXPECT_EQ(retries, 2);
  EXPECT_LT(step, 20);
  EXPECT_EQ(active[0] + active[1] + active[2], 3);
  map.set({60, 30}, CellState::kOccupied);
  const auto g = guide.update(map, pose, 0.5 * ++step);
  EXPECT_TRUE(g->target.has_value());
  EXPECT_FALSE(g->facts.exhausted);
}

}  // namespace
}  // namespace prospect::exploration_guide_test
