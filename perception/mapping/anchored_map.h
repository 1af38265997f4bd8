// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "engine/maps/place_moves.h"
#include "engine/maps/planar_move.h"
#include "models/types.h"
#include "perception/mapping/evidence_table.h"
#include "perception/mapping/map_evidence.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

/// A piece of the robot's way, with what was seen from it. A correction moves it as one.
struct MapAnchor {
  int id = 0;      ///< counted from 0
  int parent = 0;  ///< the one that `origin` was measured from; its own: of none
  Pose origin;     ///< of the robot where it begins, in W as it was then
  /// Where it should have been, as somebody has told: jump(origin).
  PlanarMove jump{};
  /// Of the error of (x, y, yaw) there, from the start, as told.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// How it was found from the parent, if not by odometry: its place as seen from there, and the
  /// covariance of the error of (x, y, yaw), in its own frame.
  struct Found {
    PlanarMove way;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  std::optional<Found> found{};
  bool given = false;  ///< a map that was made before, of any size; nothing was drawn from here
  std::vector<Eigen::Vector2d> way{};  ///< places of the robot, kWayStep apart, in W as it was then
  MapEvidence evidence{};              ///< in the lattice of W as it was then
  PlanarMove to_W{};                   ///< from there to W as it is
};

/// An occupancy map that can be corrected: what was entered belongs to anchors, and the map is the
/// sum over them. Without a correction it is the OccupancyMapper that it holds, to the bit.
///
/// W goes on with the robot without a jump, whatever is corrected: the robot stands where it stood,
/// and so do the walls that it sees, which belong to the open anchor. All others move. So a
/// correction is given by where each anchor lies relative to the open one.
///
/// A correction is followed aside: a second map is made from the anchors at their new places, a few
/// in each go_on(), while the first goes on as it was and takes in what is seen. When all are in
/// it, it takes the first one's place, whole: nobody ever sees half a correction, and what was free
/// before is not trusted any more from the same instant on. Of evidence that has moved by parts of
/// a voxel see MapEvidence::moved().
///
/// Apart. A robot that does not know where it is among its anchors draws a map apart: it begins
/// empty, and holds what was drawn since. When the place is found, the next correction that is
/// followed has all anchors in it again.
///
/// Merging. Anchors that see the same place can be made one: memory and the time to follow a
/// correction grow with the area that was seen, not with the time.
///
/// Thread-safety: as OccupancyMapper. Deterministic in the sequence of calls. Never throws but what
/// OccupancyMapper throws.
class AnchoredMap {
 public:
  static constexpr double kWayStep = 0.5;     ///< [m]
  static constexpr double kLeastMove = 0.01;  ///< [m] that is worth following
  static constexpr double kReach = 4.0;       ///< [m] around an anchor at which a turn counts

  /// `map`: nothing was entered yet. The first anchor is open from the beginning, at `start`.
  AnchoredMap(std::shared_ptr<OccupancyMapper> map, const Pose& start);
  ~AnchoredMap();
  AnchoredMap(const AnchoredMap&) = delete;
  AnchoredMap& operator=(const AnchoredMap&) = delete;

  OccupancyMapper& map() { return *map_; }
  double resolution() const { return map_->options().resolution; }
  /// The newest is open: what is entered in map() is written down there.
  const std::vector<MapAnchor>& anchors() const { return anchors_; }
  const MapAnchor& open() const { return anchors_.back(); }
  const EvidenceTable& table() const { return table_; }

  /// The robot is here [W].
  void note(const Pose& robot);
  /// Closes the open anchor and opens the next one. Without a parent: the one that is closed.
  void begin(const Pose& origin, const Eigen::Matrix3d& covariance,
             std::optional<int> parent = std::nullopt, const PlanarMove& jump = {});

  /// Likewise, and the map begins anew, apart. A correction that is being followed is given up, and
  /// so is what was drawn apart before.
  void begin_apart(const Pose& origin, const Eigen::Matrix3d& covariance);
  /// The first anchor that the map holds.
  int first() const { return first_; }
  /// What is entered so far was told: a map that was made before (MapAnchor::given). Only the first
  /// anchor may be one; the next one is to be begun then.
  void give() { anchors_.back().given = true; }
  /// Where an anchor was found (MapAnchor::found).
  void found(int anchor, int parent, const MapAnchor::Found& found);

  /// Whether anchors at such places, to_W of each but the open one, are far enough from where they
  /// are to be followed.
  bool is_worth(const std::vector<PlanarMove>& to_W) const;
  /// Begins to follow; false while one is under way. Those that are opened later stay where they
  /// are. The map that is drawn apart is joined to that of all anchors.
  bool follow(std::vector<PlanarMove> to_W);
  bool follows() const { return aside_ != nullptr; }
  /// How what was measured has moved in W.
  struct Moved {
    std::shared_ptr<const PlaceMoves> places;
    std::vector<PlanarMove> anchors;  ///< what was seen from each
  };
  /// Works on it, on about so many bricks of evidence (one anchor at least). When it is done the
  /// map is the new one, and how all has moved is returned.
  /// sure, of the first anchors, in W: covariance of (x, y, yaw) of what was seen from each as seen
  /// from the origin of the last of them, where the robot was; empty: not known.
  std::optional<Moved> go_on(int bricks, const std::vector<Eigen::Matrix3d>& sure = {});

  /// What anchor `from` has seen is counted to anchor `to`, another closed one, from now on; the
  /// map does not change until the next correction. False while a correction is followed.
  bool merge(int from, int to);
  /// Of what all anchors keep.
  std::size_t bytes() const;

 private:
  void record();

  std::shared_ptr<OccupancyMapper> map_;
  EvidenceTable table_;
  std::vector<MapAnchor> anchors_;
  std::unique_ptr<OccupancyMapper> aside_;  // null: no correction is followed
  std::vector<PlanarMove> goes_to_;         // to_W of each then
  std::size_t next_ = 0;                    // anchor to be entered
  int first_ = 0;                           // that the map holds
};

}  // namespace prospect
