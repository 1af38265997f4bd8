// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace prospect {

/// What is broken on purpose.
enum class FaultSource {
  kLeftCamera,
  kRightCamera,
  kCameras,  ///< both
  kDepth,
  kWheels,  ///< the encoders, by which the base measures its velocity
  kImu,
  kClock,    ///< of the sensors
  kPlanner,  ///< its thread
  kCommand,  ///< likewise
  kLink,     ///< to the base
  kDisk,     ///< to which the planner's thread writes each step
  kBase      ///< its motors
};
inline constexpr int kFaultSources = static_cast<int>(FaultSource::kBase) + 1;
/// How. The first seven are of whatever tells something, the others of what moves.
enum class FaultVerb {
  kOff,
  kStuck,
  kGarbage,
  kWrong,
  kSlow,
  kDelayed,
  kIntermittent,
  kInverted,
  kMirrored,
  kDouble,
  kIgnores,
  kRunaway,
  kOneWheel
};
inline constexpr int kFaultVerbs = static_cast<int>(FaultVerb::kOneWheel) + 1;
/// "left-camera", "right-camera", "cameras", "depth", "wheels", "imu", "clock", "planner",
/// "command", "link", "disk", "base".
std::string_view to_string(FaultSource source);
/// "off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent", "inverted", "mirrored",
/// "double", "ignores", "runaway", "one-wheel".
std::string_view to_string(FaultVerb verb);

/// A fault of the simulated robot, in the time since its start.
struct InjectedFault {
  FaultSource source = FaultSource::kDepth;
  FaultVerb verb = FaultVerb::kOff;
  double from = 0.0;      ///< [s]
  double duration = 1e9;  ///< [s]

  bool holds(double time) const { return time >= from && time < from + duration; }
};
/// "depth:off".
std::string name_of(const InjectedFault& fault);

// Sizes of what is broken.
inline constexpr double kFaultDelay = 0.3;         ///< [s] by which what is delayed is older
inline constexpr double kSlowFrames = 1.2;         ///< [s] from one frame or report to the next
inline constexpr double kOnOff = 1.0;              ///< [s] that what fails at times is off, and on
inline constexpr double kLinkOnOff = 0.5;          ///< [s] likewise of a link
inline constexpr double kSlowLink = 0.4;           ///< [s] from one command that passes to the next
inline constexpr double kCameraSkew = 0.02;        ///< [s] of the wrong stamps of one camera
inline constexpr double kDepthScale = 1.1;         ///< of depths that are too long
inline constexpr double kGyroOff = 0.4;            ///< [rad/s] by which a gyro is wrong
inline constexpr double kClockStep = 5.0;          ///< [s]
inline constexpr double kClockRate = 0.8;          ///< of a clock that is slow
inline constexpr double kSlowPlanner = 0.4;        ///< [s] that a step takes longer
inline constexpr double kSlowCommand = 0.3;        ///< [s] likewise of a command
inline constexpr double kRunaway = 0.4;            ///< [m/s] that a base is faster than told
inline constexpr double kFaultyTrack = 0.3;        ///< [m] between wheels of which one is dead
inline constexpr double kLongestThreadSleep = 20;  ///< [s], so that a mission ends

/// One source and one verb: what happens, or why it has no meaning of its own.
struct FaultKind {
  FaultSource source;
  FaultVerb verb;
  bool implemented;
  std::string_view text;
};
/// Each source with each verb that it may have, in this order.
std::span<const FaultKind> fault_kinds();
/// Null: that source has no such verb.
const FaultKind* fault_kind(FaultSource source, FaultVerb verb);
/// Those that are implemented as a table, Markdown; sources of which one verb does the same share a
/// row.
std::string fault_table();

/// "depth:off", "planner:stuck@10+2": from 10 s on, for 2 s. Throws std::invalid_argument for what
/// cannot be read, and for a pair that has no meaning, with the reason.
InjectedFault parse_fault(const std::string& text);

/// The fault of that source and verb that holds at a time; null: none does.
const InjectedFault* fault_at(const std::vector<InjectedFault>& faults, FaultSource source,
                              FaultVerb verb, double time);
/// Whether it holds, and what fails at times is off then.
bool off_at_times(const std::vector<InjectedFault>& faults, FaultSource source, double on_off,
                  double time);
/// [s] that the command thread sleeps at a time.
double command_sleep(const std::vector<InjectedFault>& faults, double time);

bool has_source(const std::vector<InjectedFault>& faults, FaultSource source);
/// Whether the sensors have a clock of their own: one of its faults is among them.
bool has_sensors_clock(const std::vector<InjectedFault>& faults);
/// `at` [s] in the runtime's clock, in the sensors' clock as it is `time` [s] after `start`.
double sensors_clock(const std::vector<InjectedFault>& faults, double start, double at,
                     double time);

}  // namespace prospect
