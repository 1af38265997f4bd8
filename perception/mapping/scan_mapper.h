// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "perception/mapping/depth_mapper.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/mapping/pose_check.h"
#include "perception/mapping/repeated_content.h"

namespace prospect {

class Knobs;

struct ScanMapperOptions {
  OccupancyMapperOptions map;
  /// A point is of the floor within it of z = 0 [m].
  double floor_margin = 0.03;
  /// Of several points in one cube of so many voxels the first counts: a cloud has many in each.
  double point_spacing = 0.5;
  double most_below_floor = 0.3;  ///< share of points far below the floor; more: rejected
  double max_speed = 3.0;         ///< [m/s]
  double max_turn_rate = 6.0;     ///< [rad/s]
};

/// The knobs (models/knobs.h); the map comes from robot and map.
void describe(Knobs& knobs, ScanMapperOptions& options);

/// Maps scans of a lidar, of one plane or of many, and clouds of points from known poses: scan ->
/// OccupancyMapper, which see. W: z up, the floor is z = 0. What DepthMapper is for depth images.
///
/// A point at height z in W is
///   floor      |z| <= floor_margin: entered as a hit just below z = 0, at its x and y;
///   obstacle   above: a hit; beyond the map's range, a ray that clears up to that range;
///   below      where it is deeper than the robot's step, a hit there: the floor is missing where
///   the
///              ray went through its plane; else it says nothing.
/// The floor is not measured: height and tilt of the lidar are those of its poses.
///
/// States. Ok. Rejected: nothing was entered; the scan has no ray, all its points are those of the
/// scan before although the lidar has moved (frozen, RepeatedContent); the time is no number or
/// does not increase; the pose cannot be (PoseCheck) or is not ok by the odometry; or too much lies
/// below the floor.
///
/// Thread-safety: as OccupancyMapper. Errors: the constructor throws std::invalid_argument on
/// options out of range; process() never throws for any scan, time or pose. Determinism: same
/// scans, same bits, but for `times`.
class ScanMapper {
 public:
  /// `map`, `movers`: as DepthMapper's.
  explicit ScanMapper(const ScanMapperOptions& options = {},
                      std::shared_ptr<OccupancyMapper> map = nullptr,
                      std::shared_ptr<MoverTracker> movers = nullptr);

  /// A scan in the lidar's frame S, its rays from S's origin (scan_S.origin is not looked at), and
  /// S's pose. No ground is found in it; MappedFrame::valid is 1.
  /// `pose`: what the odometry says of T_WS.
  MappedFrame process(double stamp, const DepthScan& scan_S, const Eigen::Isometry3d& T_WS,
                      Localization pose = Localization::kOk);

  OccupancyMapper& map() { return *map_; }

 private:
  bool make_scan(const DepthScan& scan_S, const Eigen::Isometry3d& T_WS, MappedFrame& frame,
                 DepthScan& scan) const;

  ScanMapperOptions options_;
  std::shared_ptr<OccupancyMapper> map_;
  std::shared_ptr<MoverTracker> movers_;
  PoseCheck poses_;
  std::vector<Eigen::Vector3d> last_hits_;  // as received
  RepeatedContent repeated_;
  double last_stamp_ = 0.0;
  bool any_stamp_ = false;
};

}  // namespace prospect
