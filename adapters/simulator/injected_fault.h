#pragma once

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
  kCameras,
  kDepth,
  kWheels,
  kClock,
  kPlanner,
  kCommand,
  kLink
};
/// How.
enum class FaultVerb { kOff, kStuck, kGarbage, kWrong, kSlow, kDelayed, kIntermittent };
/// "left-camera", "right-camera", "cameras", "depth", "wheels", "clock", "planner", "command",
/// "link".
std::string_view to_string(FaultSource source);
/// "off", "stuck", "garbage", "wrong", "slow", "delayed", "intermittent".
std::string_view to_string(FaultVerb verb);

/// A fault of the simulated robot, in the time since its start.
struct InjectedFault {
  FaultSource source = FaultSource::kDepth;
  FaultVerb verb = FaultVerb::kOff;
  double from = 0.0;      ///< [s]
  double duration = 1e9;  ///< [s]

  bool holds(double time) const { return time >= from && time < from + duration; }
};

/// What this simulator can do, and what happens then:
///   cameras, depth  off           nothing more comes: what they measure and its stamps stay
///                   intermittent  nothing comes in every other second
///                   delayed       what comes is 0.3 s older
///   link            off           neither commands nor reports pass: the base's dead-man stops it
///                   intermittent  they pass in every other half second
///                   delayed       commands come 0.3 s later
///   planner         stuck         a step does not end before the fault does
///                   slow          a step takes 0.4 s longer
struct ImplementedFault {
  FaultSource source;
  FaultVerb verb;
};
std::span<const ImplementedFault> implemented_faults();
inline constexpr double kFaultDelay = 0.3;  ///< [s]

/// "depth:off", "planner:stuck@10+2": from 10 s on, for 2 s. Throws std::invalid_argument for what
/// cannot be read, and for a combination that is not implemented, naming those that are.
InjectedFault parse_fault(const std::string& text);

/// Whether a fault of that source and verb holds at a time; null: none does.
const InjectedFault* fault_at(const std::vector<InjectedFault>& faults, FaultSource source,
                              FaultVerb verb, double time);

}  // namespace prospect
