// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "models/types.h"

namespace prospect {

class Knobs;
struct RobotDescription;

/// A ray of a depth image or a scan, in B as it was at the capture.
struct RangeRay {
  enum class Kind {
    kHit,     ///< something is at `point`
    kClear,   ///< nothing is up to `point`, the end of the range
    kInvalid  ///< it measured nothing; `point` is anywhere along it
  };
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< [m]
  Kind kind = Kind::kInvalid;
};

/// One look of a range sensor.
struct RangeFrame {
  double stamp = 0.0;                                ///< [s] capture, in the runtime's clock
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< of the rays, in B [m]
  std::vector<RangeRay> rays;
};

/// The robot as this check knows it: a rectangle with round corners on the ground, and two heights.
/// Its numbers are its own, measured on the robot, and not the planner's.
struct RangeStopOptions {
  // The body's outline in B [m], from B's origin.
  double front = 0.25, rear = 0.25, left = 0.25, right = 0.25;
  double corner_radius = 0.25;  ///< [m]; as much as the shortest half side: a disc
  /// Heights in B [m]. What is below `lowest` is floor, what is above `highest` the body passes
  /// under.
  double lowest = 0.05, highest = 0.6;
  double floor = 0.0;             ///< height in B of the floor [m]
  double drop = 0.1;              ///< [m] below it, from which on it is no ground
  double margin = 0.05;           ///< [m] kept from what is seen
  double reaction_time = 0.15;    ///< [s] from a decision until the base brakes
  double deceleration = 0.5;      ///< [m/s^2] that the base keeps
  double yaw_deceleration = 1.0;  ///< [rad/s^2]
  double max_age = 0.5;           ///< [s] of the frame
  int least_points = 3;           ///< nearer ones than so many are taken for noise
  double least_valid = 0.3;       ///< share of the rays in the driven direction that must be valid
  double blind_speed = 0.1;       ///< [m/s] of the body's fastest point where no ray looks
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, RangeStopOptions& options);
/// What they are if nobody has measured the robot: the rectangle around the body's outline, a disc
/// for one that is round; its heights, from 5 cm above the floor on; the model's deceleration.
RangeStopOptions range_stop_options(const RobotDescription& robot);

enum class RangeStopReason {
  kClear,         ///< it may go on
  kObstacle,      ///< something is in the way
  kNoFloor,       ///< the floor ends in the way
  kTooFewRanges,  ///< the sensor looks there and measures too little: covered, glass, too near
  kOutOfView,     ///< the sensor does not look there
  kStale,         ///< the frame is too old, or from the future
  kNonFinite      ///< the command or a time is no number, or the command beyond all bounds
};
/// "clear", "obstacle", "no floor", "too few ranges", "out of view", "stale", "non-finite".
std::string_view to_string(RangeStopReason reason);

struct RangeStopVerdict {
  /// Of the command that may be driven, 0 to 1: linear velocity and yaw rate times as much.
  double share = 0.0;
  RangeStopReason reason = RangeStopReason::kStale;
  Eigen::Vector3d point =
      Eigen::Vector3d::Zero();   ///< kObstacle, kNoFloor: what is met first, in B
  double time_to_contact = 0.0;  ///< of these: [s] at the command, without braking
  std::string text;              ///< but for kClear: one sentence with numbers
  bool may_go_on() const { return share > 0.0; }
};

/// May a command go on, given what one range sensor sees now, and how fast? It knows no map, no
/// plan and no pose.
///
/// Motion. The base drives the arc of the command (v_x, v_y, w) for the age of the frame and the
/// reaction time, then it slows down evenly, all velocities in proportion, in
///   t_stop = max(|v| / deceleration, |w| / yaw_deceleration),
/// so it stays on the arc. In time of the full command, a share s of it takes
///   T(s) = age + s reaction_time + s^2 t_stop / 2.
/// Contact is at the first time T_c along the arc at which least_points hits between `lowest` and
/// `highest` lie within `margin` of the outline, of hits nearer than that at the start within 0.9
/// of the distance they have. Hits inside the outline at the start are the robot's own parts. The
/// share is the largest s with T(s) <= T_c. A ray that ends, hit or clear, deeper than `drop` below
/// the floor counts as a hit where it went through the floor's plane: there is no floor.
///
/// View. The directions that count are those of the points of the outline that go ahead: within 45
/// degrees of their outward normal, and at T(1) outside of the outline at the start. Rays are
/// sorted by azimuth into bins of 3 degrees (the ones beside count as well), those that pass above
/// `highest` or below `lowest` at the farthest of the points left out. No ray in more than half of
/// the directions: kOutOfView, blind_speed. Else, if the share of valid rays in them is below
/// least_valid: kTooFewRanges, 0.
///
/// So a robot that is round may always turn on the spot, and one that stands may stand.
///
/// Not seen: what has no surface for the sensor (glass, black), what is between the floor and
/// `lowest`, drops where no ray gets down to them, what moves by itself faster than the margin
/// allows for.
///
/// Cost: O(rays + hits near the way x 200 poses) at most: a depth image is thinned to some thousand
/// rays first. Thread-safety: const. Errors: the constructor
/// throws std::invalid_argument for options out of range; check() takes any numbers; rays that are
/// not finite count as invalid.
class RangeStop {
 public:
  explicit RangeStop(const RangeStopOptions& options = {});

  /// command: in force, or about to be [m/s, rad/s]; its vertical part is not looked at. now [s].
  RangeStopVerdict check(const RangeFrame& frame, const Twist& command, double now) const;

 private:
  double distance_to_body(const Eigen::Vector2d& p) const;  // negative inside
  RangeStopVerdict in_view(const RangeFrame& frame, const Twist& command, double time) const;

  struct OutlinePoint {
    Eigen::Vector2d point, normal;  // outward
  };

  RangeStopOptions options_;
  std::vector<OutlinePoint> outline_;
};

}  // namespace prospect
