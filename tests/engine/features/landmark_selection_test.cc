// SPDX-License-Identifier: Apache-2.0
#include "engine/features/landmark_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "engine/features/landmarks_per_cell.h"
#include "models/make_model.h"
#include "tests/engine/visibility_scene.h"

namespace prospect::landmark_selection_test {
namespace {

using visibility_scene::uniform;

std::vector<std::uint64_t> ids(const std::vector<Landmark>& landmarks) {
  std::vector<std::uint64_t> result;
  for (const Landmark& l : landmarks) result.push_back(l.id);
  return result;
}

TEST(LandmarkSelection, LeavesOutNothingThatCanBeSeen) {
  std::mt19937_64 rng(1);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 400);
  for (Landmark& l : map.landmarks) l.position.head<2>() *= 3.0;  // many are out of reach
  const CameraMount mount;
  const double reach = 1.5;
  const Pose pose{{0.3, -0.2, 0.0}, 0.4};
  const auto selected = select_landmarks(map, pose, reach + 0.45, 10000);
  EXPECT_LT(selected.size(), map.landmarks.size() - 50);
  std::set<std::uint64_t> kept;
  for (const Landmark& l : selected) kept.insert(l.id);
  const VisibilityPrediction all(map.landmarks, {}, mount, nullptr, {});
  double largest = 0.0;
  for (int trial = 0; trial < 3000; ++trial) {
    const double angle = uniform(rng, -3.2, 3.2), r = reach * std::sqrt(uniform(rng, 0.0, 1.0));
    const Pose there{pose.position + Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), 0.0),
                     uniform(rng, -3.2, 3.2)};
    const Eigen::VectorXd pi = all.probabilities(there);
    for (int i = 0; i < pi.size(); ++i) {
      if (!kept.count(map.landmarks[static_cast<std::size_t>(i)].id)) {
        largest = std::max(largest, pi[i]);
      }
    }
  }
  EXPECT_LT(largest, 0.02);  // four logistic widths beyond a limit: 0.018
}

TEST(LandmarkSelection, DoesNotDependOnTheOrderOfTheMap) {
  std::mt19937_64 rng(2);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 500);
  const auto first = ids(select_landmarks(map, Pose{}, 2.0, 100));
  EXPECT_LE(first.size(), 100u);
  EXPECT_GT(first.size(), 40u);
  for (int trial = 0; trial < 5; ++trial) {
    std::shuffle(map.landmarks.begin(), map.landmarks.end(), rng);
    EXPECT_EQ(ids(select_landmarks(map, Pose{}, 2.0, 100)), first);
  }
}

TEST(LandmarkSelection, EmptiesNoDirectionForAnother) {
  std::mt19937_64 rng(3);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 2000);
  // Ahead, a thousand excellent ones; behind, the ordinary ones.
  for (int i = 0; i < 1000; ++i) {
    Landmark& l = map.landmarks[static_cast<std::size_t>(i)];
    l.position.x() = std::abs(l.position.x());
    l.survival = 1.0;
  }
  const auto selected = select_landmarks(map, Pose{}, 2.0, 256);
  ASSERT_LE(selected.size(), 256u);
  int behind = 0;
  double previous = -4.0;
  for (const Landmark& l : selected) {
    behind += l.position.x() < 0.0;
    const double azimuth = std::atan2(l.position.y(), l.position.x());
    EXPECT_GE(azimuth, previous);
    previous = azimuth;
  }
  EXPECT_GT(behind, static_cast<int>(selected.size()) / 4);
}

// However few are chosen: the count that they predict is about that of all.
TEST(LandmarkSelection, ThoseChosenStandForAll) {
  std::mt19937_64 rng(4);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 3000);
  map.image_cell = 0.02;
  note_landmarks_per_cell(
      map);  // alike in a cell of the lattice, as all that depends on where they are
  const CameraMount mount;
  const VisibilityPrediction all(map.landmarks, {}, mount, nullptr, {});
  const auto model = make_model("unicycle");
  const TrajectoryBatch t = visibility_scene::walks(rng, *model, 4, 0.25, 40);
  const VisibilityPrediction some(select_landmarks(map, Pose{}, 2.0, 300), {}, mount, nullptr, {});
  std::vector<Landmark> unweighted = select_landmarks(map, Pose{}, 2.0, 300);
  for (Landmark& l : unweighted) l.multiplicity = 1.0;
  const VisibilityPrediction truncated(unweighted, {}, mount, nullptr, {});
  double of_all = 0.0, of_some = 0.0, of_truncated = 0.0, error = 0.0;
  for (int b = 0; b < 40; ++b) {
    const double want = all.visible(t, b)[2], have = some.visible(t, b)[2];
    of_all += want;
    of_some += have;
    of_truncated += truncated.visible(t, b)[2];
    error += std::abs(have - want);
  }
  EXPECT_NEAR(of_some / of_all, 1.0, 0.1);
  EXPECT_LT(error / of_all, 0.15);
  EXPECT_LT(of_truncated / of_all, 0.5) << "what is left without multiplicity";
}

// A step further the same ones are chosen, so that what was computed of them can be kept.
TEST(LandmarkSelection, StaysWhereTheRobotMoves) {
  std::mt19937_64 rng(6);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 3000);
  const auto before = ids(select_landmarks(map, Pose{}, 3.0, 200));
  const auto after = ids(select_landmarks(map, Pose{{0.02, 0.01, 0.0}, 0.3}, 3.0, 200));
  const std::set<std::uint64_t> first(before.begin(), before.end());
  const auto again =
      std::count_if(after.begin(), after.end(), [&](std::uint64_t id) { return first.count(id); });
  EXPECT_GT(again, 9 * static_cast<int>(after.size()) / 10);
}

// The two faces of a wall are not taken together.
TEST(LandmarkSelection, KeepsApartWhatIsSeenFromOtherSides) {
  LandmarkMap map;
  for (std::uint64_t i = 0; i < 8; ++i) {
    Landmark l;
    l.id = i;
    l.position = {2.01 + 0.001 * static_cast<double>(i), 0.05, 0.5};
    l.creation_direction = {i % 2 == 0 ? -1.0 : 1.0, 0.0, 0.0};
    l.survival = i % 4 < 2 ? 1.0 : 0.5;
    map.landmarks.push_back(l);
  }
  const auto selected =
      select_landmarks(map, Pose{}, 3.0, 2, with_redetected_landmarks(VisibilityParameters{}));
  ASSERT_EQ(selected.size(), 2u);
  for (const Landmark& l : selected) {
    EXPECT_EQ(l.multiplicity, 4.0);
    EXPECT_EQ(l.survival, 0.75);
  }
}

TEST(LandmarkSelection, NothingLeftOutStandsForItself) {
  std::mt19937_64 rng(5);
  LandmarkMap map;
  map.landmarks = visibility_scene::landmarks(rng, 200);
  for (Landmark& l : map.landmarks) l.multiplicity = 1.0;
  for (const Landmark& l : select_landmarks(map, Pose{}, 2.0, 1000)) {
    EXPECT_EQ(l.multiplicity, 1.0);
  }
}

TEST(LandmarkSelection, LeavesOutWhatIsNotUsable) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LandmarkMap map;
  Landmark good;
  good.position = {2.0, 0.0, 0.5};
  good.creation_direction = {-1.0, 0.0, 0.0};
  good.id = 7;
  for (int i = 0; i < 6; ++i) map.landmarks.push_back(good);
  map.landmarks[0].position.x() = nan;
  map.landmarks[1].covariance(0, 1) = nan;
  map.landmarks[2].survival = 0.0;
  map.landmarks[3].creation_range = -1.0;
  map.landmarks[4].creation_direction.setZero();
  EXPECT_EQ(ids(select_landmarks(map, Pose{}, 1.0, 10)), (std::vector<std::uint64_t>{7}));
  EXPECT_TRUE(select_landmarks(map, Pose{}, 1.0, 0).empty());
  EXPECT_TRUE(select_landmarks(LandmarkMap{}, Pose{}, 1.0, 10).empty());
}

}  // namespace
}  // namespace prospect::landmark_selection_test
