#include "adapters/simulator/injected_fault.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "adapters/files/parse_number.h"

namespace prospect {
namespace {

constexpr std::array kSources = {
    FaultSource::kLeftCamera, FaultSource::kRightCamera, FaultSource::kCameras,
    FaultSource::kDepth,      FaultSource::kWheels,      FaultSource::kClock,
    FaultSource::kPlanner,    FaultSource::kCommand,     FaultSource::kLink};
constexpr std::array kVerbs = {FaultVerb::kOff,         FaultVerb::kStuck, FaultVerb::kGarbage,
                               FaultVerb::kWrong,       FaultVerb::kSlow,  FaultVerb::kDelayed,
                               FaultVerb::kIntermittent};

constexpr std::array kImplemented = {
    ImplementedFault{FaultSource::kCameras, FaultVerb::kOff},
    ImplementedFault{FaultSource::kCameras, FaultVerb::kDelayed},
    ImplementedFault{FaultSource::kCameras, FaultVerb::kIntermittent},
    ImplementedFault{FaultSource::kDepth, FaultVerb::kOff},
    ImplementedFault{FaultSource::kDepth, FaultVerb::kDelayed},
    ImplementedFault{FaultSource::kDepth, FaultVerb::kIntermittent},
    ImplementedFault{FaultSource::kLink, FaultVerb::kOff},
    ImplementedFault{FaultSource::kLink, FaultVerb::kDelayed},
    ImplementedFault{FaultSource::kLink, FaultVerb::kIntermittent},
    ImplementedFault{FaultSource::kPlanner, FaultVerb::kStuck},
    ImplementedFault{FaultSource::kPlanner, FaultVerb::kSlow}};

template <typename Values>
std::optional<typename Values::value_type> named(const Values& values, const std::string& name) {
  for (const auto value : values) {
    if (to_string(value) == name) return value;
  }
  return std::nullopt;
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
    case FaultSource::kClock:
      return "clock";
    case FaultSource::kPlanner:
      return "planner";
    case FaultSource::kCommand:
      return "command";
    case FaultSource::kLink:
      return "link";
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
  }
  return "?";
}

std::span<const ImplementedFault> implemented_faults() { return kImplemented; }

InjectedFault parse_fault(const std::string& text) {
  const auto refuse = [&](const std::string& expected) {
    throw std::invalid_argument("'" + text + "'; expected " + expected);
  };
  InjectedFault fault;
  const std::size_t at = text.find('@');
  const std::size_t colon = text.substr(0, at).find(':');
  if (colon == std::string::npos) refuse("SOURCE:VERB, SOURCE:VERB@FROM or SOURCE:VERB@FROM+FOR");
  const auto source = named(kSources, text.substr(0, colon));
  const auto verb = named(kVerbs, text.substr(colon + 1, at - colon - 1));
  bool implemented = false;
  std::string all;
  for (const ImplementedFault& one : kImplemented) {
    implemented = implemented || (source == one.source && verb == one.verb);
    all += (all.empty() ? "" : ", ") + std::string(to_string(one.source)) + ':' +
           std::string(to_string(one.verb));
  }
  if (!implemented) refuse("a fault that is implemented: " + all);
  fault.source = *source;
  fault.verb = *verb;
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

}  // namespace prospect
