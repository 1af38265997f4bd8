// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "models/camera.h"
#include "models/image.h"
#include "perception/graph/pose_graph.h"
#include "perception/odometry/odometry.h"
#include "perception/places/stereo_view.h"
#include "perception/places/view_alignment.h"
#include "perception/places/view_index.h"

namespace prospect {

struct ViewLoopsOptions {
  StereoViewOptions view;
  ViewAlignmentOptions alignment;
  double spacing = 0.3;  ///< [m] from one view to the next
  double turn = 0.2;     ///< [rad] likewise
  /// The newest views, which the odometry itself joins, are no candidates.
  int newest = 10;
  int by_looks = 3, by_place = 3;  ///< candidates of a view
  int enough = 1;                  ///< loops of a view: others would say the same again
  int least_votes = 3;             ///< few: after a loss nobody knows what is nearby
  /// Of right to wrong loops among those that align_views() finds: the graph asks so much less.
  double odds = 3.0;
  /// Loops wait for others until one of them would move a view by this [m], [rad], or a third of
  /// all of them wait: to judge them takes as long for one as for many.
  double most_off = 0.15, most_turned_off = 0.02;
  double reach = 3.0, bend = 0.8;  ///< [m] and [rad] apart: seen from there, places look the same
};

/// Straightens the way of a stereo odometry by places whose looks are known again: the keyframes'
/// views become those of a pose graph, joined by the odometry; views that show the same enter it as
/// loops, which it judges.
///
/// Candidates of a view are the older ones that most corners vote for (ViewIndex), and those that
/// by the graph were taken nearby, looking the same way. Geometry decides (align_views()), and the
/// graph. Where a map began anew after a loss, by how much it is turned is not known: two loops
/// that agree join it to the one before. The odometry itself is not touched: what it gives is
/// corrected, its own window of landmarks is not.
///
/// Thread-safety: one thread. Deterministic: it counts its work, and does not look at a clock.
class ViewLoops {
 public:
  explicit ViewLoops(const StereoCamera& camera, const ViewLoopsOptions& options = {});

  /// A keyframe. since_last: covariance of (t, omega) in C of the motion since the keyframe before,
  /// whether it became a view or not. Throws as stereo_view().
  void keyframe(const Eigen::Isometry3d& T_WC, const Eigen::Matrix<double, 6, 6>& since_last,
                const ImageView& left, const ImageView& right);
  /// A frame that is one and is not lost. After a loss that began a new map since_last is all that
  /// the pose claims, which has grown meanwhile.
  void keyframe(const OdometryFrame& frame, const ImageView& left, const ImageView& right);
  /// Where the odometry's pose is by all loops so far.
  Eigen::Isometry3d corrected(const Eigen::Isometry3d& T_WC) const;

  /// A loop that was found.
  struct Loop {
    int older = 0, newer = 0;  ///< views
    ViewAlignment alignment;
    bool by_looks = false;  ///< votes proposed it; else where it was taken
  };
  const std::vector<Loop>& loops() const { return loops_; }
  LoopState state(std::size_t loop) const { return graph_.loops()[loop]; }
  std::size_t used() const;
  /// Judges and enters those that wait. Until then poses are without them.
  void settle();

  int views() const { return static_cast<int>(views_.size()); }
  /// Where the odometry had it, and where it is by all loops.
  const Eigen::Isometry3d& measured(int view) const;
  Eigen::Isometry3d pose(int view) const;

 private:
  struct Kept {
    StereoView view;
    Eigen::Isometry3d T_WC;
  };
  struct Candidate {
    int view = 0;
    bool by_looks = false;
  };
  bool is_worth_solving() const;
  std::vector<Candidate> candidates(const StereoView& view) const;

  StereoCamera camera_;
  ViewLoopsOptions options_;
  std::vector<Kept> views_;
  ViewIndex index_;
  PoseGraph graph_;
  std::vector<Loop> loops_;
  /// Of the motion since the newest view, up to the newest keyframe.
  Eigen::Matrix<double, 6, 6> since_view_ = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Isometry3d T_WK_ = Eigen::Isometry3d::Identity();  // of the newest keyframe
  int waiting_ = 0;  // the newest loops, which the graph has not judged
  ViewPrior prior_;  // of the newest frame
};

}  // namespace prospect
