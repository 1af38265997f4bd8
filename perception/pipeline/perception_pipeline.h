// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>
#include <vector>

#include "engine/maps/belief.h"
#include "engine/maps/correction.h"
#include "models/camera.h"
#include "models/imu_sample.h"
#include "models/types.h"
#include "perception/fusion/inertial_witness.h"
#include "perception/fusion/visual_motion.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/mapping/mover_tracker.h"
#include "perception/mapping/scan_mapper.h"
#include "perception/odometry/motion_noise.h"
#include "perception/odometry/stereo_odometry.h"
#include "perception/pipeline/belief_builder.h"
#include "perception/pipeline/feature_density.h"
#include "perception/pipeline/input_log.h"
#include "perception/pipeline/landmark_memory.h"
#include "perception/pipeline/perception_options.h"
#include "perception/pipeline/pose_history.h"
#include "perception/pipeline/straight_map.h"

namespace prospect {

/// What a belief's maps are made of.
enum class MapState {
  kMapped,   ///< a depth image or a scan has been entered
  kNoneYet,  ///< there is a depth camera or a lidar, but nothing has been entered so far
  kNoSource  ///< nothing measures depth: points of a stereo pair are too sparse to map from
};
/// A sentence for a person.
std::string_view to_string(MapState state);

/// A stereo pair as it comes from its cameras; the images are read during the call alone.
struct StampedPair {
  double left_stamp = 0.0, right_stamp = 0.0;  ///< [s]
  ImageView left, right;                       ///< rectified
};

/// How poses from outside have jumped so far: what no motion of the robot explains.
struct PoseJumps {
  int count = 0;
  double distance = 0.0, turn = 0.0;  ///< of all of them together [m], [rad]
};

/// A pose that something else measured: SLAM, motion capture, a recording's transforms.
struct ExternalPose {
  double stamp = 0.0;  ///< [s]
  /// In the map's frame, which is W until it is corrected.
  Eigen::Isometry3d T_WB = Eigen::Isometry3d::Identity();
  /// Of (x, y, z, yaw), as Belief's; zero: exact.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  Localization state = Localization::kOk;
  PoseJumps jumps{};  ///< up to this pose, of whoever judges them (runtime/pose_jump.h)
  /// B where odometry alone has it, in a frame of its own, at the same stamp; none: nobody says.
  std::optional<Eigen::Isometry3d> T_OB{};
  /// Likewise of jumps that the odometry did not make: the map was corrected, not the robot moved.
  int corrections = 0;
};

/// A robot's perception: stamped stereo pairs, wheel motion, depth images and scans in, the belief
/// that the planner takes out. It owns the odometry, its fusion with wheels, the mapping, the
/// memory of landmarks, and what holds one sensor against the other. Without an odometry poses come
/// from outside, instead of pairs and wheels, and the belief's localization is external; or with
/// wheels, which localize alone: dead reckoning, whose covariance grows with the way (WheelFusion),
/// ok as long as they are heard.
///
/// Poses from outside. With the covariance P of a pose, a point a metre ahead is off by
///   sigma = sqrt(largest eigenvalue of P in (x, y) + (1 m)^2 P_yaw);
/// above pose_degraded it is degraded, above pose_lost, or where P is no covariance, it is lost. A
/// pose that has jumped begins anew: scans between it and the one before have no pose, and what the
/// map drew before may be off by the jump, so the belief's covariance grows by the square of all
/// jumps so far (surface_drift.h).
///
/// Corrections (correction.h). correct() moves the map's frame against W, in which nothing changes.
/// So does a pose from outside that jumps while its odometry does not (ExternalPose::corrections):
/// with T_MB as told, and the poses before, the robot goes on in W as the odometry did,
///   T_WB <- T_WB(before) T_OB(before)^-1 T_OB,    T_MW <- T_MB T_WB^-1.
/// A pose whose correction is refused is refused, until one can be taken. With options.loops the
/// map is made of anchors, and follows what is seen again (straight_map.h): of kAnchors; kRobot,
/// too.
///
/// Frames. W: z up, the floor is z = 0. B: the body, in the plane or free in space
/// (start_in_space). C: the left camera, at stereo_mount. The odometry begins at T_WB(start) T_BC.
/// A belief's pose is always planar: position and yaw. What a free body tilts besides is in
/// pose_in_space(), and enters the map; its covariance holds to first order in the tilt.
///
/// Order. All stamps are seconds of one clock that only goes on. Sources may come in any order
/// among each other; that of the calls does not matter as long as inputs come within max_age:
///   pairs    the stamp of a pair is the left image's. The two must be of same_time;
///   poses    from outside, likewise;
///   wheels   may come before or after the pair of their time (WheelFusion). A pair knows where to
///            look from wheel motion that came before it;
///   imu      before or after: a pair is held against the samples that came before it;
///   depth    and scans are entered from the pose at their own stamp: between two pairs or poses
///            by interpolation, with wheels from their motion; ahead of all poses they wait for
///            one (max_ahead). Before anything was measured the robot stands at the start.
/// Each source by itself must go on: an input that is not newer than the one before is left out, as
/// is one that is late (max_age), not finite, or ahead of all others by more than max_leap. The
/// result of the call says so, and input() keeps count. Nothing is left out in silence. What has
/// stopped shows in the stamps of the belief, whose age a guard limits (SourceStamps, guard.h).
///
/// Maps. A depth image enters through DepthMapper, a scan through ScanMapper, one for each sensor,
/// all into one map, each ray from where its sensor is. What is held against the stereo pair is the
/// first depth camera.
/// Where the pose of its time is degraded or lost neither does, as what a wrong pose enters is not
/// taken out again. What the odometry found to move is no obstacle in the map: rays of depth images
/// clear up to it (moving_surface.h). So do rays that meet what has come since (mover_tracker.h);
/// that is Belief::movers. Without either nothing is mapped: map_state() says so, and the belief's
/// maps hold what map() was given.
///
/// Sensors against each other. Depths of the stereo pair are compared with those of the depth
/// camera where both look at the same time (depth_agreement.h), lengths by vision with those by
/// wheels (WheelFusion). While they disagree localization is lost, and complaint() says why.
///
/// An IMU tells the odometry where the body has turned to, and is held against each pair
/// (inertial_witness.h): a pose that it contradicts is degraded, with a covariance for both.
///
/// Noise. How the odometry's motions err is measured on the way (MotionNoise) and stands in the
/// belief's landmarks, for the planner to count on.
///
/// No map is copied for a belief: OccupancyMapper shares its snapshots, so hold on to as few
/// beliefs as are needed. Landmarks are made anew for each belief.
///
/// Thread-safety: one thread at a time; beliefs never change and may be read anywhere. Errors: the
/// constructor throws std::invalid_argument on options out of range or without an odometry; all
/// else never throws for any input. Deterministic: the same calls give the same bits, if the
/// odometry does. Source: ours.
class PerceptionPipeline {
 public:
  /// With a StereoOdometry of the rectified `camera`.
  PerceptionPipeline(const StereoCamera& camera, const PerceptionOptions& options);
  /// With another odometry, which begins at start_pose(options); options.odometry is not used.
  PerceptionPipeline(std::unique_ptr<Odometry> odometry, const StereoCamera& camera,
                     const PerceptionOptions& options);
  /// Without an odometry: poses come from outside, or, with wheels, from them.
  explicit PerceptionPipeline(const PerceptionOptions& options);
  /// T_WC of the left camera at the start.
  static Eigen::Isometry3d start_pose(const PerceptionOptions& options);

  InputResult stereo(const StampedPair& pair);
  InputResult wheels(const WheelSample& sample);
  /// Refused, too, while it is not believed. Without an odometry it says nothing.
  InputResult imu(const ImuSample& sample);
  /// Refused where an odometry or wheels give the poses.
  InputResult external_pose(const ExternalPose& pose);
  /// Of the map's frame; a refusal says why.
  InputResult correct(const Correction& correction);
  /// sensor: which of the robot's depth sensors; each is a source of its own.
  InputResult depth(double stamp, DepthImage image, int sensor = 0);
  /// in_B: as DepthScan, with origin and points in B [m].
  InputResult scan(double stamp, DepthScan in_B, int sensor = 0);

  /// What is known at `stamp` [s], or at the newest measurement if that is later; with wheels the
  /// robot is taken to go on up to then. Never null. Of landmarks the survival is that to the next
  /// image: those that are lost later on are detected again.
  std::shared_ptr<const Belief> belief(double stamp);
  /// Likewise at the newest measurement.
  std::shared_ptr<const Belief> belief();

  /// The pose of belief(stamp).
  Pose pose(double stamp) const { return body(stamp).pose; }
  /// T_WB at the same time, in space; of a body in the plane, that of pose().
  Eigen::Isometry3d pose_in_space(double stamp) const { return body(stamp).T_WB; }
  /// Of the newest pair. Lost without one, or while depths disagree.
  const OdometryFrame& frame() const { return frame_; }
  const Odometry& odometry() const { return *odometry_; }  ///< requires one
  /// Of the newest pair; without an odometry none.
  std::vector<LandmarkSighting> sightings() const {
    return odometry_ ? odometry_->sightings() : std::vector<LandmarkSighting>();
  }
  /// What became of the newest depth image or scan that was entered or rejected, at the pose of its
  /// camera or lidar; none so far: rejected.
  const MappedFrame& mapped() const { return mapped_; }
  /// What the IMU has told so far: its gyro's bias, which way is up, why it is not believed.
  const InertialWitness& inertial() const { return inertial_; }
  MapState map_state() const;
  /// Why the sensors cannot be trusted; empty: nothing is known against them.
  std::string complaint() const;
  /// What became of all inputs of a source.
  const InputCount& input(InputSource source) const { return log_.count(source); }

  /// Null: the map is as it was drawn.
  const StraightMap* straight_map() const { return straight_.get(); }

  /// What map() holds so far is a map that was made before. Is it known where in it the robot is?
  /// Else it looks for its place, and maps apart until it has found it (StraightMap::give()); false
  /// where it cannot.
  bool give_map(bool place_known);
  /// The robot was carried, and does not know where it is any more: likewise.
  bool lift();

  /// Nothing comes any more: see StraightMap::finish().
  void finish();

  /// To begin with a map that was made before, or with the robot's place known to be free.
  OccupancyMapper& map() { return *map_; }

 private:
  struct Waiting {
    double stamp = 0.0;
    std::shared_ptr<const DepthImage> depth;  // null: a scan
    DepthScan scan;
    int sensor = 0;
  };
  PerceptionPipeline(std::unique_ptr<Odometry> odometry, const std::optional<StereoCamera>& camera,
                     const PerceptionOptions& options);
  static InputSource source_of(const Waiting& input);
  /// Moves the map's frame so that the robot goes on as its odometry did; why not, or empty.
  std::string take_correction(const ExternalPose& pose);
  InputResult take(Waiting input);
  InputResult enter(const Waiting& input);
  MappedFrame enter_depth(const Waiting& input, const BodyPose& body);
  MappedFrame enter_scan(const Waiting& input, const BodyPose& body);
  void enter_waiting();
  /// With the covariance of the newest pose.
  StraightMap::Robot robot(const Pose& pose) const;
  /// After something was entered from there.
  void keep_straight(double stamp, const Pose& pose);
  bool ahead(double stamp) const;
  /// Stamp of the newest pose; none: the robot stands at the start.
  std::optional<double> known_until() const;
  /// B by the newest measurement; with wheels, where it is at `stamp` if it goes on as it does.
  BodyPose body(double stamp) const;
  /// B at `stamp`, as it is believed to have been; none: not known any more.
  std::optional<BodyPose> body_at(double stamp) const;
  /// The motion of C to a pair at `stamp` that wheels measured, with the turn by an IMU. What an
  /// IMU alone tells goes to the odometry.
  std::optional<Eigen::Isometry3d> where_to_look(double stamp,
                                                 const std::optional<Eigen::Isometry3d>& by_wheels);
  /// Holds the newest pair, which was measured, against the IMU.
  void hold_against_imu(const std::optional<Eigen::Isometry3d>& by_wheels);
  /// Holds the newest pair against the newest depth image, if they are of one time.
  void compare();
  /// B by wheels alone.
  BodyPose by_wheels(const FusedOdometry& fused) const;
  /// Empty, or that they disagree.
  std::string disagreement() const;
  void count_landmarks();

  PerceptionOptions options_;
  std::optional<StereoCamera> camera_;
  std::unique_ptr<Odometry> odometry_;  // null: poses come from outside
  MotionNoise motion_noise_;
  VisualMotionReader reader_;
  WheelFusion fusion_;
  InertialWitness inertial_;
  InertialWitness::Twist6 imu_doubt_at_keyframe_ = InertialWitness::Twist6::Zero();
  std::shared_ptr<OccupancyMapper> map_;
  std::shared_ptr<MoverTracker> movers_;
  std::unique_ptr<StraightMap> straight_;   // null: the map is as it was drawn
  bool lost_since_entry_ = false;           // in the map
  std::map<int, DepthMapper> mappers_;      // of each depth camera
  std::map<int, ScanMapper> scan_mappers_;  // of each sensor that has sent a scan
  BeliefBuilder builder_;
  LandmarkMemory memory_;
  FeatureDensity density_;
  std::unordered_set<std::uint64_t> places_;  // cells that have held a landmark

  InputLog log_;
  PoseHistory history_;                   // at the pairs, or the poses from outside
  std::optional<ExternalPose> external_;  // the newest, in W
  int corrections_followed_ = 0;          // ExternalPose::corrections
  Corrections corrections_;
  double newest_wheels_ = 0.0;
  OdometryFrame frame_;
  bool begun_ = false;                          // a frame was measured
  std::shared_ptr<const MotionInView> motion_;  // at the newest pair, in W; null: nothing moves
  Pose pose_at_fix_;                            // when the odometry last took a pose
  std::shared_ptr<const DepthImage> depth_;     // the newest
  ScaleAgreement agreement_;     // of the newest pair and depth image that say something
  std::deque<Waiting> waiting_;  // by stamp
  MappedFrame mapped_;
  std::optional<double> map_stamp_;  // of the newest input that the map took in or held back
};

}  // namespace prospect
