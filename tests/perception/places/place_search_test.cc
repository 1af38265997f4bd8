// SPDX-License-Identifier: Apache-2.0
#include "perception/places/place_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <random>
#include <vector>

#include "engine/support/stopwatch.h"
#include "perception/mapping/anchored_map.h"
#include "perception/places/map_loops.h"
#include "tests/perception/mapping/drawn_room.h"  // the way

namespace prospect::place_search_test {
namespace {

constexpr double kR = 0.1;

struct Drawn {
  EvidenceTable table{EvidenceTable::Model{}};
  MapEvidence evidence;
  SubmapSurface surface;

  explicit Drawn(int scans, const std::function<DepthScan(int)>& scan) {
    OccupancyMapper mapper;
    mapper.record(&evidence, &table);
    for (int n = 0; n < scans; ++n) mapper.insert(scan(n));
    surface = SubmapSurface(evidence, kR, table);
  }
  PlaceRaster raster() const {
    PlaceRaster raster;
    raster.add(evidence, surface, {}, kR, table);
    raster.build();
    return raster;
  }
};

DepthScan moved(DepthScan scan, const PlanarMove& move) {
  scan.origin = move(scan.origin);
  for (Eigen::Vector3d& p : scan.hits) p = move(p);
  for (Eigen::Vector3d& p : scan.misses) p = move(p);
  return scan;
}

/// All round, in a box of 2 a x 2 b about the origin.
DepthScan box_scan(const Eigen::Vector2d& from, double a, double b) {
  DepthScan scan;
  scan.origin = {from.x(), from.y(), 0.5};
  for (int row = 0; row < 12; ++row) {
    for (int n = 0; n < 240; ++n) {
      const double angle = 2.0 * M_PI * n / 240;
      const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
      const double s = std::min((std::copysign(a, d.x()) - from.x()) / d.x(),
                                (std::copysign(b, d.y()) - from.y()) / d.y());
      scan.hits.emplace_back(from.x() + s * d.x(), from.y() + s * d.y(), 0.25 + 0.1 * row);
    }
  }
  return scan;
}

/// A depth image, as rays, in a hall of 9 x 7 m whose one corner is a store room, with a cupboard
/// and two boxes.
DepthScan look(int n, std::mt19937_64& generator) {
  static const double boxes[][4] = {{-3.5, -3.0, 5.5, 4.0},
                                    {3.0, 1.5, 5.5, 4.0},
                                    {-3.5, 0.5, -3.0, 2.0},
                                    {0.2, -0.3, 0.8, 0.3},
                                    {1.5, -3.0, 2.3, -2.4}};
  std::normal_distribution<double> noise(0.0, 0.01);
  const Pose robot = on_the_way(n);
  DepthScan scan;
  scan.origin = robot.position;
  for (int column = 0; column < 80; ++column) {
    const double angle = robot.yaw + 1.22 * ((column + 0.5) / 80 - 0.5);
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle)), o = robot.position.head<2>();
    double range = 100.0;
    for (const auto& b : boxes) {
      for (int a = 0; a < 2; ++a) {
        for (const double side : {b[a], b[a + 2]}) {
          const double s = (side - o[a]) / d[a], other = o[1 - a] + s * d[1 - a];
          if (s > 1e-6 && other >= b[1 - a] && other <= b[3 - a]) range = std::min(range, s);
        }
      }
    }
    for (int row = 0; row < 12; ++row) {
      const double up = 0.1 * (row - 4);
      const Eigen::Vector3d ray(d.x(), d.y(), up / std::max(range, 0.5));
      if (range < 4.0) {
        scan.hits.emplace_back(scan.origin + (range + noise(generator)) * ray);
      } else {
        scan.misses.emplace_back(scan.origin + 4.0 * ray);
      }
    }
  }
  return scan;
}

PlaceSearch::State searched(PlaceSearch& search) {
  ProcessorStopwatch watch;
  while (search.go_on(500'000) == PlaceSearch::State::kSearching) {
  }
  std::printf("%zu places, the best %.2f, in %.0f ms\n", search.places().size(),
              search.places().empty() ? 0.0 : search.places()[0].score, watch.lap());
  return search.state();
}

TEST(PlaceSearch, FindsTheOnePlaceFromAnywhere) {
  std::mt19937_64 generator{5};
  const Drawn room(90, [&](int n) { return look(n, generator); });
  const PlaceRaster raster = room.raster();
  for (const double yaw : {0.0, 2.0, -2.5}) {
    const PlanarMove off{{8.0, -3.0}, yaw};
    const Drawn part(25, [&](int n) { return moved(look(30 + n, generator), off); });
    const Eigen::Vector2d at = off(Eigen::Vector2d(on_the_way(54).position.head<2>()));
    PlaceSearch search(raster, part.surface.walls(), part.raster().free(), at);
    EXPECT_EQ(searched(search), PlaceSearch::State::kUnique) << yaw;
    ASSERT_FALSE(search.places().empty());
    const PlanarMove error = search.places()[0].move * off;
    EXPECT_LT((error(Eigen::Vector2d(on_the_way(54).position.head<2>())) -
               on_the_way(54).position.head<2>())
                  .norm(),
              0.2);
    EXPECT_LT(std::abs(std::remainder(error.yaw, 2.0 * M_PI)), 0.06);
  }
}

TEST(PlaceSearch, SaysThatARoomLooksAlikeFromBothEnds) {
  const Drawn room(3, [](int n) { return box_scan({n - 1.0, 0.5 * n - 0.5}, 3.0, 2.0); });
  const Drawn part(2, [](int n) { return box_scan({0.5 * n, 0.3}, 3.0, 2.0); });
  const PlaceRaster raster = room.raster();
  PlaceSearch search(raster, part.surface.walls(), part.raster().free(), {0.5, 0.3});
  EXPECT_EQ(searched(search), PlaceSearch::State::kAmbiguous);
  ASSERT_GE(search.places().size(), 2u);
  const PlanarMove apart = search.places()[0].move * search.places()[1].move.inverse();
  EXPECT_NEAR(std::abs(std::remainder(apart.yaw, 2.0 * M_PI)), M_PI, 0.1);
}

TEST(PlaceSearch, FindsNothingInAnotherPlace) {
  std::mt19937_64 generator{5};
  const Drawn room(90, [&](int n) { return look(n, generator); });
  const Drawn other(3, [](int n) { return box_scan({n - 1.0, 0.0}, 1.6, 1.2); });
  const PlaceRaster raster = room.raster();
  PlaceSearch search(raster, other.surface.walls(), other.raster().free(), {1.0, 0.0});
  EXPECT_EQ(searched(search), PlaceSearch::State::kNowhere);
}

/// A robot that goes about the room, and is carried to another place of its way. Where it is, it
/// knows by its motion alone.
struct Carried {
  std::shared_ptr<OccupancyMapper> map = std::make_shared<OccupancyMapper>();
  AnchoredMap anchored{map, on_the_way(0)};
  MapLoops loops;
  Pose estimate = on_the_way(0);
  std::vector<MapLoops::Followed> followed;
  std::mt19937_64 generator{7};
  int at = 0;

  void go(int steps) {
    for (const int end = at + steps; at < end;) {
      const Pose before = on_the_way(at), now = on_the_way(++at);
      const PlanarMove drawn = move_between(before, estimate);
      estimate = drawn(now);
      map->insert(moved(look(at, generator), move_between(now, estimate)));
      if (at % 20 == 0) anchored.begin(estimate, 1e-4 * at * Eigen::Matrix3d::Identity());
      anchored.note(estimate);
      if (auto done = loops.go_on(anchored, 0.2 * at)) followed.push_back(std::move(*done));
    }
  }
  void carry(int places) {
    at += places;
    loops.lift(anchored, estimate, 1e-4 * at * Eigen::Matrix3d::Identity());
  }
  double error() const {
    return (loops.origin()(estimate).position - on_the_way(at).position).norm();
  }
};

TEST(PlaceSearch, ARobotThatWasCarriedFindsItsPlaceByTheMap) {
  Carried robot;
  robot.go(130);
  const int walls = static_cast<int>(robot.map->surface_voxels());
  const std::size_t before = robot.followed.size();
  robot.carry(45);
  EXPECT_GT(robot.error(), 2.5);
  EXPECT_EQ(robot.map->surface_voxels(), 0u) << "it draws a map apart";
  EXPECT_FALSE(robot.loops.seeking().empty());
  int steps = 0;
  while (!robot.loops.seeking().empty() && steps < 300) robot.go(1), ++steps;
  robot.go(40);
  std::printf("found after %d steps, %.3f m off\n", steps, robot.error());
  ASSERT_TRUE(robot.loops.seeking().empty()) << robot.loops.seeking();
  ASSERT_GT(robot.followed.size(), before);
  EXPECT_EQ(robot.followed[before].correction.why, "the place in the map was found");
  EXPECT_LT(robot.error(), 0.1);
  EXPECT_GT(robot.map->surface_voxels(), 0.9 * walls) << "both maps are one";
  EXPECT_EQ(robot.anchored.first(), 0);
}

TEST(PlaceSearch, ARobotThatWasCarriedTwiceFindsItsPlaceAsWell) {
  Carried robot;
  robot.go(130);
  robot.carry(45);
  robot.go(10);
  robot.carry(-30);
  int steps = 0;
  while (!robot.loops.seeking().empty() && steps < 300) robot.go(1), ++steps;
  robot.go(60);
  ASSERT_TRUE(robot.loops.seeking().empty()) << robot.loops.seeking();
  EXPECT_LT(robot.error(), 0.1);
}

}  // namespace
}  // namespace prospect::place_search_test
