// SPDX-License-Identifier: Apache-2.0
#include "engine/frontiers/exploration_targets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "engine/features/footprint_visibility.h"
#include "tests/engine/view_worlds.h"

namespace prospect::exploration_targets_test {
namespace {

using test::uniform;

struct Scene {
  Belief belief;
  std::vector<Cell> frontier;  // free cells beside an unknown one
};

/// A hall known up to an irregular front, with patches of unknown inside.
Scene scene(std::mt19937_64& random) {
  Scene s;
  auto voxels = std::make_shared<VoxelGrid>(test::hall(random, false, 12));
  auto ground = std::make_shared<GroundMap>(GridFrame{0.1, -80, -80, 160, 160});
  std::vector<Eigen::Vector3d> patches;
  for (int n = 0; n < 6; ++n) {
    patches.emplace_back(uniform(random, -60, 60), uniform(random, -60, 60), uniform(random, 3, 9));
  }
  const double front = uniform(random, 10, 40);
  for (int i = -80; i < 80; ++i) {
    for (int j = -80; j < 80; ++j) {
      bool unknown = i > front + 6 * std::sin(0.2 * j);
      for (const auto& p : patches) unknown |= std::hypot(i - p.x(), j - p.y()) < p.z();
      if (std::hypot(i, j) < 5) unknown = false;
      if (unknown) {
        for (int k = 0; k < 25; ++k) voxels->set(i, j, k, CellState::kUnknown);
      } else {
        ground->set({i, j}, voxels->state(i, j, 4));
      }
    }
  }
  for (int i = -79; i < 79; ++i) {
    for (int j = -79; j < 79; ++j) {
      if (ground->state({i, j}) != CellState::kFree) continue;
      if (!ground->explored({i + 1, j}) || !ground->explored({i - 1, j}) ||
          !ground->explored({i, j + 1}) || !ground->explored({i, j - 1})) {
        s.frontier.push_back({i, j});
      }
    }
  }
  s.belief.voxels = voxels;
  s.belief.ground = ground;
  s.belief.pose = {{0.02, 0.03, 0.0}, uniform(random, -3, 3)};
  return s;
}

bool same(const ExplorationTargets& a, const ExplorationTargets& b) {
  if (a.targets.size() != b.targets.size() || a.reference_area != b.reference_area) return false;
  for (std::size_t i = 0; i < a.targets.size(); ++i) {
    if (a.targets[i].position != b.targets[i].position || a.targets[i].mass != b.targets[i].mass) {
      return false;
    }
  }
  return true;
}

TEST(ExplorationTargets, HoldExactlyTheUnknownCellsNearAFrontier) {
  std::mt19937_64 random(1);
  for (int world = 0; world < 4; ++world) {
    const Scene s = scene(random);
    ExplorationTargetOptions options;
    options.drop_visible = false;
    options.max_targets = 100000;
    options.reach = 100.0;
    const ExplorationTargets found =
        exploration_targets(s.belief, s.frontier, {DepthSensor()}, options);
    // Every cell against every frontier cell.
    std::map<std::pair<int, int>, int> blocks;
    for (int i = -100; i < 100; ++i) {
      for (int j = -100; j < 100; ++j) {
        if (s.belief.ground->explored({i, j})) continue;
        const bool near = std::any_of(s.frontier.begin(), s.frontier.end(), [&](const Cell& f) {
          return (f.i - i) * (f.i - i) + (f.j - j) * (f.j - j) <= 144;
        });
        if (near)
          ++blocks[{static_cast<int>(std::floor(i / 4.0)), static_cast<int>(std::floor(j / 4.0))}];
      }
    }
    ASSERT_EQ(found.targets.size(), blocks.size());
    ASSERT_GT(blocks.size(), 30u);
    std::set<std::pair<int, int>> seen;
    double near_mass = 0.0;
    for (const ExplorationTarget& t : found.targets) {
      const std::pair<int, int> block(static_cast<int>(std::floor(t.position.x() / 0.4 + 1e-9)),
                                      static_cast<int>(std::floor(t.position.y() / 0.4 + 1e-9)));
      EXPECT_TRUE(seen.insert(block).second);
      EXPECT_NEAR(t.mass, blocks.at(block) * 0.01, 1e-12);
      EXPECT_FALSE(
          s.belief.ground->explored(s.belief.ground->frame().cell(t.position.x(), t.position.y())));
      EXPECT_NEAR(t.position.z(), 0.45, 1e-12);
      if ((t.position - s.belief.pose.position).head<2>().norm() <= 5.0) near_mass += t.mass;
    }
    EXPECT_NEAR(found.reference_area, std::clamp(0.5 * near_mass, 0.3, 4.0), 1e-9);
  }
}

TEST(ExplorationTargets, AreCappedNearestFirstAndIndependentOfTheOrderOfFrontierCells) {
  std::mt19937_64 random(2);
  Scene s = scene(random);
  const ExplorationTargets a = exploration_targets(s.belief, s.frontier, {DepthSensor()});
  std::shuffle(s.frontier.begin(), s.frontier.end(), random);
  EXPECT_TRUE(same(a, exploration_targets(s.belief, s.frontier, {DepthSensor()})));
  ASSERT_LE(a.targets.size(), 200u);

  ExplorationTargetOptions few;
  few.max_targets = 15;
  const ExplorationTargets b = exploration_targets(s.belief, s.frontier, {DepthSensor()}, few);
  ASSERT_EQ(b.targets.size(), 15u);
  EXPECT_EQ(b.reference_area, a.reference_area);  // what there is does not depend on the cap
  const auto distance = [&](const ExplorationTarget& t) {
    return (t.position - s.belief.pose.position).head<2>().norm();
  };
  std::vector<double> all, kept;
  for (const auto& t : a.targets) all.push_back(distance(t));
  for (const auto& t : b.targets) kept.push_back(distance(t));
  std::sort(all.begin(), all.end());
  std::sort(kept.begin(), kept.end());
  for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_NEAR(kept[i], all[i], 1e-12);
}

TEST(ExplorationTargets, LeaveOutWhatThePresentPoseSeesAndStaysUnknown) {
  std::mt19937_64 random(3);
  int dropped = 0;
  for (int world = 0; world < 8; ++world) {
    const Scene s = scene(random);
    ExplorationTargetOptions keep;
    keep.max_targets = 100000;
    keep.drop_visible = false;
    ExplorationTargetOptions drop = keep;
    drop.drop_visible = true;
    const auto all = exploration_targets(s.belief, s.frontier, {DepthSensor()}, keep);
    const auto left = exploration_targets(s.belief, s.frontier, {DepthSensor()}, drop);
    EXPECT_EQ(left.visible_now + left.targets.size(), all.targets.size());
    dropped += left.visible_now;
    const FootprintVisibility view(RgbdFootprint{}, CameraMount{});
    const Eigen::Vector3d sensor = s.belief.pose.position + Eigen::Vector3d(0, 0, 0.45);
    for (const ExplorationTarget& t : all.targets) {
      const VoxelGrid::Ray ray = s.belief.voxels->cast(sensor, t.position, 0.15);
      const double q = ray.blocked ? 0.0
                                   : view.in_footprint(s.belief.pose, t.position) *
                                         std::exp(-0.5 * ray.unknown_length);
      const bool kept = std::any_of(left.targets.begin(), left.targets.end(),
                                    [&](const auto& l) { return l.position == t.position; });
      EXPECT_EQ(kept, q <= 0.5);
    }
  }
  EXPECT_GT(dropped, 0);
}

TEST(ExplorationTargets, DegenerateInput) {
  std::mt19937_64 random(4);
  Scene s = scene(random);
  const auto run = [&](const std::vector<Cell>& cells) {
    return exploration_targets(s.belief, cells, {DepthSensor()});
  };
  EXPECT_TRUE(run({}).targets.empty());
  EXPECT_EQ(run({}).reference_area, 0.3);
  EXPECT_TRUE(run({{100000, -100000}}).targets.empty());
  EXPECT_TRUE(same(run({s.frontier[0], s.frontier[0]}), run({s.frontier[0]})));
  s.belief.pose.position = {500.0, 0.0, 0.0};
  EXPECT_TRUE(run(s.frontier).targets.empty());
  s.belief.pose.position.x() = std::nan("");
  EXPECT_TRUE(run(s.frontier).targets.empty());
  ExplorationTargetOptions bad;
  bad.block = 0.0;
  EXPECT_THROW(exploration_targets(s.belief, s.frontier, {DepthSensor()}, bad),
               std::invalid_argument);
}

}  // namespace
}  // namespace prospect::exploration_targets_test
