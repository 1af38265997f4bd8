#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include "engine/maps/belief.h"
#include "models/camera.h"
#include "models/types.h"
#include "perception/fusion/visual_motion.h"
#include "perception/fusion/wheel_fusion.h"
#include "perception/mapping/depth_mapper.h"
#include "perception/odometry/stereo_odometry.h"
#include "perception/pipeline/belief_builder.h"
#include "perception/pipeline/feature_density.h"
#include "perception/pipeline/input_log.h"
#include "perception/pipeline/landmark_memory.h"
#include "perception/pipeline/pose_history.h"

namespace prospect {

/// A depth camera on the body.
struct DepthCameraOnBody {
  PinholeCamera camera;
  CameraMount mount;
};

struct PerceptionOptions {
  CameraMount stereo_mount;                       ///< of the left camera
  std::optional<DepthCameraOnBody> depth_camera;  ///< none: depth images are refused
  /// Of depth images; `map` is also that of the map which scans enter.
  DepthMapperOptions mapping;
  /// Wheels measure the motion. Without them poses are those of the odometry, held while it is
  /// lost.
  bool wheels = true;
  WheelFusionOptions wheel_fusion;  ///< its `start` is not used
  FeatureDensityOptions feature_density;
  /// Of B in W, where the first pair is taken; z, the height of B's origin above the floor, is
  /// kept.
  Pose start;

  /// Stamps nearer than this are of one time [s]: of a left and a right image, of a stereo pair and
  /// a depth image that are held against each other.
  double same_time = 0.005;
  /// What is older than the newest input of any source by more than this [s] is late and left out.
  double max_age = 1.0;
  /// A depth image or scan that is newer than the newest pose by more than this [s] waits for it.
  /// Up to then the robot is taken to go on as it does, or to stand if it has no wheels.
  double max_ahead = 0.02;
  int most_waiting = 8;  ///< depth images and scans that wait; beyond, the oldest is left out
};

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

/// A robot's perception: stamped stereo pairs, wheel motion, depth images and scans in, the belief
/// that the planner takes out. It owns the odometry, its fusion with wheels, the mapping, the
/// memory of landmarks, and what holds one sensor against the other.
///
/// Frames. W: z up, the floor is z = 0. B: the body, in the plane. C: the left camera, at
/// stereo_mount. The odometry begins at T_WB(start) T_BC.
///
/// Order. All stamps are seconds of one clock that only goes on. Sources may come in any order
/// among each other; that of the calls does not matter as long as inputs come within max_age:
///   pairs    the stamp of a pair is the left image's. The two must be of same_time;
///   wheels   may come before or after the pair of their time (WheelFusion). A pair knows where to
///            look from wheel motion that came before it;
///   depth    is entered from the pose at its own stamp: between two pairs by interpolation, with
///            wheels from their motion; ahead of all poses it waits for one (max_ahead). Before
///            anything was measured the robot stands at the start.
/// Each source by itself must go on: an input that is not newer than the one before is left out, as
/// is one that is late (max_age), not finite, or an hour ahead of all others. The result of the
/// call says so, and input() keeps count. Nothing is left out in silence. What has stopped shows in
/// the stamps of the belief, whose age a guard limits (SourceStamps, guard.h).
///
/// Maps. A depth image enters through DepthMapper, a scan as it is. Without either nothing is
/// mapped: map_state() says so, and the belief's maps hold what map() was given.
///
/// Sensors against each other. Depths of the stereo pair are compared with those of the depth
/// camera where both look at the same time (depth_agreement.h), lengths by vision with those by
/// wheels (WheelFusion). While they disagree localization is lost, and complaint() says why.
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
  PerceptionPipeline(const StereoCamera& camera, const PerceptionOptions& options,
                     const StereoOdometryOptions& odometry = {});
  /// With another odometry, which begins at start_pose(options).
  PerceptionPipeline(std::unique_ptr<Odometry> odometry, const StereoCamera& camera,
                     const PerceptionOptions& options);
  /// T_WC of the left camera at the start.
  static Eigen::Isometry3d start_pose(const PerceptionOptions& options);

  InputResult stereo(const StampedPair& pair);
  InputResult wheels(const WheelSample& sample);
  InputResult depth(double stamp, DepthImage image);
  /// in_B: as DepthScan, with origin and points in B [m].
  InputResult scan(double stamp, DepthScan in_B);

  /// What is known at `stamp` [s], or at the newest measurement if that is later; with wheels the
  /// robot is taken to go on up to then. Never null. Of landmarks the survival is that to the next
  /// image: those that are lost later on are detected again.
  std::shared_ptr<const Belief> belief(double stamp);
  /// Likewise at the newest measurement.
  std::shared_ptr<const Belief> belief();

  /// The pose of belief(stamp).
  Pose pose(double stamp) const;
  /// Of the newest pair. Lost without one, or while depths disagree.
  const OdometryFrame& frame() const { return frame_; }
  const Odometry& odometry() const { return *odometry_; }
  /// What became of the newest depth image that was entered or rejected; none so far: rejected.
  const MappedFrame& mapped() const { return mapped_; }
  MapState map_state() const;
  /// Why the sensors cannot be trusted; empty: nothing is known against them.
  std::string complaint() const;
  /// What became of all inputs of a source.
  const InputCount& input(InputSource source) const { return log_.count(source); }

  /// To begin with a map that was made before, or with the robot's place known to be free.
  OccupancyMapper& map() { return mapper_ ? mapper_->map() : *scan_map_; }

 private:
  struct Waiting {
    double stamp = 0.0;
    std::shared_ptr<const DepthImage> depth;  // null: a scan
    DepthScan scan;
  };
  static InputSource source_of(const Waiting& input);
  InputResult take(Waiting input);
  InputResult enter(const Waiting& input);
  void enter_waiting();
  bool ahead(double stamp) const;
  /// Stamp of the newest pose; none: the robot stands at the start.
  std::optional<double> known_until() const;
  /// The pose of B at `stamp`, as it is believed to have been; none: not known any more.
  std::optional<Pose> pose_at(double stamp) const;
  /// Holds the newest pair against the newest depth image, if they are of one time.
  void compare();
  /// Empty, or that they disagree.
  std::string disagreement() const;
  void count_landmarks();

  PerceptionOptions options_;
  StereoCamera camera_;
  std::unique_ptr<Odometry> odometry_;
  VisualMotionReader reader_;
  WheelFusion fusion_;
  std::optional<DepthMapper> mapper_;
  std::optional<OccupancyMapper> scan_map_;  // without a depth camera
  BeliefBuilder builder_;
  LandmarkMemory memory_;
  FeatureDensity density_;
  std::unordered_set<std::uint64_t> places_;  // cells that have held a landmark

  InputLog log_;
  PoseHistory history_;  // at the pairs
  double newest_wheels_ = 0.0;
  OdometryFrame frame_;
  Pose pose_at_fix_;                         // when the odometry last took a pose
  std::shared_ptr<const DepthImage> depth_;  // the newest
  ScaleAgreement agreement_;     // of the newest pair and depth image that say something
  std::deque<Waiting> waiting_;  // by stamp
  MappedFrame mapped_;
  std::optional<double> map_stamp_;  // of the newest input that the map took in
};

}  // namespace prospect
