// SPDX-License-Identifier: Apache-2.0
#include "engine/features/landmarks_per_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "engine/features/visibility_prediction.h"
#include "models/camera.h"
#include "tests/engine/visibility_scene.h"
#include "tests/not_under_sanitizers.h"

namespace prospect::landmarks_per_cell_test {
namespace {

using visibility_scene::uniform;

constexpr double kCell = 32.0 / 450.0;

Landmark on_wall(double x, double y, double z, double nx = -1.0) {
  Landmark l;
  l.position = {x, y, z};
  l.covariance = Eigen::Matrix3d::Identity() * 1e-8;
  l.creation_direction = {nx, 0.0, 0.0};
  l.survival = 1.0;
  return l;
}

/// A wall across the x axis at 0, `density` points a square metre, at random.
LandmarkMap wall(std::mt19937_64& rng, double density, double half = 8.0) {
  LandmarkMap map;
  map.image_cell = kCell;
  const int count = static_cast<int>(std::lround(density * 4.0 * half * half));
  for (int i = 0; i < count; ++i) {
    map.landmarks.push_back(on_wall(0.0, uniform(rng, -half, half), uniform(rng, -half, half)));
  }
  return map;
}

// c_i by its definition, every pair asked.
double reference(const LandmarkMap& map, std::size_t i) {
  const Landmark& a = map.landmarks[i];
  double others = (a.multiplicity - 1.0) * a.survival;
  for (std::size_t j = 0; j < map.landmarks.size(); ++j) {
    const Landmark& b = map.landmarks[j];
    if (j != i && (b.position - a.position).norm() < 0.5 &&
        a.creation_direction.dot(b.creation_direction) > 0.0) {
      others += b.multiplicity * b.survival;
    }
  }
  return map.image_cell * map.image_cell * others / (M_PI * 0.25);
}

TEST(Crowding, IsTheDensityOfOthersOnTheSameSide) {
  std::mt19937_64 rng(1);
  LandmarkMap map;
  map.image_cell = kCell;
  map.landmarks = visibility_scene::landmarks(rng, 400);
  for (Landmark& l : map.landmarks) l.multiplicity = 1.0 + std::floor(uniform(rng, 0.0, 3.0));
  note_landmarks_per_cell(map);
  double least = 1e9, most = 0.0;
  for (std::size_t i = 0; i < map.landmarks.size(); ++i) {
    const double c = map.landmarks[i].per_cell;
    EXPECT_NEAR(c, reference(map, i), 1e-12);
    least = std::min(least, c);
    most = std::max(most, c);
  }
  EXPECT_LT(least, most / 10.0);
  std::vector<double> before;
  for (const Landmark& l : map.landmarks) before.push_back(l.per_cell);
  std::reverse(map.landmarks.begin(), map.landmarks.end());
  note_landmarks_per_cell(map);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_NEAR(map.landmarks[before.size() - 1 - i].per_cell, before[i], 1e-12);
  }

  LandmarkMap sides;
  sides.image_cell = kCell;
  sides.landmarks = {on_wall(0, 0, 0), on_wall(0.1, 0, 0, 1.0)};
  note_landmarks_per_cell(sides);
  EXPECT_EQ(sides.landmarks[0].per_cell, 0.0) << "the other side of a wall does not crowd it";
}

TEST(Crowding, WithoutImageCellsThereIsNone) {
  std::mt19937_64 rng(2);
  LandmarkMap map = wall(rng, 20.0, 1.0);
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                            std::numeric_limits<double>::infinity()}) {
    map.image_cell = none;
    map.landmarks.front().per_cell = 3.0;
    note_landmarks_per_cell(map);
    for (const Landmark& l : map.landmarks) EXPECT_EQ(l.per_cell, 0.0);
  }
}

TEST(Crowding, WhatIsNotFiniteCountsForNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::mt19937_64 rng(3);
  LandmarkMap clean = wall(rng, 20.0, 1.0);
  LandmarkMap map = clean;
  for (int i = 0; i < 12; ++i) {
    Landmark bad = on_wall(0, 0, 0);
    (i < 3 ? bad.position[i] : i < 6 ? bad.creation_direction[i - 3] : bad.survival) = nan;
    if (i > 6) bad.survival = 1.0, bad.multiplicity = nan;
    if (i > 8) bad.multiplicity = 1.0, bad.position.x() = i > 10 ? 1e300 : -1e300;
    map.landmarks.insert(map.landmarks.begin() + 5 * i, bad);
  }
  // Infinite ones would crowd their neighbours out.
  for (const bool many : {true, false}) {
    Landmark bad = on_wall(0, 0, 0);
    (many ? bad.multiplicity : bad.survival) = std::numeric_limits<double>::infinity();
    map.landmarks.push_back(bad);
  }
  note_landmarks_per_cell(clean);
  note_landmarks_per_cell(map);
  std::vector<double> expected, found;
  for (const Landmark& l : clean.landmarks) expected.push_back(l.per_cell);
  for (const Landmark& l : map.landmarks) {
    ASSERT_TRUE(std::isfinite(l.per_cell));
    if (l.position.allFinite() && l.position.norm() < 1e3 && l.creation_direction.allFinite() &&
        std::isfinite(l.survival) && std::isfinite(l.multiplicity)) {
      found.push_back(l.per_cell);
    }
  }
  EXPECT_EQ(found, expected);
}

// The reference that says what it is for: a tracker that keeps one landmark in each image cell
// looks at a textured wall from near and from far, and its landmarks are counted one by one.
TEST(Crowding, CountsWhatATrackerWithImageCellsKeeps) {
  NOT_UNDER_SANITIZERS("over many points, where other tests go the same ways at few");
  const StereoCamera camera;
  VisibilityParameters p = with_redetected_landmarks();
  p.border_px = p.border_sigma_px = 0.0;
  p.r_max = 12.0;
  const double cell = kCell * camera.left.fx;
  double worst = 0.0, crowded = 0.0;
  for (const double density : {1.0, 5.0, 20.0, 60.0}) {
    for (const double depth : {1.0, 2.0, 4.0, 6.0}) {
      double kept = 0.0, predicted = 0.0, all = 0.0;
      for (int sample = 0; sample < 3; ++sample) {
        std::mt19937_64 rng(static_cast<std::uint64_t>(100 * density + depth + 7 * sample));
        LandmarkMap map = wall(rng, density);
        std::set<std::pair<int, int>> cells;
        const CameraMount mount;
        const Pose pose{{-depth - mount.T_BC.translation().x(), 0.0, 0.0}, 0.0};
        Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
        T_WB.translation() = pose.position;
        const Eigen::Isometry3d T_CW = (T_WB * mount.T_BC).inverse();
        for (const Landmark& l : map.landmarks) {
          const Eigen::Vector3d Y = T_CW * l.position;
          const Eigen::Vector2d image = camera.left.project(Y);
          const double right = image.x() - camera.left.fx * camera.baseline / Y.z();
          if (right < 0.0 || image.x() > camera.left.width || image.y() < 0.0 ||
              image.y() > camera.left.height) {
            continue;
          }
          cells.insert({static_cast<int>(std::floor(image.x() / cell)),
                        static_cast<int>(std::floor(image.y() / cell))});
          all += 1.0;
        }
        kept += static_cast<double>(cells.size());
        note_landmarks_per_cell(map);
        const VisibilityPrediction prediction(map.landmarks, camera, mount, nullptr, p);
        predicted += prediction.probabilities(pose).sum();
      }
      std::printf("%2.0f / m^2 from %.0f m: %6.1f in view, %6.1f kept, %6.1f predicted\n", density,
                  depth, all / 3.0, kept / 3.0, predicted / 3.0);
      // Points come by chance, and where the wall ends there are fewer neighbours.
      EXPECT_NEAR(predicted, kept, 0.08 * kept + 3.0 * std::sqrt(kept));
      worst = std::max(worst, std::abs(predicted / kept - 1.0));
      crowded = std::max(crowded, all / kept);
    }
  }
  EXPECT_GT(crowded, 5.0) << "nothing was crowded";
  EXPECT_LT(worst, 0.25);
}

}  // namespace
}  // namespace prospect::landmarks_per_cell_test
