// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/maps/correction.h"
#include "engine/maps/planar_move.h"
#include "perception/graph/pose_graph.h"
#include "perception/mapping/anchored_map.h"
#include "perception/places/place_search.h"
#include "perception/places/submap_surface.h"

namespace prospect {

/// What odometry says of an anchor as seen from the one that it was measured from.
struct AnchorStep {
  PlanarMove way;
  /// Of its error (x, y, yaw), in the frame of the second one.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};
AnchorStep step_between(const MapAnchor& from, const MapAnchor& to);

/// Keeps a map straight: aligns anchors that see the same, and corrects the map by what follows for
/// all.
///
/// The anchors of an AnchoredMap are keyframes of a pose graph, joined by what odometry says of the
/// way from one to the next. An anchor that is closed is aligned (submap_alignment.h) with each
/// older one that has seen the same by the graph: those whose ways come within kReach of each
/// other. Each alignment enters the graph as a loop, which judges it (PoseGraph). Where anchors
/// then lie elsewhere by enough to be followed (AnchoredMap::is_worth()), the map follows; not
/// before what was closed meanwhile is aligned, as that takes far less than to follow. Anchors
/// that see the same, and so need not be told apart, are merged.
///
/// A robot that does not know where it is, carried or switched on anywhere in a map that was given,
/// draws a map apart (AnchoredMap::begin_apart()). Whenever an anchor of it is closed, all that it
/// holds is looked for in the map of the other anchors (PlaceSearch). Where there is one place
/// alone, and the walls of the newest anchor can be aligned there with older ones, all of that
/// joins the graph by this measurement, as by odometry, and the map follows. Else it goes on apart,
/// and seeking() says why.
///
/// A map that was given is a keyframe like all others, of which the part is aligned that lies
/// around the other one.
///
/// Thread-safety: one thread. Deterministic in the sequence of calls: it counts its work, and does
/// not look at a clock.
class MapLoops {
 public:
  static constexpr double kReach = 4.5;  ///< [m]
  static constexpr double kMostShared =
      0.8;  ///< overlap with a newer anchor at which one is merged

  /// aligns: false: the map follows what is told alone.
  explicit MapLoops(bool aligns = true) : aligns_(aligns) {}

  /// A piece of work, no longer than some milliseconds: an alignment, a few iterations of the
  /// graph, or some bricks of a map that follows. If the map has just followed: the correction, of
  /// kAnchors, and how places have moved.
  struct Followed {
    Correction correction;
    AnchoredMap::Moved moved;
    /// Of the error of (x, y, yaw) at the origin of anchor `sure_at`, from the start, in W.
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    int sure_at = 0;
  };
  std::optional<Followed> go_on(AnchoredMap& map, double stamp);

  /// The robot's place in what it has drawn was wrong: it is where `correction` (kRobot) moves it
  /// to. From here on it draws another anchor; the map follows. False while it follows another one.
  bool move_robot(AnchoredMap& map, const Pose& robot, const Eigen::Matrix3d& covariance,
                  const Correction& correction);

  /// The robot does not know where it is any more, and from here on draws a map apart.
  void lift(AnchoredMap& map, const Pose& robot, const Eigen::Matrix3d& covariance);
  /// Why it does not know where it is; empty: it does.
  const std::string& seeking() const { return seeking_; }

  /// Nothing comes any more, and nothing was seen from the open anchor: does all that is left, and
  /// puts the map where the first anchor stays as it was. MapAnchor::to_W leads there then. A map
  /// that is still apart stays.
  void finish(AnchoredMap& map, double stamp);

  /// An alignment, as it entered the graph.
  struct Loop {
    int older = 0, newer = 0;
    AnchorStep measured;  ///< the newer one as seen from the older one
    AnchorStep expected;  ///< what the graph knew of it before
    double overlap = 0.0, agreement = 0.0;
  };
  const std::vector<Loop>& loops() const { return loops_; }
  LoopState state(std::size_t loop) const { return graph_.loops()[loop]; }
  /// Loops that are used, and all of them.
  std::size_t used() const;
  std::size_t found() const { return loops_.size(); }
  /// Where W lies in the frame in which the first anchor stays.
  const PlanarMove& origin() const { return origin_; }

 private:
  bool is_apart(const AnchoredMap& map) const { return map.first() > 0 && !joins_; }
  void extend(const AnchoredMap& map);
  bool is_busy(const AnchoredMap& map) const;
  std::vector<PlanarMove> places(const AnchoredMap& map, const PlanarMove& origin) const;
  void begin(const AnchoredMap& map, int anchor);
  void align_next(const AnchoredMap& map);
  bool correct(AnchoredMap& map);
  void merge(AnchoredMap& map);
  PlanarMove place(int anchor) const;
  std::optional<Eigen::Matrix3d> sure(const AnchoredMap& map, int anchor) const;
  PlanarMove to_start(const AnchoredMap& map, int anchor) const;
  SubmapSurface surface_near(const AnchoredMap& map, int anchor, const PlanarMove& to_anchor,
                             const MapAnchor& other) const;
  void seek(AnchoredMap& map);
  void begin_search(const AnchoredMap& map);
  bool join(AnchoredMap& map, const PlanarMove& to_start);

  PoseGraph graph_;
  std::vector<SubmapSurface> surfaces_;  // of the closed anchors
  std::deque<int> closed_;               // to be aligned
  int anchor_ = -1;                      // that is being aligned; -1: none
  std::unique_ptr<NearestWall> walls_;   // of it
  std::deque<int> others_;
  bool optimise_ = false;
  int aligned_ = 0;          // anchors since the graph was solved
  std::vector<Loop> loops_;  // as graph_ has them
  std::size_t merged_ = 0;   // of them, how many have been looked at
  PlanarMove origin_, next_origin_;
  std::optional<Correction> told_;  // that is being followed
  bool aligns_ = true;
  std::string seeking_;
  PlaceRaster raster_;                   // of all anchors before those that are drawn apart
  int rastered_ = 0;                     // how many of them are in it
  std::unique_ptr<PlaceSearch> search_;  // null: none is under way
  int searched_ = 0;                     // the newest anchor that was closed when it began
  bool joins_ = false;                   // the next correction joins what was apart
  int sure_at_ = 0;                      // the open anchor as it was when the correction was found
  std::vector<Eigen::Matrix3d> sure_;    // of each anchor up to that, as seen from there
};

}  // namespace prospect
