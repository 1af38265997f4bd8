#include "engine/frontier_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "ground_worlds.h"

namespace prospect::frontier_area_test {
namespace {

struct Chain {
  Traversability traversability{TraversabilityOptions{}};
  FrontierDetector detector{FrontierOptions{.min_length = 0.2}};
  Grid<std::uint8_t> suppressed;

  explicit Chain(const GroundMap& map) {
    traversability.update(map);
    detector.update(traversability);
    detector.find_viewpoints(traversability, suppressed);
  }
  std::vector<double> areas(double depth) const {
    FrontierArea area(depth);
    return area.measure(traversability, detector.frontiers(), suppressed);
  }
};

// Nonzero at unknown cells with room, a margin beyond the map too.
Grid<std::uint8_t> slow_room(const GroundMap& map, const TraversabilityOptions& o) {
  const GridFrame& f = map.frame();
  const double r = f.resolution;
  const int margin = 30;
  Grid<std::uint8_t> room(
      {r, f.i0 - margin, f.j0 - margin, f.width + 2 * margin, f.height + 2 * margin}, 0);
  const int reach = static_cast<int>(o.hard_radius / r) + 2;
  for (int k = 0; k < room.frame.size(); ++k) {
    const Cell c = room.frame.at(k);
    if (map.state(c) != CellState::kUnknown) continue;
    const double least = test::slow_distance(map, c, CellState::kOccupied, reach);
    room[c] = least + o.lattice_slack + 1e-9 >= o.hard_radius;
  }
  return room;
}

// Steps to every cell by relaxing all of them until nothing changes.
double slow_area(const Grid<std::uint8_t>& room, const Chain& chain, const Frontier& frontier,
                 double depth) {
  if (!frontier.active) return 0.0;
  const double r = room.frame.resolution;
  constexpr int kFar = std::numeric_limits<int>::max() - 1;
  Grid<int> steps(room.frame, kFar);
  for (const Cell c : frontier.cells) {
    if (chain.suppressed.get(c, 0) == 0 && room[c] != 0) steps[c] = 0;
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (int k = 0; k < steps.frame.size(); ++k) {
      const Cell c = steps.frame.at(k);
      if (room[c] == 0) continue;
      for (const Cell n :
           {Cell{c.i - 1, c.j}, Cell{c.i + 1, c.j}, Cell{c.i, c.j - 1}, Cell{c.i, c.j + 1}}) {
        if (steps.get(n, kFar) + 1 < steps[c]) steps[c] = steps[n] + 1, changed = true;
      }
    }
  }
  int count = 0;
  for (const int s : steps.data) count += s * r <= depth + 1e-9;
  return count * r * r;
}

TEST(FrontierArea, EqualsACountCellByCell) {
  std::mt19937_64 random(4);
  int compared = 0, positive = 0;
  for (int world = 0; world < 2; ++world) {
    const test::GroundWorld truth = test::GroundWorld::rooms(6.5, 0.1, 12, random);
    const Cell at = truth.open_cell(4, random);
    const Eigen::Vector2d p = truth.truth.frame.center(at);
    GroundMap map(GridFrame{0.1, at.i, at.j, 1, 1});
    for (int look = 0; look < 3; ++look) {
      truth.sense({{p.x(), p.y(), 0.0}, 1.3 * look}, 3.0, 1.05, map);
      Chain chain(map);
      const Grid<std::uint8_t> room = slow_room(map, chain.traversability.options());
      chain.suppressed = Grid<std::uint8_t>(chain.detector.frame(), 0);
      for (int depth = 0; depth < 3; ++depth) {
        const std::vector<double> areas = chain.areas(1.3 * depth);
        const std::vector<Frontier>& frontiers = chain.detector.frontiers();
        ASSERT_EQ(areas.size(), frontiers.size());
        for (std::size_t k = 0; k < frontiers.size(); ++k) {
          ASSERT_NEAR(areas[k], slow_area(room, chain, frontiers[k], 1.3 * depth), 1e-9);
          ++compared;
          positive += areas[k] > 0.0;
          // Some of what counts this time does not the next.
          for (const Cell c : frontiers[k].cells) chain.suppressed[c] = random() % 4 == 0;
        }
      }
    }
  }
  EXPECT_GT(compared, 30);
  EXPECT_GT(positive, 10);
}

double promised(const GroundMap& map) {
  const Chain chain(map);
  double most = 0.0;
  int active = 0;
  for (const Frontier& f : chain.detector.frontiers()) active += f.active;
  for (const double a : chain.areas(1.0)) most = std::max(most, a);
  EXPECT_GE(active, 1);
  return most;
}

TEST(FrontierArea, ADoorPromisesMoreThanALongSliver) {
  const double door = promised(test::known_room(90, [](int j) { return j >= 20 && j < 30; }));
  EXPECT_GT(door, 0.5);

  // The same wall, all of it known, and a strip of the floor 2 cells wide along it that is not.
  GroundMap sliver = test::known_room(90, [](int) { return false; });
  for (int j = 12; j < 42; ++j) {
    for (int i = 65; i < 67; ++i) sliver.set({i, j}, CellState::kUnknown);
  }
  EXPECT_EQ(promised(sliver), 0.0);

  // A hole in the wall through which no robot could come.
  EXPECT_EQ(promised(test::known_room(90, [](int j) { return j >= 20 && j < 24; })), 0.0);
}

TEST(FrontierArea, BeyondTheMapAllIsUnknown) {
  const auto door = [](int j) { return j >= 20 && j < 30; };
  EXPECT_EQ(promised(test::known_room(70, door)), promised(test::known_room(200, door)));
}

TEST(FrontierArea, BadDepthsAreNamed) {
  for (const double depth : {-0.1, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
    try {
      FrontierArea area(depth);
      FAIL() << depth;
    } catch (const std::invalid_argument& e) {
      EXPECT_NE(std::string(e.what()).find("depth"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace prospect::frontier_area_test
