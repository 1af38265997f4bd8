// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/anchored_map.h"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "tests/perception/mapping/drawn_room.h"

namespace prospect::anchored_map_test {
namespace {

constexpr double kR = 0.125;  // exact, so that moves by whole voxels are

OccupancyMapperOptions options() {
  OccupancyMapperOptions o;
  o.resolution = kR;
  return o;
}

struct Difference {
  int known = 0, other = 0;  // voxels known in either; whose states differ
  int walls = 0,
      walls_off = 0;  // surfaces of the first; farther than a voxel from all of the other
  int surfaces[2] = {0, 0};
  double log_odds = 0.0;  // the largest difference
};

Difference compare(OccupancyMapper& a, OccupancyMapper& b) {
  Difference d;
  const auto va = a.voxels(), vb = b.voxels();
  const auto ta = a.octree(), tb = b.octree();
  const GridFrame f = frame_around_both(va->frame(), vb->frame());
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    for (int k = va->k0(); k < va->k0() + va->depth(); ++k) {
      const CellState sa = va->state(c.i, c.j, k), sb = vb->state(c.i, c.j, k);
      d.surfaces[0] += sa == CellState::kOccupied;
      d.surfaces[1] += sb == CellState::kOccupied;
      if (sa == CellState::kUnknown && sb == CellState::kUnknown) continue;
      ++d.known;
      d.other += sa != sb;
      if (sa != CellState::kUnknown && sb != CellState::kUnknown) {
        const octomap::point3d at(static_cast<float>((c.i + 0.5) * kR),
                                  static_cast<float>((c.j + 0.5) * kR),
                                  static_cast<float>((k + 0.5) * kR));
        d.log_odds =
            std::max(d.log_odds, std::abs(static_cast<double>(ta->search(at)->getLogOdds() -
                                                              tb->search(at)->getLogOdds())));
      }
      if (sa != CellState::kOccupied) continue;
      ++d.walls;
      bool near = false;
      for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
          near = near || vb->state(c.i + x, c.j + y, k) == CellState::kOccupied;
        }
      }
      d.walls_off += !near;
    }
  }
  return d;
}

/// A robot that maps the room, with an anchor every `every` scans; n-th scan from `places(n)`.
struct Mapped {
  std::shared_ptr<OccupancyMapper> map = std::make_shared<OccupancyMapper>(options());
  AnchoredMap anchored{map, on_the_way(0)};

  template <typename Drawn>
  Mapped(int scans, int every, const Drawn& drawn) {
    std::mt19937_64 generator(5);
    map->clear_cylinder({2.1, 0.0, 0.0}, 0.3, 1.0);
    for (int n = 0; n < scans; ++n) {
      const PlanarMove move = drawn(n);
      if (n > 0 && n % every == 0) {
        anchored.begin(move(on_the_way(n)), Eigen::Matrix3d::Identity());
      }
      DepthScan scan = room_scan(on_the_way(n), 0.01, generator);
      scan.origin = move(scan.origin);
      for (Eigen::Vector3d& p : scan.hits) p = move(p);
      for (Eigen::Vector3d& p : scan.misses) p = move(p);
      anchored.note(move(on_the_way(n)));
      map->insert(scan);
    }
  }
};

PlanarMove none(int) { return {}; }

std::shared_ptr<const PlaceMoves> follow(AnchoredMap& map, std::vector<PlanarMove> to_W) {
  EXPECT_TRUE(map.follow(std::move(to_W)));
  for (int step = 0; step < 1000; ++step) {
    if (auto done = map.go_on(50)) return done->places;
  }
  return nullptr;
}

TEST(AnchoredMap, IsWhatTheScansMakeOfItWithoutACorrection) {
  Mapped plain(60, 1000, none), anchored(60, 10, none);
  plain.anchored.begin({}, Eigen::Matrix3d::Zero());
  const Difference d = compare(*plain.map, *anchored.map);
  EXPECT_EQ(d.other, 0);
  EXPECT_EQ(d.log_odds, 0.0);
}

TEST(AnchoredMap, TheSumOverAnchorsIsWhatTheScansMade) {
  Mapped direct(80, 1000, none), composed(80, 10, none);
  follow(composed.anchored, std::vector<PlanarMove>(8));
  const Difference d = compare(*direct.map, *composed.map);
  EXPECT_GT(d.known, 20000);
  EXPECT_EQ(d.other, 0);
  EXPECT_LT(d.log_odds, 1e-3);
}

TEST(AnchoredMap, MovedByWholeVoxelsItIsTheMapOfTheMovedScans) {
  // Drawn a metre off up to the 40th scan.
  const PlanarMove off{Eigen::Vector2d(1.0, -0.5), 0.0};
  Mapped wrong(80, 10, [&](int n) { return n < 40 ? off : PlanarMove{}; });
  Mapped right(80, 1000, none);
  EXPECT_GT(compare(*right.map, *wrong.map).other, 2000);
  std::vector<PlanarMove> to_W(8);
  for (int n = 0; n < 4; ++n) to_W[static_cast<std::size_t>(n)] = off.inverse();
  EXPECT_TRUE(wrong.anchored.is_worth(to_W));
  follow(wrong.anchored, to_W);
  const Difference d = compare(*right.map, *wrong.map);
  // The cylinder around the start was cleared before it was known to be off.
  EXPECT_LT(d.other, 0.004 * d.known);
  EXPECT_FALSE(wrong.anchored.is_worth(to_W));
}

TEST(AnchoredMap, TurnedItHasTheSurfacesOfTheMovedScans) {
  const PlanarMove off{Eigen::Vector2d(0.33, -0.21), 0.17};
  Mapped wrong(80, 10, [&](int n) { return n < 40 ? off : PlanarMove{}; });
  Mapped right(80, 1000, none);
  const Difference before = compare(*right.map, *wrong.map);
  EXPECT_GT(compare(*wrong.map, *right.map).walls_off, before.walls / 5);
  std::vector<PlanarMove> to_W(8);
  for (int n = 0; n < 4; ++n) to_W[static_cast<std::size_t>(n)] = off.inverse();
  const auto moves = follow(wrong.anchored, to_W);
  for (const auto& [a, b] : {std::pair(&right, &wrong), std::pair(&wrong, &right)}) {
    const Difference d = compare(*a->map, *b->map);
    EXPECT_LE(d.walls_off, d.walls / 100) << d.walls;
    EXPECT_LT(d.surfaces[0], 1.15 * d.surfaces[1]);
  }
  // A place that was seen from the first anchors goes with them.
  const Eigen::Vector2d place = on_the_way(3).position.head<2>();
  EXPECT_LT((moves->now(off(place)) - place).norm(), 1e-9);
}

TEST(AnchoredMap, NobodySeesHalfACorrection) {
  Mapped mapped(80, 10, none);
  const auto before = mapped.map->voxels();
  const std::vector<CellState> states = before->data();
  ASSERT_TRUE(mapped.anchored.follow(std::vector<PlanarMove>(8, {Eigen::Vector2d(1.0, 0.0), 0.1})));
  EXPECT_FALSE(mapped.anchored.follow(std::vector<PlanarMove>(8))) << "one at a time";
  int steps = 1;
  for (; !mapped.anchored.go_on(50); ++steps) ASSERT_EQ(mapped.map->voxels(), before);
  EXPECT_GT(steps, 4);
  EXPECT_NE(mapped.map->voxels(), before);
  EXPECT_EQ(before->data(), states) << "a snapshot never changes";
}

TEST(AnchoredMap, TakesInWhatIsSeenWhileItFollows) {
  Mapped direct(80, 1000, none), composed(70, 10, none);
  std::mt19937_64 generator(6);
  ASSERT_TRUE(composed.anchored.follow(std::vector<PlanarMove>(7)));
  int more = 0;
  std::mt19937_64 other(6);
  while (!composed.anchored.go_on(50)) {
    const Pose at = on_the_way(70 + more++);
    composed.map->insert(room_scan(at, 0.01, generator));
    direct.map->insert(room_scan(at, 0.01, other));
    if (more == 2) composed.anchored.begin(at, Eigen::Matrix3d::Identity());
  }
  EXPECT_GT(more, 3);
  // The direct one has ten scans more: what differs is little, and nothing is missing.
  const Difference d = compare(*composed.map, *direct.map);
  EXPECT_EQ(composed.anchored.anchors().size(), 8U);
  EXPECT_LT(d.other, d.known / 20);
  EXPECT_LE(d.walls_off, d.walls / 100);
}

TEST(AnchoredMap, StaysOfAsMuchMemoryWhereAnchorsThatSeeTheSameAreMerged) {
  // Each round looks elsewhere; six anchors a round.
  constexpr int kScans = 8 * 90, kEvery = 15, kRound = 6;
  Mapped whole(kScans, kScans, none), apart(kScans, kEvery, none), merged(kScans, kEvery, none);
  const int anchors = static_cast<int>(merged.anchored.anchors().size());
  for (int n = kRound; n + 1 < anchors; ++n) EXPECT_TRUE(merged.anchored.merge(n - kRound, n));
  // Each of the last six has seen the room at most.
  EXPECT_LT(merged.anchored.bytes(), (kRound + 0.5) * whole.anchored.bytes());
  EXPECT_GT(apart.anchored.bytes(), 3 * merged.anchored.bytes());
  follow(merged.anchored, std::vector<PlanarMove>(static_cast<std::size_t>(anchors)));
  const Difference d = compare(*whole.map, *merged.map);
  EXPECT_LT(d.other, d.known / 50);
}

}  // namespace
}  // namespace prospect::anchored_map_test
