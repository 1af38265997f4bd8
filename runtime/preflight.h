// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/maps/localization.h"
#include "models/robot_shape.h"
#include "models/types.h"
#include "runtime/emergency_stop.h"
#include "runtime/floor_sight.h"

namespace prospect {

class Knobs;

enum class CheckVerdict {
  kPassed,
  kWarned,       ///< the robot may drive; a person should know
  kFailed,       ///< it may not
  kNotPossible,  ///< what is needed for the check was not there; it may drive
};
/// "passed", "warned", "failed", "not possible".
std::string_view to_string(CheckVerdict verdict);

struct CheckResult {
  std::string check;
  CheckVerdict verdict = CheckVerdict::kFailed;
  std::string why;  ///< one sentence with the numbers
};

struct PreflightOptions {
  // What is off by more is warned of, and fails.
  double height_warn = 0.01, height_fail = 0.05;     ///< of the camera above the floor [m]
  double tilt_warn = 0.01, tilt_fail = 0.05;         ///< of the camera [rad]
  double stereo_warn = 0.001, stereo_fail = 0.005;   ///< of the cameras' captures [s]
  double yaw_warn = 0.05, yaw_fail = 0.25;           ///< of the gain of yaw [1]
  double distance_warn = 0.15, distance_fail = 0.5;  ///< of the gain of a short way ahead [1]
  double floor_noise = 0.02;                         ///< [m] that points of the floor stand out
  double longest_dead_man = 1.0;                     ///< [s]
  double live_time = 1.0;        ///< [s] that a stream must have been within its limit
  double least_turn = 0.1;       ///< [rad] commanded, for the check of yaw
  double least_distance = 0.02;  ///< [m] commanded, for the check of the way
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, PreflightOptions& options);

/// What is known before the first motion. What is not known stays empty: its check is then not
/// possible, and says so.
struct PreflightFacts {
  /// A depth camera's pose against the floor, as mounted and as the depth images show it
  /// (GroundPlane of perception/mapping).
  struct Floor {
    double stated_height = 0.0, height = 0.0;  ///< of the camera above the floor [m]
    double stated_pitch = 0.0, pitch = 0.0;    ///< down [rad]
    double stated_roll = 0.0, roll = 0.0;      ///< the image's right side down [rad]
    double sigma_height = 0.0;                 ///< one standard deviation [m]
    double sigma_tilt = 0.0;                   ///< [rad]
  };
  std::optional<Floor> floor{};
  bool depth_camera = true;  ///< it has one; else its height and tilt are no checks
  bool stereo_pair = true;   ///< likewise, and cameras in step
  /// Heights in W that the body sweeps (RobotDescription::slice()) [m], and the map's resolution.
  std::optional<VerticalExtent> body{};
  double resolution = 0.1;  ///< [m]
  /// What of the floor ahead is in view; none: nobody says.
  struct FloorAhead {
    std::optional<FloorSight> sight{};  ///< none: no sensor looks at it
    double front = 0.0;                 ///< of the body, ahead of B's origin [m]
    double delay = 0.0;                 ///< from what comes into view to the brakes [s]
  };
  std::optional<FloorAhead> floor_ahead{};
  /// Capture of the right image - capture of the left one [s].
  std::optional<double> stereo_offset{};

  struct Clock {
    std::string source;
    std::optional<double> offset;  ///< [s] (ClockOffset); none: not settled
    int jumps = 0;
  };
  std::vector<Clock> clocks{};

  struct Stream {
    std::string source;
    double age = 0.0, limit = 0.0;  ///< [s]
    double live_for = 0.0;          ///< [s] that it has been within its limit
    std::optional<double> rate{};   ///< [1/s] of its frames; none: nobody counts
  };
  std::vector<Stream> streams{};

  /// Where the robot is, as the belief has it; none: nobody says.
  struct Place {
    Pose pose;
    double sigma = 0.0;  ///< [m] of its position, in the worst direction; not finite: unknown
    Localization localization = Localization::kLost;
  };
  std::optional<Place> place{};
  /// What the newest depth image or scan measures; none: no raw ranges come.
  struct Ranges {
    std::size_t rays = 0, hits = 0;
    double nearest = 0.0;  ///< [m] from the sensor; of hits
  };
  std::optional<Ranges> ranges{};

  /// Of what others press; none: nothing of that kind is set up.
  std::optional<EmergencyStopState> emergency_stop{};

  /// Why the base cannot be driven: what it reports, or that it is silent; empty: it can. None: it
  /// was not asked.
  std::optional<std::string> base{};
  /// Why commands are not sent before all else that runs here (RealtimePriority); empty: they are.
  /// None: that is not asked for.
  std::optional<std::string> priority{};
  /// [s] of silence after which the base stops by itself; none: it declares no dead-man.
  std::optional<double> dead_man{};
  /// [s] from one command to the next. The command thread alone keeps the dead-man from acting.
  double command_period = 0.0;
  /// What the base says it can do, and what the motion model counts on.
  struct Limit {
    std::optional<double> base;
    double model = 0.0;
  };
  Limit speed{}, yaw_rate{}, deceleration{};  ///< [m/s], [rad/s], [m/s^2]
};

/// Checks that need no motion, always in the same order, those of clocks and streams once for each,
/// those of cameras where there are some:
///   camera height, camera tilt   against the mount;
///   body above the floor         the floor as it is seen must not reach the body's lowest layer of
///                                voxels. A camera that is 2 cm lower than stated lifts the floor
///                                by as much; under a body down to z = 0 it is an obstacle that is
///                                everywhere, and the robot hardly moves and says nothing;
///   floor ahead                  a depth sensor sees it in time: at its largest speed the robot
///                                comes to rest before what just comes into view; else warned of,
///                                as is a robot whose sensors do not look at the floor ahead;
///   cameras in step              |offset|;
///   clock of SOURCE              settled; jumps are warned of;
///   stream of SOURCE             within its limit for live_time;
///   localization                 it is ok; else warned of;
///   ranges                       some of them hit something; else warned of: covered, or far away;
///   base                         it answers, and reports no fault;
///   emergency stop               who may press it is heard of, and does not;
///   priority of commands         before all else that runs here; if the system does not allow it:
///                                warned of;
///   dead-man                     declared, no longer than longest_dead_man, and longer than a
///                                period of commands; shorter than two, so that one late command
///                                trips it: warned of. What other threads need does not count: they
///                                send nothing, and a supervisor watches them;
///   largest speed, largest yaw rate, deceleration: the base reaches what the model counts on.
/// A number that is not finite fails. Pure.
std::vector<CheckResult> checks_before_motion(const PreflightFacts& facts,
                                              const PreflightOptions& options = {});

/// A short motion as it was commanded and as it was measured, in the sense of B: a turn on the
/// spot, by 0.2 rad or so (positive: to the left) [rad], or a way straight ahead, of 5 cm or so
/// [m].
struct ShortMotion {
  double commanded = 0.0;
  std::optional<double> wheels{};  ///< the base's own odometry
  std::optional<double> pose{};    ///< of the belief: visual odometry, or who else localizes
  bool has_gyro = false;           ///< there is an IMU
  std::optional<double> gyro{};    ///< its turn; none: its bias is not known
};
/// The checks that need motion: "yaw of the wheels", "yaw of the pose", and of who has an IMU "yaw
/// of the gyro", each against what was commanded, and "slip", pose against wheels. A base that
/// turns the other way, or not by a quarter of it, fails. Pure.
std::vector<CheckResult> checks_of_turn(const ShortMotion& turn,
                                        const PreflightOptions& options = {});
/// Likewise "way of the wheels" and "way of the pose".
std::vector<CheckResult> checks_of_distance(const ShortMotion& way,
                                            const PreflightOptions& options = {});

/// Name of the first check that failed; empty: none did, the robot may drive.
std::string first_failed(const std::vector<CheckResult>& results);

/// What came of the checks before the first motion.
struct PreflightResult {
  std::vector<CheckResult> checks;  ///< of preflight_run.h: all of these, in its order
  bool yaw_checked = false;         ///< the turn was made, and measured by wheels or cameras
};

/// One line a check: name, verdict, why; in columns.
std::string to_text(const std::vector<CheckResult>& results);

}  // namespace prospect
