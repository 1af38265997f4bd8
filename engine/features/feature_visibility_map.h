// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "engine/features/local_texture.h"
#include "engine/features/visibility_prediction.h"
#include "engine/maps/belief.h"
#include "engine/maps/grid.h"
#include "engine/support/worker_threads.h"
#include "models/robot_description.h"

namespace prospect {

struct FeatureVisibilityMapOptions {
  double block = 0.5;          ///< side of a block of cells that share their counts [m]
  int blocks_per_update = 20;  ///< at most so many are counted in one update
  int max_landmarks = 600;     ///< that stand for those in reach; a quarter for unseen ones
  /// Unknown ground farther from the robot bears no features, and blocks farther along either axis
  /// keep their counts till it comes near [m].
  double prior_range = 20.0;
  double attenuation = 0.3;  ///< lambda of rays through unknown space [1/m]
};

/// How many features the robot would see from any known place in any direction:
///
///   N(c, yaw) = sum_i mu_i pi_i(p_c, yaw) P_unoccluded,i(p_c)
///
/// over the landmarks within reach of blocks near the robot and those expected in unknown ground
/// (unseen_features.h); pi_i as in VisibilityPrediction with an exact pose, P_unoccluded by a voxel
/// ray: 0 if it is blocked, else exp(-lambda length in unknown space). By blocks, at the free cell
/// next to a block's middle, and for kHeadings headings, linear between them. What the cost-to-go
/// asks of places beyond the horizon: the problem's own prediction is exact there, and too dear for
/// a whole map.
///
/// An update counts the blocks first that have no counts, then those counted longest ago, the near
/// ones more often, so that its price does not grow with the map.
///
/// A value. Thread-safety: none while updating. Deterministic. Source: formulation, section 6
/// ("localization weighting"); blocks and turns are ours.
class FeatureVisibilityMap {
 public:
  static constexpr int kHeadings = 8;

  /// Throws std::invalid_argument naming the option, its value and what was expected.
  FeatureVisibilityMap(const FeatureVisibilityMapOptions& options, const RobotDescription& robot,
                       const VisibilityParameters& visibility);

  /// belief: after a change of its map, blocks keep their counts till it is their turn. density:
  /// rho of unknown ground [1/m^2], 0: none. texture: of that map, which scales rho; null: not
  /// scaled. workers: share the blocks, the same bits for any number of them; null: the caller
  /// counts all.
  void update(const Belief& belief, double density, const LocalTexture* texture = nullptr,
              WorkerThreads* workers = nullptr, const PausePoint& pause = {});

  /// N at a cell for a heading [rad]; +infinity where nothing was counted yet.
  double count(Cell c, double yaw) const;

 private:
  struct Block {
    Cell middle;                // where it is counted
    std::int64_t counted = -1;  // update of the last count, -1: none
    std::array<float, kHeadings> counts{};
  };

  FeatureVisibilityMapOptions options_;
  StereoCamera camera_;
  CameraMount mount_;
  VisibilityParameters visibility_;
  std::int64_t updates_ = 0;
  int side_ = 1;  // of a block, in cells
  Grid<Block> blocks_;
};

}  // namespace prospect
