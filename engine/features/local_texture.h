// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "engine/maps/ground_map.h"
#include "engine/maps/landmark_map.h"
#include "engine/support/resumable.h"

namespace prospect {

struct LocalTextureOptions {
  double block = 0.5;   ///< side of a block [m], rounded to whole cells
  double length = 1.0;  ///< of correlation [m]: texture this far away counts 1/e
  double prior =
      0.5;  ///< of wall [m]: what is assumed to have been seen everywhere, of mean texture
  /// Ground farther from `around` than this along either axis does not count [m].
  double reach = 30.0;
};

/// How rich in landmarks the surfaces about a place are, measured by those of the map around the
/// robot:
///
///   s(p) = min(1, (sum_b w_b n_b / m + a) / (sum_b w_b l_b + a)),   w_b = exp(-|p - p_b| / length)
///
/// over blocks b of known ground with l_b metres of wall (occupied cells next to free ones) and n_b
/// landmarks, m = sum n_b / sum l_b, a the prior. 1 where little is known and where texture is as
/// on average or better, and falling to a / (l + a) before walls that are mapped and bear nothing.
///
/// Texture goes on: past the end of what is seen of a white corridor, it is likely to be white.
/// Never above 1, since the density that it scales is a pessimistic one (LandmarkMap).
///
/// Immutable. Thread-safety: concurrent reads. Source: ours; shrinkage towards the mean as in
/// empirical Bayes estimates of a rate.
class LocalTexture {
 public:
  /// around: the robot, in W [m], finite. Throws std::invalid_argument on an option that is not >
  /// 0.
  LocalTexture(const GroundMap& ground, const LandmarkMap& landmarks, const Eigen::Vector2d& around,
               const LocalTextureOptions& options = {}, const PausePoint& pause = {});

  /// s(p), p in W [m].
  double relative(const Eigen::Vector2d& p) const;

 private:
  struct Seen {
    double wall = 0.0;       // l_b [m]
    double landmarks = 0.0;  // n_b / m [m]
  };
  Cell block_of(const Eigen::Vector2d& p) const { return blocks_.frame.cell(p.x(), p.y()); }

  LocalTextureOptions options_;
  Grid<Seen> blocks_;
};

}  // namespace prospect
