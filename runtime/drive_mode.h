// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/maps/localization.h"

namespace prospect {

class Knobs;

/// Whether the robot drives.
enum class DriveMode {
  kIdle,      ///< it stands; something is missing
  kReady,     ///< it stands; it drives as soon as there is a new plan from rest
  kActive,    ///< it drives
  kDegraded,  ///< it drives slower
  kStopping,  ///< it brakes
  kStopped    ///< it is held (Base::stop()), latched: only an acknowledgement leads out
};
inline constexpr std::array kDriveModes = {DriveMode::kIdle,     DriveMode::kReady,
                                           DriveMode::kActive,   DriveMode::kDegraded,
                                           DriveMode::kStopping, DriveMode::kStopped};

/// Why a drive mode was entered.
enum class DriveCause {
  kStart,
  kAcknowledged,          ///< a person has acknowledged the stop
  kSourcesLive,           ///< all that is needed is there, and has been for a time
  kNewPlan,               ///< there is a new plan from rest
  kLocalizationRegained,  ///< localization has been ok for a time
  kLocalizationLost,
  kYawUnchecked,  ///< sign and gain of yaw are not known yet (preflight.h)
  kLocalizationDegraded,
  kPreflight,    ///< a check before the first motion has failed, or was not made
  kClockJumped,  ///< a clock has jumped (clock_offset.h)
  kPoseJumped,   ///< a pose from outside has jumped (pose_jump.h)
  kSourceStale,  ///< what is needed is older than its limit
  kPlanOver,     ///< no plan says how to go on
  kToldToStand,
  kTaskOver,
  kObstacle,             ///< ranges show what the map does not know (range_stop.h)
  kThreadLate,           ///< a thread does not answer (supervisor.h)
  kEmergencyStop,        ///< asked for
  kEmergencyStopSilent,  ///< nobody is heard of who could ask for one (emergency_stop.h)
  kBaseFault,            ///< the base reports one
  kBaseSilent,           ///< the base reports nothing
  kThreadEnded,
  kUncommandedMotion,  ///< the base measures motion that nobody has told it
  kDoesNotFollow,      ///< the base moves otherwise than it is told to (command_following.h)
  kDoesNotStop         ///< a stop takes too long
};
inline constexpr int kDriveCauses = static_cast<int>(DriveCause::kDoesNotStop) + 1;

/// "idle", "ready", "active", "degraded", "stopping", "stopped".
std::string_view to_string(DriveMode mode);
/// "start", "acknowledged", "sources live", ...
std::string_view to_string(DriveCause cause);

struct DriveModeOptions {
  double live_time = 1.0;        ///< [s] that all sources must have been live before it is ready
  double rest_time = 0.3;        ///< [s] without motion that are rest
  double recover_time = 1.0;     ///< [s] of good localization before full speed again
  double stop_time = 4.0;        ///< [s] longest stop
  double degraded_share = 0.5;   ///< of the speed, while localization is degraded
  double lost_share = 0.3;       ///< of the speed, while it is lost
  double unchecked_share = 0.3;  ///< of the speed, while yaw is not checked
};
/// The knobs (models/knobs.h).
void describe(Knobs& knobs, DriveModeOptions& options);

/// What is known at one instant of what decides whether the robot may drive. No judgement. Stamps
/// in the runtime's monotonic clock [s]; times in a row are 0 while it is not so. Names are of what
/// is at fault; empty: nothing is. What nobody has set stands for what stops the robot.
struct DriveFacts {
  double stamp = 0.0;
  // Asked for.
  bool told_to_drive = false;   ///< else to stand
  bool emergency_stop = false;  ///< by whomever; stays so until that is taken back
  /// Why nobody is heard of who could ask for one, where somebody must be.
  std::string silent_emergency_stop{"nobody has asked who could press it"};
  bool acknowledged = false;  ///< a person acknowledges the stop, at this instant
  // Sources and clocks.
  double live_for = 0.0;       ///< [s] that all sources needed have been within their limits
  std::string stale_source{};  ///< a source that is not
  std::string jumped_clock{};  ///< since the last decision
  std::string jumped_pose{};   ///< likewise; by how much
  std::string failed_preflight{"none was made"};  ///< a check that failed, or none was made
  bool yaw_checked = false;
  // Base.
  double rest_for = 0.0;  ///< [s] that the base has measured no motion
  std::string base_fault{};
  bool base_silent = true;  ///< its newest report is older than its limit
  bool uncommanded_motion = false;
  std::string not_following{};  ///< how it moves otherwise than it is told to
  // Threads (Supervisor).
  std::string late_thread{}, ended_thread{};
  // Plan.
  std::optional<double> plan_from_rest{};  ///< stamp of the belief of the newest plan that starts
                                           ///< at rest
  double plan_left = 0.0;                  ///< [s] until what the plan in force certifies ends
  bool task_over = false;
  // What is around.
  std::string obstacle{};  ///< what stops the command in force or the next (RangeStop)
  Localization localization = Localization::kLost;
  double localized_for = 0.0;  ///< [s] that it has been ok
};

/// The mode, why, and since when. A value; all that is remembered.
struct DriveState {
  DriveMode mode = DriveMode::kIdle;
  DriveCause cause = DriveCause::kStart;
  double since = 0.0;  ///< [s] when the mode was entered; its cause may be newer
};

/// What a mode and its cause mean for the motors.
enum class DriveResponse {
  kStand,         ///< zero velocity
  kFull,          ///< the plan's commands
  kSlow,          ///< the plan's way, at a share of its speed
  kComfortStop,   ///< braking along the plan's way
  kEmergencyStop  ///< the hardest braking of the model
};
/// "stand", "full speed", "slower", "comfort stop", "emergency stop".
std::string_view to_string(DriveResponse response);

/// What a cause means for the motors while the robot drives slower, brakes or is held because of
/// it.
struct DriveCausePolicy {
  DriveCause cause;
  DriveResponse response;
  double DriveModeOptions::*share;  ///< of kSlow: the speed's; else null
  bool latches;                     ///< the stop ends in kStopped
};
/// Of all causes of degraded and stopping, in the order of DriveCause.
std::span<const DriveCausePolicy> drive_cause_policies();
bool latches(DriveCause cause);

struct DriveSpeed {
  DriveResponse response = DriveResponse::kStand;
  double share = 0.0;  ///< of the plan's speed, 0 to 1
};
/// What the motors get in a state.
DriveSpeed drive_speed(const DriveState& state, const DriveModeOptions& options);

/// A set of modes, for the table.
struct DriveModeSet {
  unsigned bits = 0;
  constexpr bool holds(DriveMode mode) const { return bits >> static_cast<unsigned>(mode) & 1U; }
};
/// "any", or the names with ", " between them.
std::string to_string(DriveModeSet modes);

/// A row of the table: from · condition on facts · to · cause (none: as it was). In order of
/// precedence: the first row that holds is taken.
struct DriveModeRow {
  struct Case {
    const DriveState& before;
    const DriveFacts& facts;
    const DriveModeOptions& options;
  };
  DriveModeSet from;
  std::string_view condition;
  bool (*holds)(const Case&);
  DriveMode to;
  std::optional<DriveCause> cause;
};
/// Total: of each mode, its last row holds always.
std::span<const DriveModeRow> drive_mode_table();

/// The row that decides. Pure. Numbers that are not finite decide for standing.
const DriveModeRow& deciding_row(const DriveState& before, const DriveFacts& facts,
                                 const DriveModeOptions& options);
/// The state that follows. Pure; an emergency stop is answered by the first decision after it.
DriveState decide(const DriveState& before, const DriveFacts& facts,
                  const DriveModeOptions& options);

/// One sentence: what the robot does and why, e.g. "Brakes along its way: source stale (left
/// camera)."
std::string describe(const DriveState& state, const DriveFacts& facts);

/// The tables of modes and causes as text for people, Markdown.
std::string drive_mode_tables();

}  // namespace prospect
