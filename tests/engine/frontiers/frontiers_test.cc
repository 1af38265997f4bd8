// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/frontiers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/free_line.h"
#include "tests/engine/ground_worlds.h"

namespace prospect::frontiers_test {
namespace {

using Address = std::pair<int, int>;  // (j, i)

std::set<Address> slow_frontier_cells(const GroundMap& map) {
  std::set<Address> cells;
  const GridFrame& f = map.frame();
  for (int j = f.j0 - 1; j <= f.j0 + f.height; ++j) {
    for (int i = f.i0 - 1; i <= f.i0 + f.width; ++i) {
      if (map.state({i, j}) != CellState::kUnknown) continue;
      for (const Cell n : {Cell{i - 1, j}, Cell{i + 1, j}, Cell{i, j - 1}, Cell{i, j + 1}}) {
        if (map.state(n) == CellState::kFree) cells.insert({j, i});
      }
    }
  }
  return cells;
}

// Clusters by merging sets until no two touch.
std::set<std::vector<Address>> slow_clusters(const GroundMap& map) {
  std::vector<std::set<Address>> sets;
  for (const Address& a : slow_frontier_cells(map)) {
    std::set<Address> merged{a};
    for (auto it = sets.begin(); it != sets.end();) {
      const bool touches = std::any_of(it->begin(), it->end(), [&](const Address& b) {
        return std::abs(a.first - b.first) <= 1 && std::abs(a.second - b.second) <= 1;
      });
      if (touches) {
        merged.insert(it->begin(), it->end());
        it = sets.erase(it);
      } else {
        ++it;
      }
    }
    sets.push_back(merged);
  }
  std::set<std::vector<Address>> out;
  for (const auto& s : sets) out.insert(std::vector<Address>(s.begin(), s.end()));
  return out;
}

// All sources, by casting every ray of every counting cell with a line in small steps.
Grid<float> slow_sources(const GroundMap& map, const Traversability& t, const FrontierDetector& d,
                         const Grid<float>& ranges, int led_to) {
  const FrontierOptions& o = d.options();
  Grid<float> source(t.frame(), std::numeric_limits<float>::infinity());
  const double r = t.frame().resolution;
  const double reach = o.sensor_range - o.range_margin;
  for (std::size_t k = 0; k < d.frontiers().size(); ++k) {
    const Frontier& f = d.frontiers()[k];
    if (static_cast<int>(k) != led_to) continue;
    if (static_cast<double>(f.cells.size()) * r < o.min_length - 1e-9) continue;
    for (const Cell c : f.cells) {
      const auto range = static_cast<double>(ranges.get(c, 100.0F));
      for (int n = 0; n < o.rays; ++n) {
        const double angle = 2.0 * M_PI * n / o.rays;
        const GridFrame unit{r, 0, 0, 1, 1};
        const Eigen::Vector2d from = unit.center({0, 0});
        const Eigen::Vector2d to = from + reach * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        visit_line(unit, from, to, [&](Cell step) {
          if (step == Cell{0, 0}) return true;
          const Cell at{c.i + step.i, c.j + step.j};
          const double distance = r * std::hypot(step.i, step.j);
          if (distance > std::min(reach, range) || !map.see_through(at)) return false;
          if (t.passable(at)) {
            source[at] = std::min(source[at], static_cast<float>(viewpoint_cost(distance, o)));
          }
          return true;
        });
      }
    }
  }
  return source;
}

TEST(FreeLine, VisitsTheCellsThatASegmentPierces) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> coordinate(-3.0, 3.0);
  const GridFrame frame{0.1, 0, 0, 1, 1};
  for (int k = 0; k < 500; ++k) {
    const Eigen::Vector2d a(coordinate(random), coordinate(random));
    const Eigen::Vector2d b(coordinate(random), coordinate(random));
    std::set<Address> visited;
    Cell last = frame.cell(a.x(), a.y());
    visit_line(frame, a, b, [&](Cell c) {
      EXPECT_LE(std::abs(c.i - last.i) + std::abs(c.j - last.j), 1);
      last = c;
      visited.insert({c.j, c.i});
      // The segment meets the cell: the intervals of its parameter within the two slabs overlap.
      double from = 0.0, to = 1.0;
      for (int axis = 0; axis < 2; ++axis) {
        const double low = 0.1 * (axis == 0 ? c.i : c.j), d = b[axis] - a[axis];
        from = std::max(from, std::min((low - a[axis]) / d, (low + 0.1 - a[axis]) / d));
        to = std::min(to, std::max((low - a[axis]) / d, (low + 0.1 - a[axis]) / d));
      }
      EXPECT_LE(from, to + 1e-9);
      return true;
    });
    EXPECT_EQ(last, frame.cell(b.x(), b.y()));
    for (int s = 0; s <= 4000; ++s) {
      const Eigen::Vector2d p = a + (b - a) * (s / 4000.0);
      const Cell c = frame.cell(p.x(), p.y());
      EXPECT_TRUE(visited.contains({c.j, c.i}));
    }
  }
}

TEST(Frontiers, ClustersAndSourcesEqualTheSlowOnesWhateverTheHistory) {
  std::mt19937_64 random(2);
  for (int run = 0; run < 6; ++run) {
    const auto world = test::GroundWorld::rooms(10.0, 0.1, 25, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    TraversabilityOptions options;
    Traversability t(options);
    FrontierDetector kept{FrontierOptions{}};
    Cell robot = world.open_cell(4, random);
    for (int step = 0; step < 8; ++step) {
      if (run % 2 == 0) {
        const Eigen::Vector2d p = world.truth.frame.center(robot);
        world.sense({{p.x(), p.y(), 0.0}, 0.1 * static_cast<double>(random() % 63)}, 4.0, 1.05,
                    map);
        if (step % 3 == 2) robot = world.open_cell(4, random);
      } else {
        test::scribble(map, 8, 60, -10 * step, random);
      }
      // Obstacles that sight passes over, and free cells that it does not pass.
      for (int n = 0; n < 30; ++n) {
        const Cell c = map.frame().at(static_cast<int>(random() % map.cells().data.size()));
        if (map.explored(c)) map.set(c, map.state(c), !map.see_through(c));
      }
      t.update(map);
      kept.update(t);
      Grid<float> ranges(t.frame(), 100.0F);
      for (const Frontier& f : kept.frontiers()) {
        if (random() % 3 != 0) continue;
        // Some do not count, some must be looked at from near.
        for (const Cell c : f.cells) ranges[c] = 0.75F * static_cast<float>(random() % 4);
      }
      const auto ranges_of = [&](const Frontier& f, std::vector<float>& of_cells) {
        for (std::size_t n = 0; n < f.cells.size(); ++n) of_cells[n] = ranges[f.cells[n]];
      };
      kept.find_viewpoints(t, ranges_of);
      const int led_to =
          static_cast<int>(random() % (kept.frontiers().size() + 1)) - 1;  // -1: nowhere
      kept.set_goal(led_to);

      std::set<std::vector<Address>> clusters;
      std::size_t cells = 0;
      for (const Frontier& f : kept.frontiers()) {
        std::vector<Address> list;
        for (const Cell c : f.cells) list.push_back({c.j, c.i});
        EXPECT_NEAR(f.length, 0.1 * static_cast<double>(f.cells.size()), 1e-12);
        clusters.insert(list);
        cells += f.cells.size();
        for (const Cell c : f.cells) {
          ASSERT_EQ(&kept.frontiers()[static_cast<std::size_t>(kept.frontier_of(c))], &f);
        }
      }
      ASSERT_EQ(clusters, slow_clusters(map));
      ASSERT_EQ(cells, slow_frontier_cells(map).size());

      const Grid<float> slow = slow_sources(map, t, kept, ranges, led_to);
      FrontierDetector fresh{FrontierOptions{}};
      Traversability t_fresh(options);
      t_fresh.update(map);
      fresh.update(t_fresh);
      fresh.find_viewpoints(t_fresh, ranges_of);
      fresh.set_goal(led_to);
      ASSERT_EQ(fresh.frontiers().size(), kept.frontiers().size());
      int sources = 0;
      for (int k = 0; k < t.frame().size(); ++k) {
        const Cell c = t.frame().at(k);
        ASSERT_EQ(kept.source(c), slow[c]);
        ASSERT_EQ(fresh.source(c), slow[c]);
        sources += std::isfinite(slow[c]);
      }
      for (std::size_t k = 0; k < fresh.frontiers().size(); ++k) {
        ASSERT_EQ(fresh.frontiers()[k].active, kept.frontiers()[k].active);
        ASSERT_EQ(fresh.frontiers()[k].viewpoints, kept.frontiers()[k].viewpoints);
      }
      // What a source sees is a counting cell of an active frontier, joined to it by a free line.
      if (sources > 0 && step == 7) {
        for (const ViewpointSource& s : kept.sources()) {
          ASSERT_EQ(s.frontier, led_to);
          ASSERT_TRUE(kept.frontiers()[static_cast<std::size_t>(s.frontier)].active);
          ASSERT_EQ(kept.frontier_of(s.sees), s.frontier);
          ASSERT_GT(ranges[s.sees], 0.0F);
          ASSERT_EQ(s.cost, kept.source(s.cell));
          ASSERT_LE(0.1 * std::hypot(s.cell.i - s.sees.i, s.cell.j - s.sees.j), 3.9 + 1e-9);
        }
      }
    }
  }
}

// Floor with a walled pocket; `gap` cells of its wall are open towards the floor.
GroundMap pocket(int gap) {
  GroundMap map(GridFrame{0.1, 0, 0, 96, 96});
  for (int j = 0; j < 96; ++j) {
    for (int i = 0; i < 96; ++i) {
      const bool rim = i == 0 || j == 0 || i == 95 || j == 95;
      map.set({i, j}, rim ? CellState::kOccupied : CellState::kFree);
    }
  }
  for (int k = 40; k <= 60; ++k) {
    for (const Cell c : {Cell{k, 40}, Cell{k, 60}, Cell{40, k}, Cell{60, k}}) {
      map.set(c, CellState::kOccupied);
    }
  }
  for (int j = 48; j < 56; ++j) {
    for (int i = 48; i < 56; ++i) map.set({i, j}, CellState::kUnknown);
  }
  for (int k = 0; k < gap; ++k) map.set({40, 50 + k}, CellState::kFree);
  return map;
}

// Lesson 1 of the prototype. The pocket is known free inside (seen through a crack since closed),
// and too narrow to drive in.
TEST(Frontiers, APriceOfViewsComesOnTop) {
  std::mt19937_64 random(3);
  const auto world = test::GroundWorld::rooms(10.0, 0.1, 25, random);
  GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
  const Eigen::Vector2d p = world.truth.frame.center(world.open_cell(4, random));
  world.sense({{p.x(), p.y(), 0.0}, 0.3}, 4.0, 3.0, map);
  Traversability t{TraversabilityOptions{}};
  t.update(map);
  FrontierDetector detector{FrontierOptions{}};
  detector.update(t);
  detector.find_viewpoints(t);
  ASSERT_FALSE(detector.frontiers().empty());
  int longest = 0;
  for (int k = 0; k < static_cast<int>(detector.frontiers().size()); ++k) {
    const auto cells = [&](int f) {
      return detector.frontiers()[static_cast<std::size_t>(f)].cells;
    };
    if (cells(k).size() > cells(longest).size()) longest = k;
  }
  detector.set_goal(longest);
  const std::vector<ViewpointSource> free = detector.sources();
  ASSERT_GT(free.size(), 50u);
  const auto price_of = [](Cell c) { return 0.25 * ((c.i + 3 * c.j) & 7); };
  // Looks are priced one by one, and again when the price changes although nothing else does.
  for (const double scale : {1.0, 2.0}) {
    bool each_sees_a_frontier = true;
    detector.set_goal(longest, [&](Cell viewpoint, Cell sees) {
      each_sees_a_frontier &= detector.frontier_of(sees) >= 0;
      return scale * price_of(viewpoint);
    });
    EXPECT_TRUE(each_sees_a_frontier);
    EXPECT_FALSE(detector.changed_sources().empty());
    for (const ViewpointSource& s : free) {
      const double expected = s.cost + scale * price_of(s.cell);
      EXPECT_NEAR(detector.source(s.cell), expected, 1e-5);
      EXPECT_EQ(detector.source_at(s.cell).cost, detector.source(s.cell));
    }
  }
  // Without a price it is as it was.
  detector.set_goal(longest);
  for (const ViewpointSource& s : free) EXPECT_EQ(detector.source(s.cell), s.cost);
}

TEST(Frontiers, PhantomFrontierInAPocketStaysInactive) {
  TraversabilityOptions narrow;  // the robot fits nowhere inside: 0.9 m between wall and unknown
  narrow.hard_radius = 0.75;
  narrow.comfortable_radius = 0.8;
  narrow.narrow_slack = 0.0;
  for (const int gap : {0, 4}) {
    const GroundMap map = pocket(gap);
    Traversability t(narrow);
    FrontierDetector d{FrontierOptions{}};
    t.update(map);
    d.update(t);
    d.find_viewpoints(t);
    d.set_goal(0);
    ASSERT_EQ(d.frontiers().size(), 1u);
    EXPECT_NEAR(d.frontiers()[0].length, 2.8, 1e-9);
    if (gap == 0) {
      // Passable cells inside the pocket would be viewpoints; there are none.
      EXPECT_FALSE(t.passable({44, 50}));
      EXPECT_FALSE(d.frontiers()[0].active);
      EXPECT_EQ(d.frontiers()[0].viewpoints, 0);
      EXPECT_TRUE(d.sources().empty());
    } else {
      // Opened towards the floor it can be seen from outside, though not driven into.
      EXPECT_TRUE(d.frontiers()[0].active);
      for (const ViewpointSource& s : d.sources()) EXPECT_LT(s.cell.i, 40);
    }
  }
}

// The camera sees over a low obstacle that stops the body.
TEST(Frontiers, IsSeenOverALowObstacle) {
  TraversabilityOptions narrow;  // as above
  narrow.hard_radius = 0.75;
  narrow.comfortable_radius = 0.8;
  narrow.narrow_slack = 0.0;
  GroundMap map = pocket(0);
  Traversability t(narrow);
  FrontierDetector d{FrontierOptions{}};
  t.update(map);
  d.update(t);
  d.find_viewpoints(t);
  ASSERT_FALSE(d.frontiers()[0].active);
  // What is known of the height of the wall changes, not its state.
  for (int k = 0; k < 4; ++k) {
    ASSERT_EQ(map.state({40, 50 + k}), CellState::kOccupied);
    map.set({40, 50 + k}, CellState::kOccupied, true);
  }
  t.update(map);
  EXPECT_TRUE(t.changed_states().empty());
  EXPECT_EQ(t.changed_sights().size(), 4u);
  d.update(t);
  d.find_viewpoints(t);
  d.set_goal(0);
  EXPECT_TRUE(d.frontiers()[0].active);
  EXPECT_FALSE(d.sources().empty());
  for (const ViewpointSource& s : d.sources()) EXPECT_LT(s.cell.i, 40);
}

TEST(Frontiers, LinesDoNotSlipBetweenCellsThatTouchAtACorner) {
  GroundMap map(GridFrame{0.1, 0, 0, 64, 64});
  for (int j = 1; j < 63; ++j) {
    for (int i = 1; i < 63; ++i) {
      // A diagonal wall of cells that touch at corners only, a free strip too narrow to drive
      // behind it, and the unknown.
      map.set({i, j}, i + j < 64    ? CellState::kFree
                      : i + j == 64 ? CellState::kOccupied
                      : i + j < 67  ? CellState::kFree
                                    : CellState::kUnknown);
    }
  }
  for (int k = 0; k < 64; ++k) {
    for (const Cell c : {Cell{k, 0}, Cell{k, 63}, Cell{0, k}, Cell{63, k}}) {
      map.set(c, CellState::kOccupied);
    }
  }
  Traversability t{TraversabilityOptions{}};
  FrontierDetector d{FrontierOptions{}};
  t.update(map);
  d.update(t);
  d.find_viewpoints(t);
  ASSERT_EQ(d.frontiers().size(), 1u);
  EXPECT_GE(d.frontiers()[0].length, 0.5);
  EXPECT_FALSE(d.frontiers()[0].active);
}

TEST(Frontiers, ClustersUnderTheLeastLengthAreInactive) {
  for (int n = 3; n <= 6; ++n) {
    GroundMap map(GridFrame{0.1, 0, 0, 64, 64});
    for (int j = 0; j < 64; ++j) {
      for (int i = 0; i < 64; ++i) {
        const bool rim = i == 0 || j == 0 || i == 63 || j == 63;
        map.set({i, j}, rim ? CellState::kOccupied : CellState::kFree);
      }
    }
    for (int k = 0; k < n; ++k) map.set({30 + k, 30}, CellState::kUnknown);
    Traversability t{TraversabilityOptions{}};
    FrontierDetector d{FrontierOptions{.min_length = 0.5}};
    t.update(map);
    d.update(t);
    d.find_viewpoints(t);
    ASSERT_EQ(d.frontiers().size(), 1u);
    EXPECT_EQ(d.frontiers()[0].active, n >= 5) << n;
  }
}

TEST(Frontiers, ViewpointCostIsThatOfThePrototype) {
  const FrontierOptions o;
  EXPECT_NEAR(viewpoint_cost(0.5, o), 0.15, 1e-12);
  EXPECT_NEAR(viewpoint_cost(1.0, o), 0.3, 1e-12);
  EXPECT_NEAR(viewpoint_cost(3.0, o), 2.3, 1e-12);
}

TEST(Frontiers, OnlyPiecesNearAChangeAreCastAgain) {
  GroundMap map(GridFrame{0.1, 0, 0, 320, 64});
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 320; ++i) map.set({i, j}, CellState::kFree);
  }
  Traversability t{TraversabilityOptions{}};
  FrontierDetector d{FrontierOptions{}};
  const auto step = [&] {
    t.update(map);
    d.update(t);
    d.find_viewpoints(t);
    return d.cells_cast();
  };
  EXPECT_EQ(step(), 2 * 320 + 2 * 64);
  EXPECT_EQ(step(), 0);
  map.set({300, 30}, CellState::kOccupied);
  const int near = step();
  EXPECT_GT(near, 0);
  EXPECT_LT(near, 300);
}

TEST(Frontiers, BadOptionsAreNamed) {
  try {
    FrontierDetector d(FrontierOptions{.sensor_range = -1.0});
    FAIL();
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("sensor_range is -1"), std::string::npos);
  }
}

}  // namespace
}  // namespace prospect::frontiers_test
