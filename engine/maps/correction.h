// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/maps/place_moves.h"
#include "models/types.h"

namespace prospect {

/// What moves against what.
enum class CorrectionKind : std::uint8_t {
  kMap,     ///< the map's frame M against W: `map` -> `odom` of ROS (REP 105)
  kRobot,   ///< the robot against what it has drawn: its pose in W was wrong
  kAnchors  ///< parts of what it has drawn against each other
};

/// A keyframe, with the evidence that was seen from it, moves in W: p_new = T_new_old p_old.
struct AnchorMove {
  std::uint64_t anchor = 0;
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();
};

/// What moved, how far, and how surely: an event.
///
/// Two frames. W is the one in which odometry goes on without a jump. All that was measured is in
/// W: octree, voxels, ground, landmarks, drift, frontiers and what is remembered of them, target,
/// places to retreat to, where the mission began, the path driven, the plan in flight, the pose. M
/// is the map's: what people have told is in M: goals, zones, areas. T_MW says where W lies in M.
///
/// kMap: a place that was at p in M is at T_new_old p now, so
///     T_MW <- T_new_old T_MW,
/// and nothing that was measured changes, nor does it get older: the robot, the walls around it and
/// the plan stay consistent with each other, to the bit. What was told stays where it is in M, and
/// so moves in W, by T_MW^-1; the guard certifies the plan against it before the next command.
/// What is told to others in M is told by the T_MW of its time.
///
/// kRobot, kAnchors: what was drawn moves, where the map is made of anchors (anchored_map.h), which
/// takes some steps; then all that was measured is corrected at one instant. T_new_old is how the
/// robot moves, the open anchor with it, and `anchors` how the others do (kRobot: not at all). W
/// goes on without a jump: as seen from the robot, which stands still in it, each anchor and all
/// that was seen from there moves by T_new_old^-1 T_anchor, and
///     T_MW <- T_MW T_new_old.
/// What rests on places in W follows MapFrame::moved_places. Where the map is one piece, which
/// cannot move, such a correction is answered by kCannotFollow, and changes nothing. So a pose from
/// outside that is corrected is taken as kMap (perception_pipeline.h): the robot's place in what it
/// drew around it stays right, which is what keeps it off walls.
struct Correction {
  double stamp = 0.0;  ///< [s] of the beliefs' clock
  CorrectionKind kind = CorrectionKind::kMap;
  Eigen::Isometry3d T_new_old = Eigen::Isometry3d::Identity();  ///< kMap: in M; else in W
  /// Of its error in (x, y, z, yaw) [m, m, m, rad]; zero: not told.
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  std::vector<AnchorMove> anchors{};  ///< of kAnchors
  std::string why;                    ///< who corrects, and by what: one line
};

/// A correction that was taken.
struct TakenCorrection {
  double stamp = 0.0;     ///< [s]
  double distance = 0.0;  ///< [m] that the robot moved in M
  double turn = 0.0;      ///< [rad], within (-pi, pi]
  double sigma = 0.0;     ///< [m], of the position (position_sigma()); 0: not told
  std::string why;
};

/// "the map was corrected by 3.00 m and 30.0 degrees: WHY"
std::string to_text(const TakenCorrection& correction);

/// How what was measured has moved in W at a correction.
struct MovedPlaces {
  int taken = 0;  ///< MapFrame::taken from then on
  std::shared_ptr<const PlaceMoves> how;
};

/// A correction of kRobot or kAnchors that the map has followed.
struct FollowedCorrection {
  Correction correction;
  std::shared_ptr<const PlaceMoves> moves;
};

/// Where W lies in M, and how that came about; a value that never changes.
struct MapFrame {
  Pose origin;      ///< T_MW in the plane: of W's origin, in M; its z is 0
  int taken = 0;    ///< corrections so far
  int refused = 0;  ///< that could not be, or came too often
  int cannot_follow = 0;
  std::optional<TakenCorrection> newest{};
  std::string refusal{};  ///< of the newest that was refused or cannot be followed, one line
  static constexpr std::size_t kMostMoved = 8;
  std::vector<MovedPlaces> moved_places{};  ///< the newest, in their order

  Pose map_in_W() const;  ///< T_WM: of M's origin, in W
  Pose to_map(const Pose& in_W) const;
  Pose to_W(const Pose& in_M) const;
  Eigen::Vector2d to_map(const Eigen::Vector2d& in_W) const;
  Eigen::Vector2d to_W(const Eigen::Vector2d& in_M) const;
};

/// Of W in M; null: the identity.
Pose origin_of(const MapFrame* frame);

enum class CorrectionVerdict { kTaken, kRefused, kCannotFollow };

/// Judges corrections, and keeps where W lies in M.
///
/// Taken is one
///   - of a finite stamp, later than that of the one before by kPeriod: more often than ten times a
///     second nobody localizes, and each asks for a new certificate;
///   - that is a rotation and translation, finite, and tilts by at most kTilt: both frames' z is
///   up.
///     What it tilts or lifts besides is left out, as zones are prisms and goals places in the
///     plane;
///   - that moves the robot in M by at most kFarthestMove: farther than a building is long it is a
///     unit or a frame that is wrong (3 m told in mm are 3000 m);
///   - whose covariance is one (is_pose_covariance()).
/// All else changes nothing but the counts, and is told in one line.
///
/// Thread-safety: one thread; frame() may be shared. Never throws but std::bad_alloc.
/// Deterministic. Source: ours; REP 105 for the frames.
class Corrections {
 public:
  static constexpr double kPeriod = 0.1;          ///< [s]
  static constexpr double kTilt = 0.1;            ///< [rad]
  static constexpr double kFarthestMove = 100.0;  ///< [m]

  /// robot: its pose in W. `why` of the answer: empty if it was taken.
  struct Answer {
    CorrectionVerdict verdict = CorrectionVerdict::kTaken;
    std::string why{};
  };
  Answer take(const Correction& correction, const Pose& robot);
  /// Why one of anchors or of the robot is refused where it could be followed; counted. Empty: it
  /// may be.
  std::string refuse(const Correction& correction, const Pose& robot);
  /// It was followed, and what was measured has moved in W.
  void followed(const Correction& correction, const Pose& robot,
                std::shared_ptr<const PlaceMoves> how);
  /// A correction is wanted that nobody can make; counted once, as long as it is the same.
  void cannot(const std::string& why);
  /// From now on frame() is never null: somebody may correct.
  void expect();
  /// Null: nobody has corrected, and nobody is expected to.
  const std::shared_ptr<const MapFrame>& frame() const { return frame_; }

 private:
  std::string objection(const Correction& correction, const Pose& robot) const;
  static void take_into(MapFrame& next, const Correction& correction, const Pose& robot);

  std::shared_ptr<const MapFrame> frame_;
};

}  // namespace prospect
