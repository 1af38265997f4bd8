// SPDX-License-Identifier: Apache-2.0
#include "perception/mapping/depth_mapper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <vector>

#include "engine/maps/floor_state.h"
#include "engine/maps/map_projection.h"
#include "perception/mapping/met_twice.h"
#include "tests/not_under_sanitizers.h"
#include "tests/perception/depth_faults.h"
#include "tests/perception/depth_scene.h"

namespace prospect::depth_mapper_test {
namespace {

using test::DepthFrame;
using test::DepthScene;

constexpr double kDegree = M_PI / 180.0;
const PinholeCamera kCamera{420.0, 420.0, 319.5, 239.5, 640.0, 480.0};

DepthScene furnished() {
  DepthScene scene;
  scene.boxes = {{{1.3, -0.9, 0.0}, {1.7, -0.4, 0.9}}, {{2.2, 0.6, 0.0}, {2.9, 1.4, 0.55}}};
  return scene;
}

DepthMapperOptions fine() {
  DepthMapperOptions options;
  options.map.resolution = 0.05;
  return options;
}

/// How far from a surface an occupied voxel's centre may be: one and a half voxels (half of its
/// own, the offset of a hit, the lattice) and the noise at the map's range.
constexpr double kNoise = 0.002;  // [1/m]
constexpr double kNearSurface = 1.5 * 0.05 + 4.0 * kNoise * 3.5 * 3.5;

/// Frame k of a walk through the room: 0.1 s, 3 cm and 2 degrees further than the one before.
DepthFrame walk(const DepthScene& scene, int k, double noise = kNoise) {
  DepthFrame frame;
  frame.stamp = 0.1 * k;
  frame.T_WC = DepthScene::looking(-1.4 + 0.03 * k, 0.05 * std::sin(0.3 * k), 0.62,
                                   (2.0 * k - 8.0) * kDegree, 18.0 * kDegree, 2.0 * kDegree);
  frame.image = scene.render(kCamera, frame.T_WC, noise, 100 + static_cast<std::uint64_t>(k));
  return frame;
}

/// Distance of a point to the nearest surface of the scene [m].
double to_surface(const DepthScene& scene, const Eigen::Vector3d& p) {
  double d = (p - scene.room.low).cwiseAbs().minCoeff();
  d = std::min(d, (p - scene.room.high).cwiseAbs().minCoeff());
  for (const DepthScene::Box& box : scene.boxes) {
    const Eigen::Vector3d outside =
        (box.low - p).cwiseMax(p - box.high).cwiseMax(Eigen::Vector3d::Zero());
    const double inside = std::min((p - box.low).minCoeff(), (box.high - p).minCoeff());
    d = std::min(d, std::max(outside.norm(), inside));
  }
  return d;
}

template <typename Visit>
void each_voxel(const VoxelGrid& voxels, Visit visit) {
  const GridFrame f = voxels.frame();
  for (int j = f.j0; j < f.j0 + f.height; ++j) {
    for (int i = f.i0; i < f.i0 + f.width; ++i) {
      for (int k = voxels.k0(); k < voxels.k0() + voxels.depth(); ++k) {
        visit(i, j, k, voxels.state(i, j, k));
      }
    }
  }
}

TEST(DepthMapper, MapsARoomWhoseFloorIsNoObstacle) {
  const DepthScene scene = furnished();
  DepthMapper mapper(kCamera, fine());
  std::vector<double> ms;
  for (int k = 0; k < 12; ++k) {
    const DepthFrame frame = walk(scene, k);
    const MappedFrame out = mapper.process(frame.stamp, frame.image, frame.T_WC);
    EXPECT_EQ(out.state, Mapping::kOk) << out.reason;
    EXPECT_TRUE(out.ground.found);
    ms.push_back(out.times.total());
    if (k == 6) {
      std::printf(
          "stride %d, %d obstacle + %d floor + %d far rays: check %.1f, ground %.1f, scan "
          "%.1f, insert %.1f ms\n",
          mapper.stride(), out.hits, out.floor, out.misses, out.times.check, out.times.ground,
          out.times.scan, out.times.insert);
    }
  }
  std::sort(ms.begin(), ms.end());
  std::printf("640 x 480 at 0.05 m: median %.1f ms of processor a frame\n", ms[6]);

  const auto ground = mapper.map().ground();
  const GridFrame f = ground->frame();
  int free = 0, wrong_free = 0, wrong_occupied = 0, box = 0;
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    const Eigen::Vector2d p = f.center(c);
    double d = 1e9;  // to what the body slice meets, walls and boxes; negative inside
    for (int i = 0; i < 2; ++i) {
      d = std::min({d, p[i] - scene.room.low[i], scene.room.high[i] - p[i]});
    }
    for (const DepthScene::Box& b : scene.boxes) {
      const Eigen::Vector2d out = (b.low.head<2>() - p).cwiseMax(p - b.high.head<2>());
      d = std::min(
          d, out.maxCoeff() < 0.0 ? out.maxCoeff() : out.cwiseMax(Eigen::Vector2d::Zero()).norm());
      box += ground->state(c) == CellState::kOccupied && std::abs(out.maxCoeff()) < 0.05;
    }
    free += ground->state(c) == CellState::kFree;
    wrong_free += ground->state(c) == CellState::kFree && d < -0.05;
    wrong_occupied += ground->state(c) == CellState::kOccupied && d > kNearSurface;
  }
  EXPECT_GT(free, 2000);
  EXPECT_GT(box, 10);
  EXPECT_EQ(wrong_free, 0);
  EXPECT_EQ(wrong_occupied, 0);
  each_voxel(*mapper.map().voxels(), [&](int i, int j, int k, CellState state) {
    if (state != CellState::kOccupied) return;
    const Eigen::Vector3d p = 0.05 * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
    EXPECT_LT(to_surface(scene, p), kNearSurface) << p.transpose();
  });
}

// An unevenness of 2 cm and a camera whose tilt is known to a degree only: the floor is flat in the
// map, not a voxel stands out of it.
TEST(DepthMapper, UnevenFloorIsFlat) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  DepthScene scene;
  for (int n = 0; n < 12; ++n) {
    const double x = -0.5 + 0.35 * n, y = -1.0 + 0.9 * (n % 3);
    scene.boxes.push_back({{x, y, 0.0}, {x + 0.2, y + 0.3, 0.01 + 0.001 * n}});
  }
  DepthMapperOptions options = fine();
  options.pose_sigma_tilt = 0.02;
  DepthMapper mapper(kCamera, options);
  for (int k = 0; k < 6; ++k) {
    DepthFrame frame = walk(scene, k);
    frame.T_WC.rotate(Eigen::AngleAxisd(1.0 * kDegree, Eigen::Vector3d::UnitX()));
    EXPECT_TRUE(mapper.process(frame.stamp, frame.image, frame.T_WC).ground.found);
  }
  int floor = 0;
  each_voxel(*mapper.map().voxels(), [&](int i, int j, int k, CellState state) {
    const Eigen::Vector2d p = 0.05 * Eigen::Vector2d(i + 0.5, j + 0.5);
    if (state != CellState::kOccupied || p.x() > 3.8 || std::abs(p.y()) > 2.2) return;
    EXPECT_EQ(k, -1) << p.transpose();
    ++floor;
  });
  EXPECT_GT(floor, 1000);
}

constexpr double kPit[4] = {-0.4, 0.9, -0.3, 0.2};  // x, y

DepthScene pit() {
  DepthScene scene;
  scene.room.low.z() = -0.5;
  scene.boxes = {{{-3.0, -3.0, -0.5}, {kPit[0], 3.0, 0.0}},
                 {{kPit[1], -3.0, -0.5}, {5.0, 3.0, 0.0}},
                 {{kPit[0], -3.0, -0.5}, {kPit[1], kPit[2], 0.0}},
                 {{kPit[0], kPit[3], -0.5}, {kPit[1], 3.0, 0.0}}};
  return scene;
}

struct PitCells {
  int missing = 0, inside = 0;  ///< in the pit: without floor, with floor
  int wrong = 0, around = 0;    ///< elsewhere, likewise
};

PitCells pit_cells(DepthMapper& mapper) {
  const FloorLayers layers =
      slice_layers(mapper.map().options().slice, mapper.map().options().resolution).floor;
  const auto voxels = mapper.map().voxels();
  const GridFrame f = voxels->frame();
  PitCells cells;
  for (int n = 0; n < f.size(); ++n) {
    const Cell c = f.at(n);
    const Eigen::Vector2d p = f.center(c);
    const auto within = [&](double more) {
      return p.x() > kPit[0] - more && p.x() < kPit[1] + more && p.y() > kPit[2] - more &&
             p.y() < kPit[3] + more;
    };
    const bool floor = voxels->state(c.i, c.j, -1) == CellState::kOccupied;
    const bool is_missing = floor_state(*voxels, c, layers) == FloorState::kMissing;
    cells.inside += within(-0.1) && floor;
    cells.around += !within(-0.1) && floor;
    cells.missing += within(-0.1) && is_missing;
    cells.wrong += !within(0.1) && is_missing;
  }
  return cells;
}

// What is measured below the floor is no floor, and shows that there is none.
TEST(DepthMapper, WhereRaysGoOnBelowTheFloorItIsMissing) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  for (const bool mismatches : {false, true}) {
    DepthMapperOptions options = fine();
    options.mismatches = mismatches;
    DepthMapper mapper(kCamera, options);
    // Where depths may be mismatches, a tenth of a metre on the way is two places.
    const int frames = mismatches ? 9 : 5;
    for (int k = 0; k < frames; ++k) {
      const DepthFrame frame = walk(pit(), k);
      const MappedFrame mapped = mapper.process(frame.stamp, frame.image, frame.T_WC);
      EXPECT_EQ(mapped.state, Mapping::kOk);
      EXPECT_TRUE(mapped.below > 0 || (mismatches && k <= 5));
    }
    const PitCells cells = pit_cells(mapper);
    std::printf("%d cells of the hole are known to be one\n", cells.missing);
    EXPECT_GT(cells.missing, 20);
    EXPECT_EQ(cells.wrong, 0);
    EXPECT_EQ(cells.inside, 0);
    EXPECT_GT(cells.around, 1000);
  }
}

// A camera that stands sees the same wrong match again, one that goes on sees it elsewhere.
TEST(DepthMapper, AMismatchIsNoHole) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  for (const bool stands : {false, true}) {
    DepthMapperOptions options = fine();
    options.mismatches = true;
    DepthMapper wary(kCamera, options), trusting(kCamera, fine());
    int below = 0, wrong = 0;
    for (int k = 0; k < 9; ++k) {
      DepthFrame frame = walk(DepthScene(), stands ? 0 : k);
      frame.stamp = 0.1 * k;
      for (int v = 380; v < 420; ++v) {
        for (int u = 200; u < 260; ++u) {
          frame.image.at(u, v) *= 1.4F + 0.1F * static_cast<float>(stands ? 0 : k);
        }
      }
      frame.image.at(0, k) = DepthImage::kInvalid;  // no image is the one before again
      below += wary.process(frame.stamp, frame.image, frame.T_WC).below;
      wrong += trusting.process(frame.stamp, frame.image, frame.T_WC).below;
    }
    EXPECT_EQ(below, 0);
    EXPECT_GT(wrong, 100);  // what it is about
    EXPECT_EQ(pit_cells(wary).wrong, 0);
  }
}

// Where the pose is too low, what stands on the floor seems to lie below it.
TEST(DepthMapper, WhatStandsOutOfTheFloorDoesNotShowThatThereIsNone) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  DepthScene scene;
  scene.boxes = {{{-0.2, -0.6, 0.0}, {0.8, 0.6, 0.045}}};
  DepthMapper mapper(kCamera, fine());
  int hits = 0;
  for (int k = 0; k < 5; ++k) {
    DepthFrame frame = walk(scene, k);
    frame.T_WC.translation().z() -= 0.11;
    hits += mapper.process(frame.stamp, frame.image, frame.T_WC).hits;
  }
  EXPECT_GT(hits, 100);
  const PitCells cells = pit_cells(mapper);
  EXPECT_EQ(cells.wrong + cells.missing, 0);
  EXPECT_GT(cells.around, 1000);
}

TEST(MetTwice, OfASurfaceFromTwoPlacesAlone) {
  const Eigen::Vector3d p(2.03, 0.03, -0.33), eye(0.0, 0.0, 0.45), on(0.15, 0.02, 0.45);
  MetTwice met(0.1);
  EXPECT_FALSE(met.meet(eye, p, 0.02));
  EXPECT_FALSE(met.meet(eye, p, 0.02));  // from the same place
  EXPECT_FALSE(met.meet(on, p + Eigen::Vector3d(1.0, 0.0, -0.4), 0.02));
  EXPECT_TRUE(met.meet(on, p, 0.02));
  // As far along the ray as the error may be.
  const Eigen::Vector3d farther = on + 1.2 * (p - on);
  EXPECT_FALSE(MetTwice(met).meet(on, farther, 0.02));
  EXPECT_TRUE(MetTwice(met).meet(on, farther, 0.2));
  EXPECT_FALSE(met.meet(on, {NAN, 0.0, 0.0}, 0.02));
  EXPECT_FALSE(met.meet(on, {1e300, 0.0, 0.0}, 0.02));
}

/// The image with pixels at the edges of things as real sensors give them: between both depths.
DepthImage with_mixed_pixels(const DepthImage& image) {
  DepthImage mixed = image;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 1; u + 1 < image.width; ++u) {
      const float a = image.at(u, v), b = image.at(u + 1, v);
      if (std::abs(a - b) > 0.3F) mixed.at(u, v) = 0.5F * (a + b);
    }
  }
  return mixed;
}

TEST(DepthMapper, WhatMovesIsNoObstacleAndChangesNothingElse) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  DepthScene scene = furnished();
  scene.boxes.emplace_back();
  DepthMapper told(kCamera, fine()), untold(kCamera, fine());
  Eigen::AlignedBox3d way;
  int moving = 0;
  for (int k = 0; k < 10; ++k) {
    const double y = -0.6 + 0.12 * k;
    const Eigen::Vector3d low(0.2, y, 0.0), high(0.6, y + 0.4, 1.6);
    scene.boxes.back() = {low, high};
    way.extend(low).extend(high);
    const DepthFrame frame = walk(scene, k, 0.0);
    MotionInView motion;
    for (const double z : {0.3, 0.6, 0.9, 1.2, 1.5}) motion.moving.emplace_back(0.2, y + 0.2, z);
    moving += told.process(frame.stamp, frame.image, frame.T_WC, Localization::kOk, &motion).moving;
    // Landmarks that rest change nothing.
    MotionInView rest;
    rest.still.emplace_back(4.07, 0.0, 1.0);
    untold.process(frame.stamp, frame.image, frame.T_WC, Localization::kOk,
                   k % 2 ? &rest : nullptr);
  }
  EXPECT_GT(moving, 1000);
  const auto before = untold.map().voxels();
  int trail = 0;
  // Where the box stood and a voxel about it, which a hit may reach.
  const Eigen::AlignedBox3d near(way.min() - Eigen::Vector3d(0.06, 0.06, 0.0),
                                 way.max() + Eigen::Vector3d(0.06, 0.06, 0.06));
  each_voxel(*told.map().voxels(), [&](int i, int j, int k, CellState state) {
    const Eigen::Vector3d p = 0.05 * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
    if (near.contains(p)) {
      EXPECT_NE(state, CellState::kOccupied) << p.transpose();
      trail += before->state(i, j, k) == CellState::kOccupied;
    } else if (k >= 0) {
      EXPECT_EQ(state, before->state(i, j, k)) << p.transpose();
    }
  });
  EXPECT_GT(trail, 50);
}

TEST(DepthMapper, MixedPixelsAreNoObstacles) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  const DepthScene scene = furnished();
  DepthMapper mapper(kCamera, fine());
  for (int k = 0; k < 6; ++k) {
    const DepthFrame frame = walk(scene, k, 0.0);
    mapper.process(frame.stamp, with_mixed_pixels(frame.image), frame.T_WC);
  }
  each_voxel(*mapper.map().voxels(), [&](int i, int j, int k, CellState state) {
    if (state != CellState::kOccupied) return;
    const Eigen::Vector3d p = 0.05 * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
    EXPECT_LT(to_surface(scene, p), 0.08) << p.transpose();
  });
}

TEST(DepthMapper, GroundCorrectsTheTilt) {
  const DepthScene scene = furnished();
  DepthMapperOptions options = fine();
  options.pose_sigma_tilt = 0.05;
  options.pose_sigma_height = 0.05;
  DepthMapper mapper(kCamera, options);
  DepthFrame frame = walk(scene, 3);
  const Eigen::Isometry3d truth = frame.T_WC;
  frame.T_WC.rotate(Eigen::AngleAxisd(2.0 * kDegree, Eigen::Vector3d::UnitX()));
  frame.T_WC.translation().z() += 0.04;
  const MappedFrame out = mapper.process(frame.stamp, frame.image, frame.T_WC);
  EXPECT_EQ(out.state, Mapping::kOk) << out.reason;
  EXPECT_LT(Eigen::AngleAxisd(truth.linear().transpose() * out.T_WC.linear()).angle(),
            0.25 * kDegree);
  EXPECT_NEAR(out.T_WC.translation().z(), truth.translation().z(), 0.005);
  // A pose that is exact stays as it is.
  DepthMapper trusting(kCamera, fine());
  EXPECT_EQ(trusting.process(frame.stamp, frame.image, frame.T_WC).T_WC.matrix(),
            frame.T_WC.matrix());
}

TEST(DepthMapper, WithoutGroundIsDegradedAndMapped) {
  DepthScene scene;
  scene.room.high.x() = 1.0;
  DepthMapper mapper(kCamera, fine());
  const Eigen::Isometry3d T = DepthScene::looking(0.2, 0.0, 1.0, 0.0);
  const MappedFrame out = mapper.process(0.0, scene.render(kCamera, T, 0.002), T);
  EXPECT_EQ(out.state, Mapping::kDegraded);
  EXPECT_NE(out.reason.find("no ground"), std::string::npos) << out.reason;
  EXPECT_GT(out.hits, 1000);
  EXPECT_EQ(mapper.map().voxels()->state(20, 0, 20), CellState::kOccupied);
}

TEST(DepthMapper, APoseThatIsNotOkDoesNotExtendTheMap) {
  DepthMapper mapper(kCamera);
  const DepthScene scene = furnished();
  for (int k = 0; k < 4; ++k) {
    const DepthFrame frame = walk(scene, k, 0.0);
    const Localization pose = k == 1   ? Localization::kDegraded
                              : k == 2 ? Localization::kLost
                                       : Localization::kOk;
    const std::uint64_t before = mapper.map().surface_voxels();
    const MappedFrame out = mapper.process(frame.stamp, frame.image, frame.T_WC, pose);
    EXPECT_EQ(out.state, pose == Localization::kOk ? Mapping::kOk : Mapping::kRejected);
    EXPECT_EQ(mapper.map().surface_voxels() > before, pose == Localization::kOk) << k;
    EXPECT_EQ(out.reason, k == 1 ? "the pose is degraded" : k == 2 ? "the pose is lost" : "");
  }
}

// What an image knows less of, the map knows less of: pixels made invalid never add knowledge.
TEST(DepthMapper, InvalidPixelsSayNothing) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  const DepthScene scene = furnished();
  std::mt19937 generator(5);
  for (int trial = 0; trial < 6; ++trial) {
    DepthFrame frame = walk(scene, 2 * trial, 0.0);
    frame.image = with_mixed_pixels(frame.image);
    DepthImage holed = frame.image;
    const int u0 = static_cast<int>(generator() % 400), v0 = static_cast<int>(generator() % 250);
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        const bool inside = u >= u0 && u < u0 + 200 && v >= v0 && v < v0 + 200;
        if (inside || generator() % 10 == 0) holed.at(u, v) = DepthImage::kInvalid;
      }
    }
    DepthMapper all(kCamera, fine()), less(kCamera, fine());
    ASSERT_NE(all.process(0.0, frame.image, frame.T_WC).state, Mapping::kRejected);
    ASSERT_NE(less.process(0.0, holed, frame.T_WC).state, Mapping::kRejected);
    const auto known = all.map().voxels();
    int fewer = 0;
    each_voxel(*less.map().voxels(), [&](int i, int j, int k, CellState state) {
      if (state != CellState::kUnknown) {
        EXPECT_NE(known->state(i, j, k), CellState::kUnknown) << i << " " << j << " " << k;
      }
      // One scan: what is free with fewer rays may have been hit by one of the others, never the
      // other way round.
      if (state == CellState::kOccupied) {
        EXPECT_EQ(known->state(i, j, k), CellState::kOccupied);
      }
    });
    each_voxel(*known, [&](int i, int j, int k, CellState state) {
      fewer += state != CellState::kUnknown &&
               less.map().voxels()->state(i, j, k) == CellState::kUnknown;
    });
    EXPECT_GT(fewer, 500);
  }
}

TEST(DepthMapper, EveryKindOfInvalidIsTheSame) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  const DepthScene scene = furnished();
  const DepthFrame frame = walk(scene, 4);
  const float inf = std::numeric_limits<float>::infinity();
  std::vector<std::uint64_t> surface;
  std::vector<int> free;
  for (const float z : {DepthImage::kInvalid, 0.0F, -2.0F, inf, -inf, 65.535F, 0.1F, 9.0F, 1e30F}) {
    DepthImage image = frame.image;
    for (int v = 100; v < 300; ++v) {
      for (int u = 200; u < 500; ++u) image.at(u, v) = z;
    }
    DepthMapper mapper(kCamera, fine());
    EXPECT_EQ(mapper.process(0.0, image, frame.T_WC).state, Mapping::kOk);
    int n = 0;
    each_voxel(*mapper.map().voxels(),
               [&](int, int, int, CellState state) { n += state == CellState::kFree; });
    surface.push_back(mapper.map().surface_voxels());
    free.push_back(n);
  }
  for (std::size_t i = 1; i < free.size(); ++i) {
    EXPECT_EQ(free[i], free[0]) << i;
    EXPECT_EQ(surface[i], surface[0]) << i;
  }
}

// A box was seen; then the image is invalid where it is, for long: it stays.
TEST(DepthMapper, InvalidNeverClearsWhatWasSeen) {
  NOT_UNDER_SANITIZERS("one way through the mapping, with other depths");
  const DepthScene scene = furnished();
  DepthMapper mapper(kCamera, fine());
  const DepthFrame frame = walk(scene, 6, 0.0);
  ASSERT_EQ(mapper.process(0.0, frame.image, frame.T_WC).state, Mapping::kOk);
  const std::shared_ptr<const VoxelGrid> before = mapper.map().voxels();
  DepthScene empty = scene;
  empty.boxes.clear();
  for (int k = 1; k < 20; ++k) {
    // Rays that the boxes stopped are invalid now; the others see the room as it is.
    DepthImage image = empty.render(kCamera, frame.T_WC, 0.0005, static_cast<std::uint64_t>(k));
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        if (frame.image.at(u, v) < empty.depth(kCamera, frame.T_WC, u, v) - 0.01) {
          image.at(u, v) = k % 2 == 0 ? 0.0F : DepthImage::kInvalid;
        }
      }
    }
    ASSERT_NE(mapper.process(0.1 * k, image, frame.T_WC).state, Mapping::kRejected);
  }
  const auto after = mapper.map().voxels();
  int kept = 0, lost = 0;
  each_voxel(*before, [&](int i, int j, int k, CellState state) {
    const Eigen::Vector3d p = 0.05 * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
    // Voxels inside the silhouette of a box, whose neighbours no valid ray passes either.
    bool inner = false;
    for (const DepthScene::Box& b : scene.boxes) {
      inner = inner || (((p - b.low).array() > -0.03).all() && p.y() > b.low.y() + 0.1 &&
                        p.y() < b.high.y() - 0.1 && p.z() > 0.1 && p.z() < b.high.z() - 0.1 &&
                        p.x() < b.low.x() + 0.08);
    }
    if (state != CellState::kOccupied || !inner) return;
    ++(after->state(i, j, k) == CellState::kOccupied ? kept : lost);
  });
  EXPECT_GT(kept, 30);
  EXPECT_EQ(lost, 0);
}

TEST(DepthMapper, Faults) {
  const DepthScene scene = furnished();
  constexpr int kFrames = 11, kFirst = 4;
  std::vector<DepthFrame> frames;
  for (int k = 0; k < kFrames; ++k) frames.push_back(walk(scene, k));
  for (const test::DepthFault& fault : test::depth_faults()) {
    DepthMapper mapper(kCamera);
    test::expect_fault_noticed(
        fault, mapper, kFrames, kFirst, [&](int k) { return frames[k]; },
        [](int) { return Mapping::kOk; });
    const double r = mapper.map().options().resolution;
    each_voxel(*mapper.map().voxels(), [&](int i, int j, int k, CellState state) {
      if (state != CellState::kOccupied) return;
      const Eigen::Vector3d p = r * Eigen::Vector3d(i + 0.5, j + 0.5, k + 0.5);
      EXPECT_LT(to_surface(scene, p), kNearSurface + r) << fault.name << ": " << p.transpose();
    });
  }
}

// A camera without noise that stands shows the same again and again; one that hangs, too.
TEST(DepthMapper, TheSameImageIsOldOnlyIfTheCameraHasMoved) {
  const DepthScene scene = furnished();
  const auto at = [](double x, double yaw) {
    return DepthScene::looking(x, 0.0, 0.62, yaw, 18.0 * kDegree);
  };
  const DepthImage image = scene.render(kCamera, at(-1.4, 0.0), 0.0, 1);
  for (const auto& [speed, rate] : {std::pair{0.0, 0.0}, {0.05, 0.0}, {0.0, 0.05}}) {
    DepthMapper mapper(kCamera);
    for (int k = 0; k < 40; ++k) {
      // Poses of one that stands err, too.
      const double t = 0.1 * k, error = k % 2 == 0 ? 0.001 : -0.001;
      const MappedFrame out =
          mapper.process(t, image, at(-1.4 + speed * t + error, rate * t - error));
      const bool moved = std::max(speed, rate) * t > 0.025;
      const bool stands = std::max(speed, rate) * t < 0.015;
      if (stands) {
        EXPECT_EQ(out.state, Mapping::kOk) << t << ' ' << out.reason;
      }
      if (moved) {
        EXPECT_EQ(out.reason, "the image is frozen") << t;
      }
    }
  }
}

// The first pose of all may be a wild one: it is not what the next is held to.
TEST(DepthMapper, AWildFirstPoseIsNotBelieved) {
  const DepthScene scene = furnished();
  DepthMapper mapper(kCamera);
  for (int k = 0; k < 3; ++k) {
    DepthFrame frame = walk(scene, k);
    if (k == 0) frame.T_WC.translation().x() = 1e12;
    const MappedFrame out = mapper.process(frame.stamp, frame.image, frame.T_WC);
    EXPECT_EQ(out.state, k == 0 ? Mapping::kRejected : Mapping::kOk) << out.reason;
  }
}

TEST(DepthMapper, SurvivesRandomInput) {
  std::mt19937_64 generator(9);
  const float inf = std::numeric_limits<float>::infinity();
  const float special[] = {DepthImage::kInvalid, 0.0F, inf, -inf, 1e38F, 1e-38F, -1.0F, 0.5F, 3.0F};
  const PinholeCamera small{40.0, 40.0, 32.0, 24.0, 64.0, 48.0};
  DepthMapper mapper(small, fine());
  double stamp = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const int w = generator() % 8 == 0 ? static_cast<int>(generator() % 70) : 64;
    DepthImage image(w, 48);
    for (float& z : image.depth) {
      z = generator() % 3 == 0 ? special[generator() % 9]
                               : 0.2F + 1e-3F * static_cast<float>(generator() % 3000);
    }
    if (generator() % 16 == 0 && !image.depth.empty()) image.depth.pop_back();
    Eigen::Isometry3d T = DepthScene::looking(0, 0, 0.6, 0.01 * n, 0.3);
    if (generator() % 10 == 0) T.translation().x() = 1e300;
    if (generator() % 10 == 0) T.linear()(1, 2) = std::numeric_limits<double>::quiet_NaN();
    stamp += generator() % 10 == 0 ? -1e9 : generator() % 10 == 0 ? 1e308 * 10 : 0.1;
    MappedFrame out;
    ASSERT_NO_THROW(out = mapper.process(stamp, image, T));
    EXPECT_EQ(out.reason.empty(), out.state == Mapping::kOk);
    if (!std::isfinite(stamp) || stamp < 0.0) stamp = 0.1 * n;
  }
}

TEST(DepthMapper, SameFramesSameBits) {
  NOT_UNDER_SANITIZERS("the release build compares bits");
  const DepthScene scene = furnished();
  DepthMapper a(kCamera, fine()), b(kCamera, fine());
  for (int k = 0; k < 3; ++k) {
    const DepthFrame frame = walk(scene, k);
    const MappedFrame x = a.process(frame.stamp, frame.image, frame.T_WC);
    const MappedFrame y = b.process(frame.stamp, frame.image, frame.T_WC);
    EXPECT_EQ(x.ground.height, y.ground.height);
    EXPECT_EQ(x.ground.normal, y.ground.normal);
  }
  EXPECT_EQ(a.map().voxels()->data(), b.map().voxels()->data());
}

TEST(DepthMapper, RefusesWrongOptions) {
  const auto refused = [](auto change) {
    DepthMapperOptions options;
    change(options);
    EXPECT_THROW(DepthMapper(kCamera, options), std::invalid_argument);
  };
  refused([](DepthMapperOptions& o) { o.map.resolution = 0.0; });
  refused([](DepthMapperOptions& o) { o.range = {2.0, 1.0}; });
  refused([](DepthMapperOptions& o) { o.tilt_tolerance = 0.0; });
  refused([](DepthMapperOptions& o) { o.ray_spacing = std::nan(""); });
  PinholeCamera camera = kCamera;
  camera.fx = -1.0;
  EXPECT_THROW(DepthMapper(camera, {}), std::invalid_argument);
}

}  // namespace
}  // namespace prospect::depth_mapper_test
