// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/maps/localization.h"
#include "models/camera.h"
#include "perception/mapping/depth_image.h"
#include "perception/mapping/ground_plane.h"
#include "perception/mapping/met_twice.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/occupancy_mapper.h"
#include "perception/mapping/pose_check.h"
#include "perception/mapping/repeated_content.h"
#include "perception/odometry/motion_in_view.h"

namespace prospect {

class Knobs;

struct DepthMapperOptions {
  OccupancyMapperOptions map;
  DepthRange range;  ///< of depths that are believed [m]
  /// A depth may be altogether wrong, as of a stereo pair that matches what does not belong
  /// together; else its noise is all.
  bool mismatches = false;
  GroundPlaneOptions ground;  ///< its noise is also that by which floor is told from obstacles
  /// How far the ground may be from where the pose says it is.
  double tilt_tolerance = 0.1;     ///< [rad]
  double height_tolerance = 0.12;  ///< [m]
  /// What the pose's tilt [rad] and height [m] are worth, one standard deviation, and what a ground
  /// plane is worth at best (a sensor's distortion). Zero: the pose is exact.
  double pose_sigma_tilt = 0.0;
  double pose_sigma_height = 0.0;
  double plane_sigma_tilt = 0.01;
  double plane_sigma_height = 0.01;
  /// A point is of the floor within max(floor_margin, gate sigma) of it, but at most most_margin:
  /// below the slice that becomes obstacles [m].
  double floor_margin = 0.03;
  double most_margin = 0.08;
  /// Rays are taken so densely that neighbours are at most this share of a voxel apart at the map's
  /// range.
  double ray_spacing = 0.5;
  /// A pixel between two neighbours that are nearer and farther than it by this share of its depth
  /// lies on no surface, but on the edge between two. A neighbour without a depth may be either.
  double edge = 0.04;
  /// When an image is not trusted.
  double least_valid = 0.02;      ///< share of pixels with a depth; fewer: rejected
  double little_valid = 0.2;      ///< fewer: degraded
  double most_rough = 0.5;        ///< share of neighbours that differ by more than a tenth: noise
  double most_below_floor = 0.3;  ///< share of points far below where the floor should be
  double max_speed = 3.0;         ///< [m/s]
  double max_turn_rate = 6.0;     ///< [rad/s]
  double max_gap = 2.6;           ///< of the usual time between frames; above: degraded
};

/// The knobs (models/knobs.h); range and map come from robot and map.
void describe(Knobs& knobs, DepthMapperOptions& options);

enum class Mapping { kOk = 0, kDegraded = 1, kRejected = 2 };
std::string_view to_string(Mapping state);

/// Processor times of one frame [ms]; the only numbers that differ between two runs.
struct DepthMapperTimes {
  double check = 0.0;   ///< of the image
  double ground = 0.0;  ///< ground plane
  double scan = 0.0;    ///< pixels to rays
  double insert = 0.0;  ///< rays into the map, ground map included
  double total() const { return check + ground + scan + insert; }
};

/// What became of one frame.
struct MappedFrame {
  double stamp = 0.0;  ///< [s]
  Mapping state = Mapping::kRejected;
  std::string reason;  ///< why it is not ok, several joined by "; "; empty if ok
  GroundPlane ground;
  /// The pose that the scan was entered with: as given, tilt and height corrected by the ground.
  Eigen::Isometry3d T_WC = Eigen::Isometry3d::Identity();
  double valid = 0.0;                   ///< share of the pixels
  int hits = 0, floor = 0, misses = 0;  ///< rays entered: at obstacles, at the floor, beyond range
  int below = 0;                        ///< ... that went on through the floor's plane
  int moving = 0;                       ///< rays that met what moves
  DepthMapperTimes times;
};

/// Maps depth images from known poses: image -> ground plane -> scan -> OccupancyMapper, which see.
/// W: z up, the floor is z = 0.
///
/// Pose. With the predicted plane (n_p, h_p) of the pose and the measured one (n_m, h_m), the pose
/// is turned about the camera's centre by k_t of the rotation that takes n_m to n_p, and raised by
/// k_h (h_m - h_p); k = sigma_pose^2 / (sigma_pose^2 + sigma_measured^2 + sigma_plane^2).
///
/// Scan. Every s-th pixel along rows and columns, s = ray_spacing r f / max_range, at least 1; with
/// the height e above the measured plane (without one: above z = 0) a point is
///   floor      |e| <= margin: entered as a hit just below z = 0, at its x and y. So it clears what
///              is above it, makes the layer below z = 0 occupied, and is never an obstacle;
///   an edge    between two surfaces: says nothing;
///   moving     of what moves against the world (moving_surface.h): clears up to it alone;
///   obstacle   e > margin: a hit, at z = 0 where the pose has it lower: what stands out of the
///              floor does not show that there is none. Beyond the map's range, a ray that clears
///              up to that range;
///   below      e < -margin: a hit, so the floor is missing where the ray went through its plane
///              (OccupancyMapper), if by the measured plane and by the pose it is deeper than the
///              robot's step and than five standard deviations of a point of the floor, which by
///              chance no ray is; where depths may be mismatches, once it was met from two places
///              (MetTwice). Else it says nothing.
/// A pixel without a valid depth says nothing: it neither clears nor occupies.
///
/// States. Ok. Degraded: the scan was entered, but no ground was found in it, or a half of the
/// image or nearly all of it has no depth, or frames are missing before it. Rejected: nothing was
/// entered; the image has a wrong size, has no depth, is the one before again although the camera
/// has moved (frozen, RepeatedContent), is everywhere the same, is noise; the time is no number or
/// does not increase; the pose is no rotation and translation, is not ok by the odometry (degraded,
/// lost), or is farther from the last accepted one than the robot can have moved; or too much lies
/// below the floor, so that pose, calibration or unit of the depth must be wrong.
///
/// Thread-safety: as OccupancyMapper. Errors: the constructor throws std::invalid_argument on wrong
/// cameras or options; process() never throws for any image, time or pose. Determinism: same
/// frames, same bits, but for `times`.
class DepthMapper {
 public:
  /// `map`: the map that is extended, one that other mappers extend, too; null: one of its own, by
  /// options.map. `movers`: what scans show of them is followed there; null: nobody moves.
  explicit DepthMapper(const PinholeCamera& camera, const DepthMapperOptions& options = {},
                       std::shared_ptr<OccupancyMapper> map = nullptr,
                       std::shared_ptr<MoverTracker> movers = nullptr);

  /// `pose`: what the odometry says of T_WC. `motion`: landmarks in W where they were at the time;
  /// null: nothing moves.
  MappedFrame process(double stamp, const DepthImage& image, const Eigen::Isometry3d& T_WC,
                      Localization pose = Localization::kOk, const MotionInView* motion = nullptr);

  OccupancyMapper& map() { return *map_; }
  int stride() const { return stride_; }  ///< s

 private:
  /// pose: of the camera; none: nobody knows it.
  bool check_image(const DepthImage& image, const std::optional<Eigen::Isometry3d>& pose,
                   MappedFrame& out);
  void correct(MappedFrame& frame) const;
  /// How far from the floor a point of it at depth z may seem [m].
  double floor_margin(const MappedFrame& frame, double z) const;
  /// Which pixels that become rays show what moves, in their order.
  std::vector<char> find_moving(const DepthImage& image, const MappedFrame& frame,
                                const MotionInView& motion) const;
  /// moving: as find_moving(), or empty.
  bool make_scan(const DepthImage& image, const std::vector<char>& moving, MappedFrame& frame,
                 DepthScan& scan);

  PinholeCamera camera_;
  DepthMapperOptions options_;
  std::shared_ptr<OccupancyMapper> map_;
  std::shared_ptr<MoverTracker> movers_;
  MetTwice below_;  // what was met below the floor
  int stride_ = 1;
  DepthImage last_image_;  // as received
  RepeatedContent repeated_;
  double last_stamp_ = 0.0;  // of the last frame with a sound time
  double period_ = 0.0;      // usual time between frames [s]
  bool any_stamp_ = false;
  PoseCheck poses_;
};

}  // namespace prospect
