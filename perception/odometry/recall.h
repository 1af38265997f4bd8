// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <deque>
#include <utility>
#include <vector>

#include "perception/odometry/image_pyramid.h"
#include "perception/odometry/track.h"

namespace prospect {

/// A good pose and what was known then, to come back to. One is kept wherever the view has changed
/// since the last, whether or not it was a keyframe: who comes back is to find one that looks
/// alike.
struct Recall {
  Eigen::Isometry3d T_CW = Eigen::Isometry3d::Identity();
  PyramidLevel coarse;  ///< the coarsest level of its left image
  std::vector<Track> tracks;
};

/// The newest of them.
class RecallMemory {
 public:
  explicit RecallMemory(int size = 5) : size_(size) {}

  void add(Recall recall) {
    recalls_.push_back(std::move(recall));
    while (static_cast<int>(recalls_.size()) > size_) recalls_.pop_front();
  }

  /// Median shift in the image [px], since the newest was added, of the tracks that were and are
  /// inliers; infinite if there are none.
  double shift(const std::vector<Track>& tracks) const;

  /// Oldest first.
  std::deque<Recall>& all() { return recalls_; }
  const std::deque<Recall>& all() const { return recalls_; }

 private:
  int size_;
  std::deque<Recall> recalls_;
};

}  // namespace prospect
