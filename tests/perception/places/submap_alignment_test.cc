// SPDX-License-Identifier: Apache-2.0
#include "perception/places/submap_alignment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "perception/mapping/occupancy_mapper.h"
#include "tests/perception/mapping/drawn_room.h"

namespace prospect::submap_alignment_test {
namespace {

constexpr double kR = 0.1;

struct Submap {
  EvidenceTable table{EvidenceTable::Model{}};
  MapEvidence evidence;
  SubmapSurface surface;

  void enter(int scans, const std::function<DepthScan(int)>& scan) {
    OccupancyMapper mapper;
    mapper.record(&evidence, &table);
    for (int n = 0; n < scans; ++n) mapper.insert(scan(n));
    surface = SubmapSurface(evidence, kR, table);
  }
};

DepthScan drawn(DepthScan scan, const PlanarMove& move) {
  scan.origin = move(scan.origin);
  for (Eigen::Vector3d& p : scan.hits) p = move(p);
  for (Eigen::Vector3d& p : scan.misses) p = move(p);
  return scan;
}

/// A corridor along x, without ends.
DepthScan corridor(double x, double noise, std::mt19937_64& generator, double width = 2.0) {
  std::normal_distribution<double> normal(0.0, noise);
  DepthScan scan;
  scan.origin = {x, 0.1, 0.5};
  for (int n = 0; n < 120; ++n) {
    for (int row = -8; row <= 8; ++row) {
      const double a = 2.0 * M_PI * n / 120.0, e = 0.05 * row;
      const Eigen::Vector3d d(std::cos(a) * std::cos(e), std::sin(a) * std::cos(e), std::sin(e));
      const double range = ((d.y() > 0.0 ? 0.5 : -0.5) * width - scan.origin.y()) / d.y();
      if (range > 4.0 || scan.origin.z() + range * d.z() < 0.05) {
        scan.misses.push_back(scan.origin + 5.0 * d);
      } else {
        scan.hits.push_back(scan.origin + d * (range + normal(generator)));
      }
    }
  }
  return scan;
}

// Seen from other places, looking elsewhere, and drawn up to 0.5 m and 8 degrees off.
TEST(SubmapAlignment, FindsHowOneLiesOnTheOther) {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double squared = 0.0;
  constexpr int kPairs = 12;
  for (int pair = 0; pair < kPairs; ++pair) {
    const PlanarMove off{Eigen::Vector2d(0.35 * unit(generator), 0.35 * unit(generator)),
                         0.14 * unit(generator)};
    Submap one, other;
    one.enter(30, [&](int n) { return drawn(room_scan(on_the_way(n), 0.01, generator), off); });
    other.enter(30, [&](int n) { return room_scan(on_the_way(20 + pair + n), 0.01, generator); });
    const NearestWall walls(other.evidence, other.surface, kR, other.table);
    const Eigen::Vector2d centre = on_the_way(30 + pair).position.head<2>();
    const Eigen::Matrix3d spread = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
    const auto found = align(one.surface, walls, {}, spread, centre);
    ASSERT_TRUE(found) << pair;
    const PlanarMove error = found->move * off;
    const Eigen::Vector2d shift = error(centre) - centre;
    EXPECT_LT(shift.norm(), 0.03) << pair;
    EXPECT_LT(std::abs(error.yaw), 0.01) << pair;
    const Eigen::Vector3d e(shift.x(), shift.y(), error.yaw);
    squared += e.dot(found->covariance.ldlt().solve(e));
    EXPECT_GT(found->agreement, 0.8);
  }
  // As sure as it says, or surer.
  EXPECT_LT(squared / (3.0 * kPairs), 1.5);
  std::printf("normalised error squared %.2f\n", squared / (3.0 * kPairs));
}

TEST(SubmapAlignment, ACorridorSaysNothingOfWhatLiesAlongIt) {
  std::mt19937_64 generator(2);
  const PlanarMove off{Eigen::Vector2d(0.1, 0.12), 0.03};
  Submap one, other;
  one.enter(20, [&](int n) { return drawn(corridor(0.1 * n, 0.01, generator), off); });
  other.enter(20, [&](int n) { return corridor(1.0 + 0.1 * n, 0.01, generator); });
  const NearestWall walls(other.evidence, other.surface, kR, other.table);
  const Eigen::Matrix3d spread = Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal();
  const auto found = align(one.surface, walls, {}, spread, {1.0, 0.0});
  ASSERT_TRUE(found);
  EXPECT_GT(std::sqrt(found->covariance(0, 0)), 1.0);
  EXPECT_LT(std::sqrt(found->covariance(1, 1)), 0.05);
  EXPECT_LT(std::sqrt(found->covariance(2, 2)), 0.05);
  const PlanarMove error = found->move * off;
  const Eigen::Vector2d centre(1.0, 0.0);
  EXPECT_NEAR((error(centre) - centre).y(), 0.0, 0.02);
  EXPECT_NEAR(error.yaw, 0.0, 0.01);
}

TEST(SubmapAlignment, TheTwoSidesOfAPartitionAreTwoWalls) {
  std::mt19937_64 generator(4);
  const PlanarMove beyond{Eigen::Vector2d(0.0, 2.1), 0.0};
  Submap one, other;
  one.enter(20, [&](int n) { return corridor(0.1 * n, 0.01, generator); });
  other.enter(20, [&](int n) { return drawn(corridor(0.1 * n, 0.01, generator), beyond); });
  const NearestWall walls(other.evidence, other.surface, kR, other.table);
  for (const double sigma : {0.05, 0.2}) {
    const Eigen::Matrix3d spread = Eigen::Vector3d(sigma * sigma, sigma * sigma, 1e-4).asDiagonal();
    EXPECT_FALSE(align(one.surface, walls, {}, spread, {1.0, 1.0})) << sigma;
  }
  int facing = 0;
  for (const SubmapSurface::Wall& wall : one.surface.walls()) {
    facing += !wall.either && wall.normal.y() * wall.at.y() < 0.0;
  }
  EXPECT_GT(facing, 0.9 * static_cast<double>(one.surface.walls().size())) << "to the corridor";
}

TEST(SubmapAlignment, DoesNotAlignWhatIsNoneOfIts) {
  std::mt19937_64 generator(3);
  Submap one, other, nothing;
  one.enter(20, [&](int n) { return corridor(0.1 * n, 0.01, generator); });
  // One wall can lie on one, and then the other one is where nothing was.
  other.enter(20, [&](int n) { return corridor(0.1 * n, 0.01, generator, 2.9); });
  const NearestWall walls(other.evidence, other.surface, kR, other.table);
  const Eigen::Matrix3d spread = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
  EXPECT_FALSE(align(one.surface, walls, {}, spread, {0.0, 0.0}));
  EXPECT_FALSE(align(nothing.surface, walls, {}, spread, {0.0, 0.0}));
  const NearestWall none(nothing.evidence, nothing.surface, kR, nothing.table);
  EXPECT_FALSE(align(one.surface, none, {}, spread, {0.0, 0.0}));
}

}  // namespace
}  // namespace prospect::submap_alignment_test
