// SPDX-License-Identifier: Apache-2.0
#include "adapters/robots/faults/injected_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "adapters/formats/files/parse_number.h"

namespace prospect {
namespace {

constexpr std::array kKinds = {
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kOff, true,
              "none of its images comes, so there are no pairs"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kStuck, true,
              "the same image comes again and again, with its old stamp"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kGarbage, true, "its images are empty"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kWrong, true,
              "its stamps are 20 ms off, so no image finds its partner"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kSlow, true, "an image comes every 1.2 s"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kDelayed, true, "its images come 0.3 s late"},
    FaultKind{FaultSource::kLeftCamera, FaultVerb::kIntermittent, true,
              "none comes in every other second"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kOff, true,
              "none of its images comes, so there are no pairs"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kStuck, true,
              "the same image comes again and again, with its old stamp"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kGarbage, true, "its images are empty"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kWrong, true,
              "its stamps are 20 ms off, so no image finds its partner"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kSlow, true, "an image comes every 1.2 s"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kDelayed, true, "its images come 0.3 s late"},
    FaultKind{FaultSource::kRightCamera, FaultVerb::kIntermittent, true,
              "none comes in every other second"},
    FaultKind{FaultSource::kCameras, FaultVerb::kOff, true, "no image comes"},
    FaultKind{FaultSource::kCameras, FaultVerb::kStuck, true,
              "both show the same picture, with new stamps: the estimate stands still"},
    FaultKind{FaultSource::kCameras, FaultVerb::kGarbage, true, "the images are empty"},
    FaultKind{FaultSource::kCameras, FaultVerb::kWrong, false,
              "what is wrong in both alike is a wrong calibration: simulator.camera.focal_error"},
    FaultKind{FaultSource::kCameras, FaultVerb::kSlow, true, "a pair comes every 1.2 s"},
    FaultKind{FaultSource::kCameras, FaultVerb::kDelayed, true, "pairs come 0.3 s late"},
    FaultKind{FaultSource::kCameras, FaultVerb::kIntermittent, true,
              "none comes in every other second"},
    FaultKind{FaultSource::kDepth, FaultVerb::kOff, true, "no scan comes"},
    FaultKind{FaultSource::kDepth, FaultVerb::kStuck, true,
              "the map gets nothing new, with new stamps"},
    FaultKind{FaultSource::kDepth, FaultVerb::kGarbage, true, "each ray ends anywhere"},
    FaultKind{FaultSource::kDepth, FaultVerb::kWrong, true, "depths are 10 % too long"},
    FaultKind{FaultSource::kDepth, FaultVerb::kSlow, true, "a scan comes every 1.2 s"},
    FaultKind{FaultSource::kDepth, FaultVerb::kDelayed, true, "scans come 0.3 s late"},
    FaultKind{FaultSource::kDepth, FaultVerb::kIntermittent, true,
              "none comes in every other second"},
    FaultKind{FaultSource::kWheels, FaultVerb::kOff, true,
              "the base says that its encoders do not answer"},
    FaultKind{FaultSource::kWheels, FaultVerb::kStuck, true,
              "the measured velocity stays as it was"},
    FaultKind{FaultSource::kWheels, FaultVerb::kGarbage, true,
              "the measured velocity is no number"},
    FaultKind{FaultSource::kWheels, FaultVerb::kWrong, true,
              "the measured velocity is twice the true one"},
    FaultKind{FaultSource::kWheels, FaultVerb::kSlow, true, "the base reports every 1.2 s"},
    FaultKind{FaultSource::kWheels, FaultVerb::kDelayed, true,
              "the measured velocity is 0.3 s old"},
    FaultKind{FaultSource::kWheels, FaultVerb::kIntermittent, true,
              "the measured velocity is zero in every other half second"},
    FaultKind{FaultSource::kImu, FaultVerb::kOff, true, "no sample comes"},
    FaultKind{FaultSource::kImu, FaultVerb::kStuck, true,
              "it repeats its newest sample, with new stamps"},
    FaultKind{FaultSource::kImu, FaultVerb::kGarbage, true, "its samples are no numbers"},
    FaultKind{FaultSource::kImu, FaultVerb::kWrong, true,
              "its gyro tells 0.4 rad/s more to the left than there are"},
    FaultKind{FaultSource::kImu, FaultVerb::kSlow, true, "a sample comes every 1.2 s"},
    FaultKind{FaultSource::kImu, FaultVerb::kDelayed, true, "samples come 0.3 s late"},
    FaultKind{FaultSource::kImu, FaultVerb::kIntermittent, true,
              "none comes in every other second"},
    FaultKind{FaultSource::kClock, FaultVerb::kOff, false,
              "frames without a clock have no stamps: clock:garbage"},
    FaultKind{FaultSource::kClock, FaultVerb::kStuck, true,
              "the sensors' stamps stay as they were"},
    FaultKind{FaultSource::kClock, FaultVerb::kGarbage, true, "the sensors' stamps are no numbers"},
    FaultKind{FaultSource::kClock, FaultVerb::kWrong, true,
              "the sensors' clock is set 5 s ahead, and back at the end"},
    FaultKind{FaultSource::kClock, FaultVerb::kSlow, true,
              "the sensors' clock runs at 0.8 of its rate"},
    FaultKind{FaultSource::kClock, FaultVerb::kDelayed, false,
              "a clock that is late by a constant time has another offset, which nobody can see"},
    FaultKind{FaultSource::kClock, FaultVerb::kIntermittent, true,
              "the sensors' clock is 5 s ahead in every other second"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kOff, false,
              "a thread that ends has ended its process; one that sleeps is planner:stuck"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kStuck, true,
              "a step does not end before the fault does, or 20 s have passed"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kGarbage, true,
              "the plan's commands are no numbers"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kWrong, true,
              "the plan drives straight on at full speed, and says that it is certified"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kSlow, true, "a step takes 0.4 s longer"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kDelayed, false,
              "a plan that comes later is one of a slower planner: planner:slow"},
    FaultKind{FaultSource::kPlanner, FaultVerb::kIntermittent, true,
              "a step that begins in every other second takes 1 s longer"},
    FaultKind{FaultSource::kCommand, FaultVerb::kOff, false,
              "a thread that ends has ended its process; one that sleeps is command:stuck"},
    FaultKind{FaultSource::kCommand, FaultVerb::kStuck, true,
              "the thread sleeps until the fault ends, or for 20 s"},
    FaultKind{FaultSource::kCommand, FaultVerb::kGarbage, false,
              "commands that are no numbers are what the guard is tested with; nobody stands "
              "behind the thread that asks it"},
    FaultKind{FaultSource::kCommand, FaultVerb::kWrong, false,
              "nobody stands behind the thread that decides but the base's own limits"},
    FaultKind{FaultSource::kCommand, FaultVerb::kSlow, true, "each command takes 0.3 s longer"},
    FaultKind{FaultSource::kCommand, FaultVerb::kDelayed, false,
              "commands that come later are those of a slower link: link:delayed"},
    FaultKind{FaultSource::kCommand, FaultVerb::kIntermittent, true,
              "the thread sleeps for a second in every two"},
    FaultKind{FaultSource::kLink, FaultVerb::kOff, true,
              "neither commands nor reports pass: the dead-man stops the base"},
    FaultKind{FaultSource::kLink, FaultVerb::kStuck, true,
              "commands pass; the newest report stays"},
    FaultKind{FaultSource::kLink, FaultVerb::kGarbage, false,
              "bytes that fail their checksum are dropped, so it is link:off; a base's driver is "
              "tested for it"},
    FaultKind{FaultSource::kLink, FaultVerb::kWrong, false,
              "a base that moves otherwise than it is told is base:inverted and others"},
    FaultKind{FaultSource::kLink, FaultVerb::kSlow, true, "a command passes every 0.4 s"},
    FaultKind{FaultSource::kLink, FaultVerb::kDelayed, true,
              "commands come 0.3 s later; what has expired then is not executed"},
    FaultKind{FaultSource::kLink, FaultVerb::kIntermittent, true,
              "both pass in every other half second"},
    FaultKind{FaultSource::kDisk, FaultVerb::kOff, false,
              "what cannot be written is told at the end, and does not reach the robot"},
    FaultKind{FaultSource::kDisk, FaultVerb::kStuck, true,
              "writing does not end before the fault does, or 20 s have passed"},
    FaultKind{FaultSource::kDisk, FaultVerb::kGarbage, false,
              "nothing that drives the robot is read from a disk"},
    FaultKind{FaultSource::kDisk, FaultVerb::kWrong, false,
              "nothing that drives the robot is read from a disk"},
    FaultKind{FaultSource::kDisk, FaultVerb::kSlow, true, "writing a step takes 0.4 s"},
    FaultKind{FaultSource::kDisk, FaultVerb::kDelayed, false,
              "what is written later is written slower: disk:slow"},
    FaultKind{FaultSource::kDisk, FaultVerb::kIntermittent, true,
              "writing that begins in every other second takes 1 s"},
    FaultKind{FaultSource::kBase, FaultVerb::kInverted, true,
              "it drives backwards where it is told forwards, and the other way round"},
    FaultKind{FaultSource::kBase, FaultVerb::kMirrored, true,
              "it turns the other way, as if its wheels were exchanged"},
    FaultKind{FaultSource::kBase, FaultVerb::kDouble, true, "it drives and turns twice as fast"},
    FaultKind{FaultSource::kBase, FaultVerb::kIgnores, true, "it stands whatever it is told"},
    FaultKind{FaultSource::kBase, FaultVerb::kRunaway, true,
              "once told to move it drives on, 0.4 m/s faster than it is told, until it is stopped "
              "(`Base::stop()`)"},
    FaultKind{FaultSource::kBase, FaultVerb::kOneWheel, true, "its left wheel stands"}};

/// The value of an enumeration that has that name; none: no such value.
template <typename Enumeration>
std::optional<Enumeration> named(int count, const std::string& name) {
  for (int k = 0; k < count; ++k) {
    const auto value = static_cast<Enumeration>(k);
    if (to_string(value) == name) return value;
  }
  return std::nullopt;
}

template <typename Enumeration>
std::string all_names(int count) {
  std::string names;
  for (int k = 0; k < count; ++k) {
    names += (k == 0 ? "" : ", ") + std::string(to_string(static_cast<Enumeration>(k)));
  }
  return names;
}

}  // namespace

std::string_view to_string(FaultSource source) {
  switch (source) {
    case FaultSource::kLeftCamera:
      return "left-camera";
    case FaultSource::kRightCamera:
      return "right-camera";
    case FaultSource::kCameras:
      return "cameras";
    case FaultSource::kDepth:
      return "depth";
    case FaultSource::kWheels:
      return "wheels";
    case FaultSource::kImu:
      return "imu";
    case FaultSource::kClock:
      return "clock";
    case FaultSource::kPlanner:
      return "planner";
    case FaultSource::kCommand:
      return "command";
    case FaultSource::kLink:
      return "link";
    case FaultSource::kDisk:
      return "disk";
    case FaultSource::kBase:
      return "base";
  }
  return "?";
}

std::string_view to_string(FaultVerb verb) {
  switch (verb) {
    case FaultVerb::kOff:
      return "off";
    case FaultVerb::kStuck:
      return "stuck";
    case FaultVerb::kGarbage:
      return "garbage";
    case FaultVerb::kWrong:
      return "wrong";
    case FaultVerb::kSlow:
      return "slow";
    case FaultVerb::kDelayed:
      return "delayed";
    case FaultVerb::kIntermittent:
      return "intermittent";
    case FaultVerb::kInverted:
      return "inverted";
    case FaultVerb::kMirrored:
      return "mirrored";
    case FaultVerb::kDouble:
      return "double";
    case FaultVerb::kIgnores:
      return "ignores";
    case FaultVerb::kRunaway:
      return "runaway";
    case FaultVerb::kOneWheel:
      return "one-wheel";
  }
  return "?";
}

std::string name_of(const InjectedFault& fault) {
  return std::string(to_string(fault.source)) + ':' + std::string(to_string(fault.verb));
}

std::span<const FaultKind> fault_kinds() { return kKinds; }

const FaultKind* fault_kind(FaultSource source, FaultVerb verb) {
  for (const FaultKind& kind : kKinds) {
    if (kind.source == source && kind.verb == verb) return &kind;
  }
  return nullptr;
}

std::string fault_table() {
  std::string text = "| source | verb | what happens |\n|---|---|---|\n";
  for (auto kind = kKinds.begin(); kind != kKinds.end(); ++kind) {
    const auto is_same = [&](const FaultKind& other) {
      return other.verb == kind->verb && other.text == kind->text;
    };
    if (!kind->implemented || std::any_of(kKinds.begin(), kind, is_same)) continue;
    std::string sources;
    for (auto other = kind; other != kKinds.end(); ++other) {
      if (!is_same(*other)) continue;
      sources += (sources.empty() ? "`" : ", `") + std::string(to_string(other->source)) + '`';
    }
    text += "| " + sources + " | `" + std::string(to_string(kind->verb)) + "` | " +
            std::string(kind->text) + " |\n";
  }
  return text;
}

InjectedFault parse_fault(const std::string& text) {
  const auto refuse = [&](const std::string& expected) {
    throw std::invalid_argument("'" + text + "'; expected " + expected);
  };
  InjectedFault fault;
  const std::size_t at = text.find('@');
  const std::size_t colon = text.substr(0, at).find(':');
  if (colon == std::string::npos) refuse("SOURCE:VERB, SOURCE:VERB@FROM or SOURCE:VERB@FROM+FOR");
  const auto source = named<FaultSource>(kFaultSources, text.substr(0, colon));
  if (!source) refuse("a source: " + all_names<FaultSource>(kFaultSources));
  const auto verb = named<FaultVerb>(kFaultVerbs, text.substr(colon + 1, at - colon - 1));
  if (!verb) refuse("a verb: " + all_names<FaultVerb>(kFaultVerbs));
  fault.source = *source;
  fault.verb = *verb;
  const FaultKind* kind = fault_kind(*source, *verb);
  if (!kind) {
    std::string verbs;
    for (const FaultKind& other : kKinds) {
      if (other.source != *source || !other.implemented) continue;
      verbs += (verbs.empty() ? "" : ", ") + std::string(to_string(other.verb));
    }
    refuse("a verb of " + std::string(to_string(*source)) + ": " + verbs);
  }
  if (!kind->implemented) refuse("a fault that has a meaning; " + std::string(kind->text));
  if (at == std::string::npos) return fault;
  const std::string times = text.substr(at + 1);
  const std::size_t plus = times.find('+');
  const bool good =
      parse_number(times.substr(0, plus), fault.from) && fault.from >= 0.0 &&
      (plus == std::string::npos ||
       (parse_number(times.substr(plus + 1), fault.duration) && fault.duration > 0.0));
  if (!good || !std::isfinite(fault.from + fault.duration)) {
    refuse("times in seconds after '@': FROM or FROM+FOR");
  }
  return fault;
}

const InjectedFault* fault_at(const std::vector<InjectedFault>& faults, FaultSource source,
                              FaultVerb verb, double time) {
  for (const InjectedFault& fault : faults) {
    if (fault.source == source && fault.verb == verb && fault.holds(time)) return &fault;
  }
  return nullptr;
}

bool off_at_times(const std::vector<InjectedFault>& faults, FaultSource source, double on_off,
                  double time) {
  const InjectedFault* fault = fault_at(faults, source, FaultVerb::kIntermittent, time);
  return fault && std::fmod(time - fault->from, 2.0 * on_off) < on_off;
}

double command_sleep(const std::vector<InjectedFault>& faults, double time) {
  if (const InjectedFault* stuck =
          fault_at(faults, FaultSource::kCommand, FaultVerb::kStuck, time)) {
    return std::min(stuck->from + stuck->duration - time, kLongestThreadSleep);
  }
  if (off_at_times(faults, FaultSource::kCommand, kOnOff, time)) return kOnOff;
  if (fault_at(faults, FaultSource::kCommand, FaultVerb::kSlow, time) != nullptr) {
    return kSlowCommand;
  }
  return 0.0;
}

bool has_source(const std::vector<InjectedFault>& faults, FaultSource source) {
  return std::any_of(faults.begin(), faults.end(),
                     [&](const InjectedFault& f) { return f.source == source; });
}

bool has_sensors_clock(const std::vector<InjectedFault>& faults) {
  return has_source(faults, FaultSource::kClock);
}

double sensors_clock(const std::vector<InjectedFault>& faults, double start, double at,
                     double time) {
  // [s] of the sensors' own clock against the runtime's.
  constexpr double kZeroOfSensors = -1234.5;
  if (!has_sensors_clock(faults)) return at;
  double clock = at + kZeroOfSensors;
  for (const InjectedFault& fault : faults) {
    if (fault.source != FaultSource::kClock || time < fault.from) continue;
    // What a slow clock has lost it does not get back.
    if (fault.verb == FaultVerb::kSlow) {
      clock -= (1.0 - kClockRate) * std::min(time - fault.from, fault.duration);
    }
    if (!fault.holds(time)) continue;
    if (fault.verb == FaultVerb::kStuck)
      clock = std::min(clock, start + fault.from + kZeroOfSensors);
    if (fault.verb == FaultVerb::kWrong) clock += kClockStep;
    if (fault.verb == FaultVerb::kGarbage) clock = std::numeric_limits<double>::quiet_NaN();
  }
  if (off_at_times(faults, FaultSource::kClock, kOnOff, time)) clock += kClockStep;
  return clock;
}

}  // namespace prospect
