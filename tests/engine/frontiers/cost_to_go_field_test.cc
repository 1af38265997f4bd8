// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/cost_to_go_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <random>
#include <utility>
#include <vector>

#include "tests/engine/ground_worlds.h"

namespace prospect::cost_to_go_field_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Chain {
  Traversability traversability;
  FrontierDetector detector;
  explicit Chain(const TraversabilityOptions& t = {}, const FrontierOptions& f = {})
      : traversability(t), detector(f) {}
  /// Leads to the active frontier with the most cells, or to the first one.
  void update(const GroundMap& map, bool first = false) {
    traversability.update(map);
    detector.update(traversability);
    detector.find_viewpoints(traversability);
    const std::vector<Frontier>& all = detector.frontiers();
    int best = -1;
    for (int k = 0; k < static_cast<int>(all.size()); ++k) {
      const auto at = static_cast<std::size_t>(k);
      if (!all[at].active || (first && best >= 0)) continue;
      if (best < 0 || all[at].cells.size() > all[static_cast<std::size_t>(best)].cells.size()) {
        best = k;
      }
    }
    detector.set_goal(best);
  }
};

// The upwind equations, solved by sweeping over the whole map until nothing changes.
Grid<double> slow_eikonal(const Chain& chain, double lambda, double required,
                          const Grid<float>* features) {
  const Traversability& t = chain.traversability;
  Grid<double> d(t.frame(), kInfinity);
  for (bool changed = true; changed;) {
    changed = false;
    for (int k = 0; k < d.frame.size(); ++k) {
      const Cell c = d.frame.at(k);
      if (!t.passable(c)) continue;
      double f = t.factor(c) * d.frame.resolution;
      if (features != nullptr) {
        f *= 1.0 +
             lambda * std::max(0.0, 1.0 - features->get(c, std::numeric_limits<float>::infinity()) /
                                              required);
      }
      const double a = std::min(d.get({c.i - 1, c.j}, kInfinity), d.get({c.i + 1, c.j}, kInfinity));
      const double b = std::min(d.get({c.i, c.j - 1}, kInfinity), d.get({c.i, c.j + 1}, kInfinity));
      double v = std::min(a, b) + f;
      if (std::abs(a - b) < f) v = 0.5 * (a + b + std::sqrt(2.0 * f * f - (a - b) * (a - b)));
      v = std::min(v, static_cast<double>(chain.detector.source(c)));
      if (v < d[c] - 1e-12) {
        d[c] = v;
        changed = true;
      }
    }
  }
  return d;
}

// Dijkstra over `moves` directions, cost of a move = its length x the factor of the cell entered.
Grid<double> slow_dijkstra(const Chain& chain, bool knight_moves) {
  const Traversability& t = chain.traversability;
  Grid<double> d(t.frame(), kInfinity);
  using Item = std::pair<double, int>;
  std::priority_queue<Item, std::vector<Item>, std::greater<>> queue;
  for (int k = 0; k < d.frame.size(); ++k) {
    const Cell c = d.frame.at(k);
    const double s = chain.detector.source(c);
    if (s < kInfinity && t.passable(c)) {
      d[c] = s;
      queue.push({s, k});
    }
  }
  while (!queue.empty()) {
    const auto [v, k] = queue.top();
    queue.pop();
    const Cell c = d.frame.at(k);
    if (v > d[c]) continue;
    for (int dj = -2; dj <= 2; ++dj) {
      for (int di = -2; di <= 2; ++di) {
        const int square = di * di + dj * dj;
        if (square != 1 && square != 2 && !(knight_moves && square == 5)) continue;
        const Cell n{c.i + di, c.j + dj};
        if (!t.passable(n)) continue;
        const double w = v + d.frame.resolution * std::sqrt(square) * t.factor(n);
        if (w < d.get(n, 0.0)) {
          d[n] = w;
          queue.push({w, d.frame.index(n)});
        }
      }
    }
  }
  return d;
}

CostToGoOptions without_stop() {
  CostToGoOptions o;
  o.stop_beyond = 1e6;
  return o;
}

GroundMap floor(double r, int n) {
  GroundMap map(GridFrame{r, 0, 0, n, n});
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) map.set({i, j}, CellState::kFree);
  }
  return map;
}

TEST(CostToGoField, SolvesTheUpwindEquations) {
  std::mt19937_64 random(3);
  for (int run = 0; run < 6; ++run) {
    const auto world = test::GroundWorld::rooms(10.0, 0.1, 20, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    Cell robot{};
    for (int k = 0; k < 4; ++k) {
      robot = world.open_cell(4, random);
      const Eigen::Vector2d p = world.truth.frame.center(robot);
      world.sense({{p.x(), p.y(), 0.0}, 0.1 * static_cast<double>(random() % 63)}, 4.0, 2.0, map);
    }
    Chain chain;
    chain.update(map);
    const bool weighted = run % 2 == 1;
    Grid<float> features(map.frame(), 0.0F);
    for (float& f : features.data) f = static_cast<float>(random() % 100);
    CostToGoOptions o = without_stop();
    o.lambda = 1.5;
    CostToGoField field(o);
    field.update(chain.traversability, chain.detector, robot, weighted ? &features : nullptr);
    const Grid<double> slow =
        slow_eikonal(chain, 1.5, o.features_required, weighted ? &features : nullptr);
    int finite = 0;
    for (int k = 0; k < slow.frame.size(); ++k) {
      const Cell c = slow.frame.at(k);
      if (slow[c] == kInfinity) {
        ASSERT_EQ(field.value(c), kInfinity);
      } else {
        // r f is kept in single precision.
        ASSERT_NEAR(field.value(c), slow[c], 1e-5);
        ++finite;
      }
    }
    EXPECT_GT(finite, 300);
  }
}

// One source in open space: the metric error of the scheme, near and far.
TEST(CostToGoField, MetricErrorInOpenSpaceIsSmallAndBounded) {
  for (const double r : {0.1, 0.05}) {
    const int n = 320;
    GroundMap map = floor(r, n);
    const Cell hole{160, 160};
    map.set(hole, CellState::kUnknown);
    for (int k = 0; k < n; ++k) {  // else the rim of the map is a frontier too
      for (const Cell c : {Cell{k, 0}, Cell{k, n - 1}, Cell{0, k}, Cell{n - 1, k}}) {
        map.set(c, CellState::kOccupied);
      }
    }
    FrontierOptions f;
    f.min_length = 0.0;
    f.near_slope = 1.0;  // cost = distance: what is left is the error of the march
    f.sensor_range = 1.5 * r + 0.3;
    f.range_margin = 0.1;
    TraversabilityOptions t;
    t.hard_radius = t.comfortable_radius = 0.0;  // no factor near unknown
    t.lattice_slack = 0.0;
    t.unknown_factor = 1.0;
    Chain chain(t, f);
    chain.update(map, 0.0);
    CostToGoField field(without_stop());
    field.update(chain.traversability, chain.detector, {10, 10});
    double worst = 0.0, relative = 0.0;
    for (int k = 0; k < map.frame().size(); ++k) {
      const Cell c = map.frame().at(k);
      if (c.i < 17 || c.j < 17 || c.i > 303 || c.j > 303) continue;
      const double cells = std::hypot(c.i - hole.i, c.j - hole.j);
      if (cells < 1.5) continue;
      const double error = field.value(c) - r * cells;
      ASSERT_GT(error, -1e-5);
      ASSERT_LT(error, r * (0.25 + 0.25 * std::log(cells)));
      worst = std::max(worst, error);
      if (cells > 30) relative = std::max(relative, error / (r * cells));
    }
    EXPECT_GT(worst, 0.3 * r);  // the bound is not idle
    EXPECT_LT(relative, 0.035);
  }
}

// Against an independent method, in clutter: two searches with other metrics enclose the march.
TEST(CostToGoField, AgreesWithDijkstraWithinTheMetricErrorsOfBoth) {
  std::mt19937_64 random(4);
  for (int run = 0; run < 4; ++run) {
    const auto world = test::GroundWorld::rooms(12.0, 0.1, 10, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    Cell robot{};
    for (int k = 0; k < 8; ++k) {
      robot = world.open_cell(4, random);
      const Eigen::Vector2d p = world.truth.frame.center(robot);
      world.sense({{p.x(), p.y(), 0.0}, 0.0}, 4.0, 6.28, map);
    }
    // One factor everywhere: where factors jump, both discretise the jump within a cell,
    // differently.
    TraversabilityOptions t;
    t.tight_factor = t.unknown_factor = t.narrow_factor = 1.0;
    Chain chain(t);
    chain.update(map);
    CostToGoField field(without_stop());
    field.update(chain.traversability, chain.detector, robot);
    const Grid<double> eight = slow_dijkstra(chain, false);
    const Grid<double> sixteen = slow_dijkstra(chain, true);
    int compared = 0;
    for (int k = 0; k < eight.frame.size(); ++k) {
      const Cell c = eight.frame.at(k);
      const double v = field.value(c);
      if (v == kInfinity) continue;
      const double path =
          v + 2.0;  // sources are not below -2 m: an upper bound of the path's length
      // Straight lines are at least 1/1.0275 of a 16-neighbour path.
      EXPECT_GT(v, sixteen[c] - 0.027 * path - 1e-6);
      EXPECT_LT(v, eight[c] + 0.08 * path + 0.15);
      ++compared;
    }
    EXPECT_GT(compared, 1000);
  }
}

// The contract of the repair: the same bits as from nothing, whatever the history.
TEST(CostToGoField, RepairEqualsFromScratchBitForBit) {
  std::mt19937_64 random(5);
  std::int64_t repaired = 0, scratch = 0;
  for (int run = 0; run < 12; ++run) {
    const bool torn = run % 3 == 2;
    const auto world = test::GroundWorld::rooms(16.0, 0.1, 40, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    Chain chain;
    CostToGoOptions options;
    options.stop_beyond = run % 2 == 0 ? 5.0 : 1.0;
    options.lambda = run % 4 == 3 ? 1.0 : 0.0;
    CostToGoField kept(options);
    Cell robot = world.open_cell(4, random);
    for (int step = 0; step < 25; ++step) {
      if (torn) {
        test::scribble(map, 10, 120, 0, random);
        robot = {static_cast<int>(random() % 140), static_cast<int>(random() % 140)};
      } else {
        // A drive in small steps, with a jump now and then.
        const Cell next{robot.i + static_cast<int>(random() % 7) - 3,
                        robot.j + static_cast<int>(random() % 7) - 3};
        if (!world.occupied(next)) robot = next;
        if (step % 9 == 8) robot = world.open_cell(3, random);
        const Eigen::Vector2d p = world.truth.frame.center(robot);
        world.sense({{p.x(), p.y(), 0.0}, 0.1 * static_cast<double>(random() % 63)}, 4.0, 1.05,
                    map);
      }
      // The target may change without the map changing.
      chain.update(map, step % 4 == 3);
      // Near some cell.
      const Cell near = map.frame().at(static_cast<int>(random() % map.cells().data.size()));
      Grid<float> features({map.frame().resolution, near.i - 20, near.j - 15, 40, 30}, 0.0F);
      for (float& f : features.data) f = static_cast<float>(random() % 100);
      const Grid<float>* given = step % 3 == 1 ? &features : nullptr;
      kept.update(chain.traversability, chain.detector, robot, given);
      repaired += kept.evaluations();
      CostToGoField fresh(options);
      fresh.solve_from_scratch(chain.traversability, chain.detector, robot, given);
      scratch += fresh.evaluations();
      ASSERT_EQ(kept.settled(), fresh.settled());
      ASSERT_EQ(kept.anchor(), fresh.anchor());
      for (int k = 0; k < chain.traversability.frame().size(); ++k) {
        const Cell c = chain.traversability.frame().at(k);
        ASSERT_EQ(kept.value(c), fresh.value(c)) << run << " " << step << " " << c.i << " " << c.j;
      }
      ASSERT_EQ(kept.window()->cells().data, fresh.window()->cells().data);
    }
  }
  EXPECT_LT(repaired, scratch);
}

TEST(CostToGoField, StopsBeyondTheRobot) {
  GroundMap map = floor(0.1, 320);
  for (int k = 0; k < 8; ++k) map.set({20, 20 + k}, CellState::kUnknown);
  FrontierOptions f;
  f.min_length = 0.5;
  Chain chain({}, f);
  chain.update(map);
  // The rim of the map is a frontier too: only the sources near the robot's side matter here.
  CostToGoField field(CostToGoOptions{.stop_beyond = 2.0});
  const Cell robot{160, 160};
  field.update(chain.traversability, chain.detector, robot);
  ASSERT_TRUE(field.anchor_reached());
  EXPECT_EQ(field.settled(), field.value(robot) + 2.0);
  CostToGoField all(without_stop());
  all.update(chain.traversability, chain.detector, robot);
  for (int k = 0; k < map.frame().size(); ++k) {
    const Cell c = map.frame().at(k);
    if (all.value(c) <= field.settled()) {
      ASSERT_EQ(field.value(c), all.value(c));
    } else {
      ASSERT_EQ(field.value(c), kInfinity);
    }
  }
}

TEST(CostToGoField, WindowIsFiniteAndRisesAwayFromBothSidesOfAWall) {
  std::mt19937_64 random(6);
  for (int run = 0; run < 10; ++run) {
    const auto world = test::GroundWorld::rooms(12.0, 0.1, 30, random);
    GroundMap map(GridFrame{0.1, 0, 0, 16, 16});
    const Cell robot = world.open_cell(3, random);
    const Eigen::Vector2d p = world.truth.frame.center(robot);
    world.sense({{p.x(), p.y(), 0.0}, 0.0}, 4.0, 6.28, map);
    Chain chain;
    chain.update(map);
    CostToGoField field(CostToGoOptions{});
    field.update(chain.traversability, chain.detector, robot);
    const auto v = field.window();
    ASSERT_TRUE(v->reached(robot));
    int filled = 0;
    for (int k = 0; k < v->frame().size(); ++k) {
      const Cell c = v->frame().at(k);
      ASSERT_TRUE(std::isfinite(v->cells()[c]));
      if (v->reached(c)) {
        ASSERT_EQ(v->cells()[c], field.value(c) / v->v_max());
        continue;
      }
      ++filled;
      // The value of a nearest reached cell (within the sweeps' error of half a cell) + 3 per
      // metre.
      double least = kInfinity;
      for (int m = 0; m < v->frame().size(); ++m) {
        const Cell o = v->frame().at(m);
        if (v->reached(o)) least = std::min(least, std::hypot(o.i - c.i, o.j - c.j));
      }
      bool explained = false;
      for (int m = 0; m < v->frame().size() && !explained; ++m) {
        const Cell o = v->frame().at(m);
        const double d = std::hypot(o.i - c.i, o.j - c.j);
        explained = v->reached(o) && d < least + 0.5 &&
                    std::abs(v->cells()[o] + 3.0 * 0.1 * d / v->v_max() - v->cells()[c]) < 1e-9;
      }
      ASSERT_TRUE(explained);
      if (filled > 60) break;
    }
    EXPECT_GT(filled, 60);
  }
}

TEST(CostToGoField, DegenerateMaps) {
  const Cell robot{8, 8};
  for (const int kind : {0, 1, 2, 3}) {
    GroundMap map(GridFrame{0.1, 0, 0, 32, 32});
    if (kind == 1 || kind == 2) {
      for (int k = 0; k < 1024; ++k) {
        map.set({k % 32, k / 32}, kind == 1 ? CellState::kOccupied : CellState::kFree);
      }
    }
    if (kind == 3) map.set(robot, CellState::kFree);  // a single free cell
    Chain chain({}, {.min_length = 0.5});
    chain.update(map);
    CostToGoField field(CostToGoOptions{});
    for (const Cell at : {robot, Cell{-5000, 90000}}) {
      field.update(chain.traversability, chain.detector, at);
      const auto v = field.window();
      for (const double value : v->cells().data) ASSERT_TRUE(std::isfinite(value));
      EXPECT_TRUE(std::isfinite(v->value(0.3, -0.2)));
      EXPECT_EQ(field.anchor_reached(), kind == 2 && at == robot) << kind;
    }
  }
}

// A robot that stands closer to a wall than it may is judged by the passable cell on its own side.
TEST(CostToGoField, RobotInAWallIsAnchoredOnItsSide) {
  GroundMap map(GridFrame{0.1, 0, 0, 64, 64});
  for (int j = 0; j < 64; ++j) {
    for (int i = 0; i < 64; ++i) {
      map.set({i, j}, i == 30 ? CellState::kOccupied : CellState::kFree);
    }
  }
  Chain chain({.narrow_slack = 0.0});
  chain.update(map);
  CostToGoField field(CostToGoOptions{});
  field.update(chain.traversability, chain.detector, {29, 32});
  EXPECT_EQ(field.anchor(), (Cell{27, 32}));
  field.update(chain.traversability, chain.detector, {31, 32});
  EXPECT_EQ(field.anchor(), (Cell{33, 32}));
}

}  // namespace
}  // namespace prospect::cost_to_go_field_test
