// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/maps/correction.h"
#include "engine/maps/planar_move.h"
#include "models/types.h"
#include "perception/mapping/occupancy_mapper.h"

namespace prospect {

class AnchoredMap;
class MapLoops;

/// A map that is kept straight by what is seen again (anchored_map.h, map_loops.h), for whoever
/// enters scans in it at poses that drift.
///
/// An anchor is 2.5 m of the robot's way, a turn of a radian counted as 0.3 m. Of the pose's error
/// from the start, with P that of the odometry and S that of the anchor a at which the map was last
/// corrected, known from the graph,
///     P <- S carried to the robot + what the odometry has added since a (planar_error.h).
///
/// Thread-safety: one thread. Deterministic in the sequence of calls.
class StraightMap {
 public:
  /// Where the odometry has the robot in W, and the covariance of (x, y, yaw) from the start.
  struct Robot {
    Pose pose;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  };
  /// The map has just followed a correction.
  struct Followed {
    FollowedCorrection correction;
    std::vector<PlanarMove> anchors;  ///< how what was seen from each has moved in W
  };

  static bool is_built_in();  ///< with Ceres
  /// `map`: nothing was entered yet. aligns: see MapLoops. Throws std::invalid_argument where the
  /// library was built without Ceres.
  StraightMap(std::shared_ptr<OccupancyMapper> map, const Pose& start, bool aligns = true);
  ~StraightMap();
  StraightMap(const StraightMap&) = delete;
  StraightMap& operator=(const StraightMap&) = delete;

  /// From here on what is seen belongs to another anchor; parent: see AnchoredMap::begin().
  void begin_anchor(const Robot& robot, std::optional<int> parent = std::nullopt);
  /// The one that what is seen belongs to.
  int open_anchor() const;
  /// All that was entered so far is a map that was made before. Is it known where in it the robot
  /// is? Else it draws another one, apart, until it finds its place (MapLoops).
  void give(const Robot& robot, bool place_known);
  /// The robot does not know any more where it is, as it was carried: likewise.
  void lift(const Robot& robot);
  /// Why it does not know where it is; empty: it does.
  const std::string& seeking() const;
  /// After a scan was entered from there: a piece of work, of some milliseconds.
  std::optional<Followed> go_on(double stamp, const Robot& robot);
  /// Somebody corrects the robot's place in what it has drawn (kRobot); false while it follows.
  bool move_robot(const Robot& robot, const Correction& correction);

  /// Nothing comes any more, as a recording has ended: does all that is left, and puts the map
  /// where the first anchor stays as it was. moved() leads there then.
  void finish(double stamp);

  Eigen::Matrix3d covariance(const Robot& robot) const;
  /// Where W lies in the frame of the start.
  PlanarMove origin() const;
  /// Of what was seen from an anchor: from W as it was then to W as it is.
  PlanarMove moved(int anchor) const;
  /// Loops that are used, and all.
  int used() const;
  int found() const;
  const AnchoredMap& anchored() const;
  const MapLoops& loops() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// go_on(), and what comes of it is told to `corrections`.
std::optional<StraightMap::Followed> go_on(StraightMap& map, double stamp,
                                           const StraightMap::Robot& robot,
                                           Corrections& corrections);

/// Somebody corrects. One of the robot is followed by the map, if it is made of anchors and follows
/// no other one; all else is for `corrections` to take or refuse. map: null, if it is not.
Corrections::Answer correct(const Correction& correction, const StraightMap::Robot& robot,
                            Corrections& corrections, StraightMap* map);

}  // namespace prospect
